"""What was lost of a log."""
