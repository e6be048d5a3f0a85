"""A quantity over time, reduced so far that it can be drawn, with every peak and every trough."""

from typing import Final, NamedTuple

import numpy as np

from dogbot_logtool.core.arrays import Float32s, Floats, Ints, distinct

MOST_BINS: Final = 8192
"""More than a wide screen has columns of pixels."""


class Curve(NamedTuple):
    """The samples of a quantity that are drawn."""

    time: Ints
    """(n,) ns, increasing."""
    value: Floats
    """(n,) NaN in the middle of each break, over which no line leads."""
    bin_s: float
    """s, of each bin of this width the lowest and the highest sample are there; 0: every one is."""


def curve_of(
    time: Ints,
    value: Floats | Float32s,
    breaks: Ints,
    most_bins: int = MOST_BINS,
    whole: tuple[int, int] = (0, 0),
) -> Curve | None:
    """Reduce a quantity; None where nothing is known.

    Args:
        time: (n,) ns, increasing.
        value: (n,), NaN where it is not known.
        breaks: (b, 2) ns, spans over which no line may lead, gaps for instance; sorted.
        most_bins: a curve has up to twice as many points.
        whole: ns, first and last time of which every sample is kept, unless there are very many.
    """
    known = np.flatnonzero(~np.isnan(value))
    if len(known) == 0:
        return None
    rows, bin_s = known, 0.0
    if len(known) > 2 * most_bins:
        start, end = int(time[known[0]]), int(time[known[-1]])
        rows, bin_s = _extremes(time, value, known, most_bins), (end - start) / most_bins / 1e9
        inside = known[(time[known] >= whole[0]) & (time[known] <= whole[1])]
        if len(inside) <= 2 * MOST_BINS:
            rows = distinct(np.concatenate([rows, inside]))
    # A line is broken where a sample that is not known, or the middle of a break, is passed over.
    passed = np.cumsum(np.isnan(value))[rows]
    passed += np.searchsorted(breaks.sum(axis=1) / 2.0, time[rows])
    at = np.flatnonzero(np.diff(passed)) + 1
    time, value = time[rows], value[rows].astype(np.float64)
    between = time[at - 1] + (time[at] - time[at - 1]) // 2
    return Curve(np.insert(time, at, between), np.insert(value, at, np.nan), bin_s)


def _extremes(time: Ints, value: Floats | Float32s, known: Ints, most_bins: int) -> Ints:
    """Return the rows of the first lowest and the first highest known value of each bin."""
    time, value = time[known], value[known]
    edges = np.linspace(float(time[0]), float(time[-1]), most_bins + 1)
    starts = distinct(np.searchsorted(time, edges[:-1]))
    bins = np.repeat(np.arange(len(starts)), np.diff(starts, append=len(value)))
    first = []
    for extreme in (np.minimum, np.maximum):
        rows = np.flatnonzero(value == extreme.reduceat(value, starts)[bins])
        first.append(rows[np.searchsorted(bins[rows], np.arange(len(starts)))])
    return known[distinct(np.concatenate(first))]
