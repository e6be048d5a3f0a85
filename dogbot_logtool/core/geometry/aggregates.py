"""Many values in one: aggregates of figures, means on the circle, histograms of intervals."""

from typing import Final

import numpy as np

from dogbot_logtool.core.geometry.arrays import Floats, Ints
from dogbot_logtool.core.geometry.order_statistics import distinct, median_of
from dogbot_logtool.dataclass import dataclass

_SUB_BINS: Final = 9
"""2^9 bins an octave: a bin is at most 0.2 % wide."""
_EXPONENT_BIAS: Final = 1023 << _SUB_BINS


@dataclass(frozen=True, slots=True)
class Aggregate:
    """Summary of many values of one figure, in the figure's unit."""

    n: int
    mean: float
    std: float | None
    """Sample standard deviation (divisor n - 1); None for a single value."""
    median: float
    min: float
    max: float


def aggregate(values: Floats) -> Aggregate | None:
    """Aggregate the finite values; None where there are none.

    Args:
        values: (n,), any unit; NaN stands for "not known" and is left out.
    """
    known = values[np.isfinite(values)]
    if len(known) == 0:
        return None
    std = float(np.std(known, ddof=1)) if len(known) > 1 else None
    return Aggregate(
        n=len(known),
        mean=float(np.mean(known)),
        std=std,
        median=float(median_of(known)),
        min=float(np.min(known)),
        max=float(np.max(known)),
    )


@dataclass(frozen=True, slots=True)
class CircularMean:
    """Mean of phases on the circle."""

    mean: float
    """Cycles in [0, 1)."""
    consistency: float
    """R in [0, 1]: 1 when all phases are equal, near 0 when they are spread evenly."""
    n: int


def circular_mean(phases: Floats) -> CircularMean | None:
    """Average phases on the circle: R exp(2 pi i mean) = mean of exp(2 pi i phase).

    Source: Batschelet, Circular Statistics in Biology, 1981. Raw phases are never averaged:
    0.99 and 0.01 lie 0.02 apart, and their mean is 0.

    Args:
        phases: (n,) cycles; NaN is left out.

    Returns:
        The mean, or None without phases.
    """
    known = phases[np.isfinite(phases)]
    if len(known) == 0:
        return None
    angle = 2.0 * np.pi * known
    x, y = float(np.mean(np.cos(angle))), float(np.mean(np.sin(angle)))
    mean = float(np.arctan2(y, x)) / (2.0 * np.pi) % 1.0
    return CircularMean(mean if mean < 1.0 else 0.0, min(1.0, float(np.hypot(x, y))), len(known))


def wrapped(phases: Floats) -> Floats:
    """Return phases or their differences wrapped into [-0.5, 0.5) cycles."""
    wrapped_phases: Floats = (phases + 0.5) % 1.0 - 0.5
    return wrapped_phases


class IntervalHistogram:
    """Counts of intervals in bins of constant relative width: memory does not grow with the log.

    Each bin remembers the sum of its intervals, so a percentile is the mean of the intervals in
    the bin that holds it: exact where the intervals are constant, within 0.2 % elsewhere. All
    sums are of integers, so the order in which intervals are added does not matter. Only bins
    that hold something are kept: a log may have thousands of frames, with a histogram each.
    """

    def __init__(self) -> None:
        self._bins = np.empty(0, np.int64)
        self._counts = np.empty(0, np.int64)
        self._sums = np.empty(0, np.int64)

    def add(self, intervals: Ints) -> None:
        """Count intervals.

        Args:
            intervals: (n,) ns; only those above 0 are counted.
        """
        counted = intervals if int(intervals.min(initial=0)) > 0 else intervals[intervals > 0]
        if len(counted) == 0:
            return
        bins = _interval_bin(counted)
        lowest = int(bins.min())
        bins -= lowest
        counts = np.bincount(bins)
        sums = np.zeros(len(counts), np.int64)
        # bincount adds up floats: those of long intervals would only stay exact in two halves.
        exact = int(counted.max()) * len(counted) <= 1 << 53
        halves = ((0, counted),) if exact else ((0, counted & 0xFFFFFF), (24, counted >> 24))
        for shift, part in halves:
            sums += np.bincount(bins, weights=part).astype(np.int64) << shift
        filled = np.flatnonzero(counts)
        self._merge(filled + lowest, counts[filled], sums[filled])

    def _merge(self, bins: Ints, counts: Ints, sums: Ints) -> None:
        """Add bins, sorted and each only once, to those that are kept."""
        all_bins = distinct(np.concatenate([self._bins, bins]))
        all_counts, all_sums = np.zeros((2, len(all_bins)), np.int64)
        for held, held_counts, held_sums in (
            (self._bins, self._counts, self._sums),
            (bins, counts, sums),
        ):
            rows = np.searchsorted(all_bins, held)
            all_counts[rows] += held_counts
            all_sums[rows] += held_sums
        self._bins, self._counts, self._sums = all_bins, all_counts, all_sums

    @property
    def count(self) -> int:
        """Number of intervals."""
        return int(self._counts.sum())

    @property
    def total(self) -> int:
        """Sum of all intervals, ns."""
        return int(self._sums.sum())

    def percentile(self, percent: float) -> float | None:
        """Return the interval, ns, that the given share of intervals does not exceed."""
        if self.count == 0:
            return None
        rank = max(1, int(np.ceil(self.count * percent / 100.0)))
        held = int(np.searchsorted(np.cumsum(self._counts), rank))
        return float(self._sums[held] / self._counts[held])

    def longer_than(self, interval: float) -> "IntervalHistogram":
        """Return the intervals that are longer than one (to 0.2 %)."""
        last = int(_interval_bin(np.array([max(1.0, interval)]))[0])
        longer, part = self._bins > last, IntervalHistogram()
        part._bins = self._bins[longer]
        part._counts = self._counts[longer]
        part._sums = self._sums[longer]
        return part


def _interval_bin(intervals: Ints | Floats) -> Ints:
    """(n,) bin of each interval above 0: the exponent and leading digits of its float64 form."""
    bits = intervals.astype(np.float64).view(np.int64)
    bins: Ints = (bits >> (52 - _SUB_BINS)) - _EXPONENT_BIAS
    return bins
