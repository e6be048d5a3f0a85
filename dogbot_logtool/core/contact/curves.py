"""A quantity over time, reduced so far that it can be drawn, with every peak and every trough.

Time is cut into bins of a power of two of nanoseconds, counted from time zero, and of each bin
the lowest and the highest sample are kept with their own times. The bins double whenever there
are too many: memory is bounded however long the log is, a short log keeps every sample, and every
point of the curve is a sample as it was recorded.
"""

from bisect import bisect_left
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Float32s, Floats, Ints
from dogbot_logtool.dataclass import dataclass

MOST_BINS: Final = 8192
"""More than a wide screen has columns of pixels."""


@dataclass(frozen=True, slots=True)
class CurveDetail:
    """How much of the curves is kept."""

    most_bins: int = MOST_BINS
    """At least 2; a curve has up to twice as many points."""
    window: tuple[int, int] | None = None
    """ns on the clock that is measured on: only samples from here to there; None keeps all."""


@dataclass(frozen=True, slots=True)
class Curve:
    """Lowest and highest sample of each bin that has one, (n,) each, in the order of time."""

    bin_ns: int
    """ns, width of the bins; 1: every sample is there."""
    low_time: Ints
    """ns, the first time at which the bin's lowest value occurs."""
    low: Floats
    high_time: Ints
    """ns, the first time at which the bin's highest value occurs."""
    high: Floats

    def refined(self, closer: "Curve", window: tuple[int, int]) -> "Curve":
        """Return the curve with a closer look at some time in its place.

        Args:
            closer: the same quantity in more detail.
            window: ns, first and last time of whole bins; `closer` has nothing outside.
        """
        kept = (self.high_time < window[0]) | (self.high_time > window[1])
        rows = [
            np.concatenate([getattr(self, name)[kept], getattr(closer, name)])
            for name in ("low_time", "low", "high_time", "high")
        ]
        order = np.argsort(rows[0], kind="stable")
        return Curve(self.bin_ns, *(column[order] for column in rows))

    def line(self, breaks: Ints) -> tuple[Ints, Floats]:
        """Return the points to draw.

        Args:
            breaks: (b, 2) ns, spans over which no line may lead, gaps for instance; sorted.

        Returns:
            (p,) ns, increasing, and (p,) values, NaN in the middle of each break that parts two
            points.
        """
        low_first = self.low_time <= self.high_time
        first = np.where(low_first, self.low, self.high)
        second = np.where(low_first, self.high, self.low)
        times = np.sort(np.stack([self.low_time, self.high_time], axis=1), axis=1)
        two = np.ones(times.shape, np.bool_)
        two[:, 1] = times[:, 1] > times[:, 0]
        time, value = times[two], np.stack([first, second], axis=1)[two]

        middle = breaks[:, 0] + (breaks[:, 1] - breaks[:, 0]) // 2
        before = np.searchsorted(time, middle)
        inside = (before > 0) & (before < len(time))
        before, row = np.unique(before[inside], return_index=True)
        return np.insert(time, before, middle[inside][row]), np.insert(value, before, np.nan)


def curve_of(time: Ints, value: Floats | Float32s, detail: CurveDetail) -> Curve | None:
    """Reduce a quantity; None where nothing is known.

    Args:
        time: (n,) ns, increasing.
        value: (n,), NaN where it is not known.
        detail: how much is kept.
    """
    if detail.window is not None:
        first, last = detail.window
        rows = slice(*np.searchsorted(time, [first, last + 1]).tolist())
        time, value = time[rows], value[rows]
    known = ~np.isnan(value)
    if not known.all():
        time, value = time[known], value[known]
    if len(time) == 0:
        return None
    starts, shift = _bins(time, max(detail.most_bins, 2))
    lowest = _first_extremes(value, starts, np.minimum)
    highest = _first_extremes(value, starts, np.maximum)
    low, high = (value[rows].astype(np.float64) for rows in (lowest, highest))
    return Curve(1 << shift, time[lowest], low, time[highest], high)


def _bins(time: Ints, most: int) -> tuple[Ints, int]:
    """Return the first row of each bin, and the power of two, ns, that a bin is wide."""

    # Times before and after zero never share a bin.
    def is_wide_enough(shift: int) -> bool:
        return int(np.count_nonzero(np.diff(time >> shift))) < most

    shift = bisect_left(range(63), x=True, key=is_wide_enough)
    return np.concatenate([[0], np.flatnonzero(np.diff(time >> shift)) + 1]), shift


def _first_extremes(values: Floats | Float32s, starts: Ints, extreme: np.ufunc) -> Ints:
    """(b,) the row of the lowest or highest value of each bin, the first of equal ones."""
    bins = np.repeat(np.arange(len(starts)), np.diff(starts, append=len(values)))
    rows = np.flatnonzero(values == extreme.reduceat(values, starts)[bins])
    first: Ints = rows[np.searchsorted(bins[rows], np.arange(len(starts)))]
    return first


@dataclass(frozen=True, slots=True)
class LoadCurves:
    """The load of a foot over time."""

    force: Curve | None
    """N, |F|; None where no force is known."""
    vertical: Curve | None
    """N, the vertical force."""

    @property
    def bin_ns(self) -> int:
        """ns, width of the wider bins."""
        return max((curve.bin_ns for curve in (self.force, self.vertical) if curve), default=1)


def load_curves(
    time: Ints, force: Floats | Float32s, vertical: Floats | Float32s, detail: CurveDetail
) -> LoadCurves:
    """Reduce the load of a foot.

    Args:
        time: (n,) ns, increasing.
        force: (n,) N, |F|.
        vertical: (n,) N; NaN where not known.
        detail: how much is kept.
    """
    return LoadCurves(curve_of(time, force, detail), curve_of(time, vertical, detail))
