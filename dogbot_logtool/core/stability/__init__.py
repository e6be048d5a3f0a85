"""Static stability."""
