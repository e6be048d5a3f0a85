"""One table of events."""
