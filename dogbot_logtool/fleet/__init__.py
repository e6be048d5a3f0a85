"""Many logs: which they are, who works on them, and where the figures of all of them go."""
