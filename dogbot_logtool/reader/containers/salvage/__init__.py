"""Damaged files: scan, resynchronise, validate, account for losses."""
