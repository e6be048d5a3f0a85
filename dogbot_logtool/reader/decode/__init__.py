"""Message definition to memory layout to columns."""
