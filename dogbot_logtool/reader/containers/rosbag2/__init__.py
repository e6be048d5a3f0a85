"""Directories of ROS 2 bags, and logs in several files."""
