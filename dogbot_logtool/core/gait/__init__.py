"""Strides, gait class, segments and support."""
