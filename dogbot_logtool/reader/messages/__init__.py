"""What the messages mean: odometry, transforms, contacts."""
