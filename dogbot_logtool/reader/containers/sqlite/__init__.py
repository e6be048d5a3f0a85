"""SQLite files of ROS 2 bags."""
