"""See and measure a legged robot's footfalls from a recorded log."""

__version__ = "0.1.0"
