"""What programs read: JSON, JUnit XML, graphs."""
