"""Disks and stores, atomic output, TOML, and texts made harmless."""
