"""What feet measured, when they were on the ground, and what each stance was like."""
