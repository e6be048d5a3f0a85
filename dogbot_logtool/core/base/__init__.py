"""Where the base went."""
