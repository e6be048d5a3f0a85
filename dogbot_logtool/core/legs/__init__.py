"""Legs: swings of the feet, motion and work of the joints, and feet and base by joints alone."""
