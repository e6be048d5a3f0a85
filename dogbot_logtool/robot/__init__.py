"""Decisions about a log before it is read through, and how its batches are read."""
