"""Sources of the base's poses: one file a kind of message."""
