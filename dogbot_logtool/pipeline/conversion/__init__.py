"""What `convert` does with one batch: the way through it, and each step."""
