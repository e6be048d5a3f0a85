"""Loads over stances and over time."""
