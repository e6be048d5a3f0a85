"""The plan of `stats`, and the columns of a batch."""
