"""Poses, motion and falls of the base."""
