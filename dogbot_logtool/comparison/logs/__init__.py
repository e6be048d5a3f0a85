"""Two logs, message by message."""
