"""Numbers as people read them."""

from collections.abc import Sequence
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


def span_of(values: Sequence[float]) -> str:
    """Write the lowest and the highest of some numbers; once, where they are the same."""
    written = list(dict.fromkeys(f"{value:.3g}" for value in sorted(values)))
    return " to ".join([written[0], *written[1:][-1:]]) if written else NOTHING
