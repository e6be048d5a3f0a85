"""Transforms between frames, and forces and points carried through them."""
