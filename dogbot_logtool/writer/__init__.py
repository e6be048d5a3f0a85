"""Columns to bytes: the only place that knows Foxglove, ROS markers and MCAP output."""
