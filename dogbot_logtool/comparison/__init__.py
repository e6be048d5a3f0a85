"""Telling whether two files mean the same, and where not: bytes first, then decoded fields."""
