"""Bags, MCAP, SQLite and ROS 2 bag directories: bytes to batches of messages."""
