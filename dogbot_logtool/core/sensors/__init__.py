"""How force sensors read: unloaded level, noise, limits."""
