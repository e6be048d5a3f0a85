"""Whether the base and the feet of a log fit together."""
