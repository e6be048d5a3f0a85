"""What `convert` does with a log: its plan, the way through a batch, and each step."""
