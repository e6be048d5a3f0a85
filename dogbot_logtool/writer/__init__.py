"""Columns to bytes: all that depends on Foxglove, ROS markers and MCAP output."""
