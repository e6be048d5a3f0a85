"""The scene: arrows, colours, support."""
