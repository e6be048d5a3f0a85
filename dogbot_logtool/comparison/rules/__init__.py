"""The figures of a log against limits."""
