"""Contact samples, what sensors read, the detection of contact, and stances."""
