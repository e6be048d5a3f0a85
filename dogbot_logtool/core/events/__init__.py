"""What happened, and when: one table of events."""
