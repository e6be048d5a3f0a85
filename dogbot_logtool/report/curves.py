"""A quantity over time, reduced so far that it can be drawn, with every peak and every trough.

Time is cut into bins of a power of two of nanoseconds, counted from time zero, and of each bin
the lowest and the highest sample are kept with their own times. The bins double whenever there
are too many: memory is bounded however long the log is, a short log keeps every sample, and every
point of the curve is a sample as it was recorded.
"""

from bisect import bisect_left
from dataclasses import dataclass
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Float32s, Floats, Ints, distinct

MOST_BINS: Final = 8192
"""More than a wide screen has columns of pixels."""


@dataclass(frozen=True, slots=True)
class Curve:
    """Lowest and highest sample of each bin that has one."""

    bin_ns: int
    """ns, width of the bins; 1: every sample is there."""
    time: Ints
    """(n,) ns, increasing: the first times at which the lowest and highest values occur."""
    value: Floats
    """(n,)."""

    def refined(self, closer: "Curve", window: tuple[int, int]) -> "Curve":
        """Return the curve with a closer look at some time in its place.

        Args:
            closer: the same quantity in more detail.
            window: ns, first and last time of whole bins; `closer` has nothing outside.
        """
        kept = (self.time < window[0]) | (self.time > window[1])
        time = np.concatenate([self.time[kept], closer.time])
        order = np.argsort(time, kind="stable")
        value = np.concatenate([self.value[kept], closer.value])
        return Curve(self.bin_ns, time[order], value[order])

    def line(self, breaks: Ints) -> tuple[Ints, Floats]:
        """Return the points to draw.

        Args:
            breaks: (b, 2) ns, spans over which no line may lead, gaps for instance; sorted.

        Returns:
            (p,) ns, increasing, and (p,) values, NaN in the middle of each break that parts two
            points.
        """
        middle = breaks[:, 0] + (breaks[:, 1] - breaks[:, 0]) // 2
        before = np.searchsorted(self.time, middle)
        inside = (before > 0) & (before < len(self.time))
        before, row = np.unique(before[inside], return_index=True)
        time = np.insert(self.time, before, middle[inside][row])
        return time, np.insert(self.value, before, np.nan)


def curve_of(
    time: Ints,
    value: Floats | Float32s,
    most_bins: int = MOST_BINS,
    window: tuple[int, int] | None = None,
) -> Curve | None:
    """Reduce a quantity; None where nothing is known.

    Args:
        time: (n,) ns, increasing.
        value: (n,), NaN where it is not known.
        most_bins: at least 2; a curve has up to twice as many points.
        window: ns on the same clock: only samples from here to there; None: all.
    """
    known = ~np.isnan(value)
    if window is not None:
        known &= (time >= window[0]) & (time <= window[1])
    time, value = time[known], value[known]
    if len(time) == 0:
        return None

    # Times before and after zero never share a bin.
    def is_wide_enough(shift: int) -> bool:
        return int(np.count_nonzero(np.diff(time >> shift))) < max(most_bins, 2)

    shift = bisect_left(range(63), x=True, key=is_wide_enough)
    starts = np.concatenate([[0], np.flatnonzero(np.diff(time >> shift)) + 1])
    bins = np.repeat(np.arange(len(starts)), np.diff(starts, append=len(value)))
    first = []
    for extreme in (np.minimum, np.maximum):
        rows = np.flatnonzero(value == extreme.reduceat(value, starts)[bins])
        first.append(rows[np.searchsorted(bins[rows], np.arange(len(starts)))])
    rows = distinct(np.concatenate(first))
    return Curve(1 << shift, time[rows], value[rows].astype(np.float64))
