"""What `stats` reads, and how: its plan, and the columns of a batch."""
