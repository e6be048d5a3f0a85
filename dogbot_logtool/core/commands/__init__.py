"""How well the base follows its velocity commands."""
