"""The plan of `convert`, the way through a batch, and each step."""
