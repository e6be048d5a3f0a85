"""What people and scripts read: tables, diagrams, JSON."""
