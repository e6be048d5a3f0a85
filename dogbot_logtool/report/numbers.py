"""Numbers as people read them."""

from typing import Final

NOTHING: Final = "-"
"""Stands for a figure that is not known."""


def decimal(value: float | None, decimals: int) -> str:
    """Write a number with a fixed number of decimals."""
    # Adding zero makes a plain zero of a negative one.
    return NOTHING if value is None else f"{round(value, decimals) + 0.0:.{decimals}f}"


def percent(value: float | None) -> str:
    """Write a share as a percentage."""
    return NOTHING if value is None else f"{value:.1%}"
