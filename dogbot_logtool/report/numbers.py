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
    return NOTHING if value is None else f"{value:z.{decimals}f}"


def recorded_at(time_s: float | None) -> str:
    """Write a log time, s since the epoch, as a date in UTC; clocks of simulators begin in 1970."""
    if time_s is None:
        return "not known"
    if not _SIMULATED_BEFORE_S <= time_s < _NEVER_S:
        return f"{time_s:.3f} s (simulation time)"
    return f"{datetime.fromtimestamp(time_s, UTC):%Y-%m-%d %H:%M:%S} UTC"


def span_of(values: Sequence[float]) -> str:
    """Write the lowest and the highest of some numbers; once, where they are the same."""
    written = list(dict.fromkeys(f"{value:.3g}" for value in sorted(values)))
    return " to ".join([written[0], *written[1:][-1:]]) if written else NOTHING


def nice_step(least: float) -> float:
    """Return 1, 2 or 5 times a power of ten, at least as large."""
    power = 10.0 ** math.floor(math.log10(least))
    return next(factor * power for factor in (1.0, 2.0, 5.0, 10.0) if factor * power >= least)
