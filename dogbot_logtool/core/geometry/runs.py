"""Reductions of runs: rows of an array that belong together, such as the samples of a stance."""

import numpy as np

from dogbot_logtool.core.geometry.arrays import Flags, Floats, Ints


def sorted_runs(values: Floats, begin: Ints, end: Ints) -> Floats:
    """(n,) with the values of each run in ascending order."""
    ordered = values.copy()
    for first, last in zip(begin.tolist(), end.tolist(), strict=True):
        ordered[first:last].sort()
    return ordered


def rows_of_runs(begin: Ints, end: Ints) -> tuple[Ints, Ints, Ints]:
    """Lay runs of rows end to end.

    Args:
        begin: (k,) first row of each run.
        end: (k,) row after its last.

    Returns:
        (n,) rows, (n,) the run of each, and (k,) where each run begins among them.
    """
    length = end - begin
    first = np.cumsum(length) - length
    run = np.repeat(np.arange(len(begin)), length)
    return np.arange(len(run)) + (begin - first)[run], run, first


def first_where(flags: Flags, start: Ints) -> Ints:
    """(k,) the first row that is flagged, at or after each start; n: there is none."""
    rows = np.append(np.flatnonzero(flags), len(flags))
    found: Ints = rows[np.searchsorted(rows, start)]
    return found


def highest(values: Floats, begin: Ints, end: Ints) -> Floats:
    """(k,) maxima of runs, each of which ends before the last row; NaN where one is."""
    highest: Floats = np.maximum.reduceat(values, np.stack([begin, end], axis=1).ravel())[::2]
    return highest


def sums(values: Floats, begin: Ints, end: Ints) -> Floats:
    """(k,) sums of runs that have a row before and after them.

    numpy adds up pairwise what follows a run's first row: a zero there makes that the whole run,
    as if it stood alone.
    """
    led = values.copy()
    led[begin - 1] = 0.0
    sums: Floats = np.add.reduceat(led, np.stack([begin - 1, end], axis=1).ravel())[::2]
    return sums


def trapezoids(values: Floats, time: Floats, first: Ints) -> Floats:
    """Integrate over real sample times: sums of (v[i] + v[i+1]) / 2 * (t[i+1] - t[i]).

    Args:
        values: (n,) any unit.
        time: (n,) s.
        first: (k,) the first row of each run; it ends before the next one's.

    Returns:
        (k,) unit of the values times s.
    """
    area = np.zeros(len(values))
    area[1:] = (values[1:] + values[:-1]) * np.diff(time)
    area[first] = 0.0
    integrals: Floats = np.add.reduceat(area, first) / 2.0
    return integrals


def added_within(total: Floats, knots: Floats, at: Floats, half: float) -> Floats:
    """Return by how much running totals grow over a window about each time.

    Args:
        total: (n, k) any unit, at each knot; between knots they grow evenly.
        knots: (n,) times, increasing.
        at: (m,) times, in the knots' unit.
        half: half of the window, likewise.

    Returns:
        (m, k) in the totals' unit; divided by the window's length, means over it.
    """
    columns = [
        np.interp(at + half, knots, column) - np.interp(at - half, knots, column)
        for column in total.T
    ]
    return np.stack(columns, axis=1)


def quantiles(ordered: Floats, begin: Ints, end: Ints, share: float) -> Floats:
    """Quantile of each run of sorted values, interpolated linearly between neighbours.

    Args:
        ordered: (n,) any unit, each run in ascending order.
        begin: (k,) first row of each run.
        end: (k,) row after its last.
        share: 0.5 for the median.
    """
    rank = share * (end - begin - 1)
    below = begin + rank.astype(np.int64)
    above = np.minimum(below + 1, end - 1)
    between: Floats = ordered[below] + (ordered[above] - ordered[below]) * (rank - (below - begin))
    return between
