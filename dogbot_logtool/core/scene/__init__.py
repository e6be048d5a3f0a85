"""What is drawn: arrows, colours, support."""
