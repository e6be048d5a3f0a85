"""Reports for programs: JSON, JUnit XML, graphs."""
