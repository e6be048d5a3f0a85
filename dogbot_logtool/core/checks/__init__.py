"""Checks: what makes a recording doubtful, and which metrics that voids."""
