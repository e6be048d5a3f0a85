"""The frames of a log, and where its feet are in them."""
