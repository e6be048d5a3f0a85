"""The one table of all figures, from which all outputs of `stats` are made."""
