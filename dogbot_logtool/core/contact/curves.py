"""A quantity over time, reduced so far that it can be drawn, with every peak and every trough.

Time is cut into bins of a power of two of nanoseconds, counted from time zero, and of each bin
the lowest and the highest sample are kept with their own times. The bins double whenever there
are too many: memory is bounded however long the log is, a short log keeps every sample, and every
point of the curve is a sample as it was recorded.
"""

from typing import Final

import numpy as np

from dogbot_logtool.core.geometry.arrays import Floats, Ints
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


class CurveRecorder:
    """Makes a `Curve` of samples that come in order; the same however they are split."""

    def __init__(self, detail: CurveDetail) -> None:
        # Times before and after zero never share a bin.
        self._most = max(detail.most_bins, 2)
        self._window = detail.window
        self._shift = 0
        self._kept = (np.empty(0, np.int64), np.empty(0), np.empty(0, np.int64), np.empty(0))

    def add(self, time: Ints, value: Floats) -> None:
        """Take in samples.

        Args:
            time: (n,) ns, increasing, later than all before.
            value: (n,), NaN where it is not known.
        """
        known = ~np.isnan(value)
        if self._window is not None:
            known &= (time >= self._window[0]) & (time <= self._window[1])
        if not known.any():
            return
        time, value = time[known], value[known]
        rows = zip(self._kept, (time, value, time, value), strict=True)
        low_time, low, high_time, high = (np.concatenate(each) for each in rows)
        starts = self._bin_starts(low_time)
        lowest = _first_extremes(low, starts, np.minimum)
        highest = _first_extremes(high, starts, np.maximum)
        self._kept = low_time[lowest], low[lowest], high_time[highest], high[highest]

    def finish(self) -> Curve | None:
        """End the log; None where nothing is known."""
        low_time, low, high_time, high = self._kept
        if len(low) == 0:
            return None
        return Curve(1 << self._shift, low_time, low, high_time, high)

    def _bin_starts(self, time: Ints) -> Ints:
        """Return the first row of each bin, of bins as wide as there is need for."""
        while True:
            number = time >> self._shift
            starts = np.flatnonzero(np.diff(number, prepend=number[0] - 1))
            if len(starts) <= self._most:
                return starts
            self._shift += 1


def _first_extremes(values: Floats, starts: Ints, extreme: np.ufunc) -> Ints:
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


class LoadCurveRecorder:
    """Makes the `LoadCurves` of one foot."""

    def __init__(self, detail: CurveDetail) -> None:
        self._force, self._vertical = CurveRecorder(detail), CurveRecorder(detail)

    def add(self, time: Ints, force: Floats, vertical: Floats) -> None:
        """Take in samples.

        Args:
            time: (n,) ns, increasing, later than all before.
            force: (n,) N, |F|.
            vertical: (n,) N; NaN where not known.
        """
        self._force.add(time, force)
        self._vertical.add(time, vertical)

    def finish(self) -> LoadCurves:
        """End the log."""
        return LoadCurves(self._force.finish(), self._vertical.finish())
