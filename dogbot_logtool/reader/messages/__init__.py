"""Meaning of messages: odometry, transforms, contacts."""
