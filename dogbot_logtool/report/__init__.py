"""Reports for people and scripts: tables, diagrams, JSON."""
