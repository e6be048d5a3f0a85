"""Bytes to columns: the only place that knows bags, MCAP containers and ROS messages."""
