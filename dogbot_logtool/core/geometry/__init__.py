"""Arrays, rotations, time spans and other formulas that all of the core shares."""
