"""The records of a walk's metrics, made of all that was worked out of its log."""
