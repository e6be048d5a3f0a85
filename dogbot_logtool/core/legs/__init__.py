"""Legs: swings of the feet, and motion, torque and work of the joints."""
