"""Views of annotated logs, set up for viewers."""
