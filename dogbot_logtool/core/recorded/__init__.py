"""What is kept of a topic beside feet and base while it streams past."""
