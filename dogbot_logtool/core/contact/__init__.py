"""Contact samples, stances, and the detection of contact."""
