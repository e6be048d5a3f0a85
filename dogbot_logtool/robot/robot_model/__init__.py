"""The robot that viewers draw: the log's own, the user's, or one of primitives."""
