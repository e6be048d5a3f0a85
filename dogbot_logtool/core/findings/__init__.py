"""Findings: why a figure is missing, and what makes one doubtful."""
