"""Numbers as people read them."""

import math
from collections.abc import Sequence
from datetime import UTC, datetime
from typing import Final

NOTHING: Final = "-"
"""Stands for a metric that is not known."""
_SIMULATED_BEFORE_S: Final = 1_000_000_000
"""Log times before this are simulation time, not dates."""
_NEVER_S: Final = 3e10


def decimal(value: float | None, decimals: int) -> str:
    """Write a number with a fixed number of decimals."""
    # Adding zero makes a plain zero of a negative one.
    return NOTHING if value is None else f"{round(value, decimals) + 0.0:.{decimals}f}"


def percent(value: float | None) -> str:
    """Write a share as a percentage."""
    return NOTHING if value is None else f"{value:.1%}"


def date_of(time_s: float) -> datetime | None:
    """Return the date of a log time, s since the epoch; None: it is a simulation's."""
    is_dated = _SIMULATED_BEFORE_S <= time_s < _NEVER_S
    return datetime.fromtimestamp(time_s, UTC) if is_dated else None


def span_of(values: Sequence[float]) -> str:
    """Write the lowest and the highest of some numbers; once, where they are the same."""
    written = list(dict.fromkeys(f"{value:.3g}" for value in sorted(values)))
    return " to ".join([written[0], *written[1:][-1:]]) if written else NOTHING


def nice_step(least: float) -> float:
    """Return 1, 2 or 5 times a power of ten, at least as large."""
    power = 10.0 ** math.floor(math.log10(least))
    return next(factor * power for factor in (1.0, 2.0, 5.0, 10.0) if factor * power >= least)
