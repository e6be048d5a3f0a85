"""Files: tables, events, figures for papers, robots."""
