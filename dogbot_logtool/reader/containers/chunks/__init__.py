"""Chunks: records in a row, compressed, checked."""
