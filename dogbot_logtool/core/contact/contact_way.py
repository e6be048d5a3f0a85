"""How far the contact point of a foot goes in a stance, and when."""

from typing import Final

import numpy as np

from dogbot_logtool.core.contact.stance_samples import StanceSamples, own_rows
from dogbot_logtool.core.geometry.arrays import Flags, Floats, Ints
from dogbot_logtool.core.geometry.runs import first_where

LOADED: Final = 0.5
"""Share of a stance's mean force from which its foot is loaded."""


def contact_ways(samples: StanceSamples) -> tuple[Floats, Floats]:
    """(k,) m, net travel of the contact point from 10 % to 90 % of a stance, and its reach.

    The reach is the largest distance from where the point is at 10 %. Both are horizontal.

    A round foot that rolls moves its contact point without slipping, so this is not slip yet.
    NaN when no samples with a contact point surround both instants.
    """
    rows = np.flatnonzero(np.isfinite(samples.x) & np.isfinite(samples.y))
    begin, end = np.searchsorted(rows, samples.touchdown), np.searchsorted(rows, samples.end)
    duration = samples.time[samples.end]
    tenth, nine_tenths = 0.1 * duration, 0.9 * duration
    known = end - begin >= 2
    known[known] = samples.time[rows[begin[known]]] <= tenth[known]
    known[known] = samples.time[rows[end[known] - 1]] >= nine_tenths[known]

    time, stance = samples.time[rows], samples.stance[rows]
    x, y = samples.x[rows], samples.y[rows]
    ends = []
    for at in (tenth, nine_tenths):
        later = first_where(time > at[stance], begin)[known]
        around = later - 1, np.minimum(later, end[known] - 1)
        ends.append([_interpolated(at[known], time, values, around) for values in (x, y)])
    (x_early, y_early), (x_late, y_late) = ends
    travel, reach = np.full((2, len(begin)), np.nan)
    travel[known] = np.hypot(x_late - x_early, y_late - y_early)
    start = np.full((2, len(begin)), np.nan)
    start[:, known] = x_early, y_early
    way = np.hypot(x - start[0, stance], y - start[1, stance])
    counts = known[stance] & (time >= tenth[stance]) & (time <= nine_tenths[stance])
    reach[known] = travel[known]
    np.maximum.at(reach, stance[counts], way[counts])
    return travel, reach


def _interpolated(at: Floats, time: Floats, values: Floats, around: tuple[Ints, Ints]) -> Floats:
    """(k,) values at times between two rows each, or at the time of the first of them."""
    before, after = around
    since = at - time[before]
    slope = (values[after] - values[before]) / (time[after] - time[before])
    return np.where(since == 0.0, values[before], slope * since + values[before])


def ways_under_load(samples: StanceSamples, mean: Floats) -> tuple[Floats, Floats, Floats]:
    """(k,) see `loaded_ways`: of samples from 10 % to 90 % of a stance, with a contact point."""
    duration = samples.time[samples.end][samples.stance]
    counts = own_rows(samples) & np.isfinite(samples.x) & np.isfinite(samples.y)
    counts &= (samples.time >= 0.1 * duration) & (samples.time <= 0.9 * duration)
    rows = np.flatnonzero(counts)
    stance = samples.stance[rows]
    loaded = samples.force[rows] >= (LOADED * mean)[stance]
    columns = samples.time[rows], samples.x[rows], samples.y[rows]
    return loaded_ways(*columns, loaded, stance, len(mean))


def loaded_ways(
    time: Floats, x: Floats, y: Floats, loaded: Flags, stance: Ints, count: int
) -> tuple[Floats, Floats, Floats]:
    """Add up the steps of the contact point between neighbouring loaded samples.

    Args:
        time: (n,) s after touchdown.
        x: (n,) m, contact point in the world.
        y: (n,) m, the same.
        loaded: (n,) whether the foot is loaded.
        stance: (n,) ascending, the stance of each row.
        count: number of stances.

    Returns:
        (count,) m, largest distance from where the point began; and (count,) s after touchdown,
        when it leaves and when it has come as far as it goes. NaN where nothing is known.
    """
    goes = np.zeros(len(stance), np.bool_)
    goes[1:] = loaded[1:] & loaded[:-1] & (stance[1:] == stance[:-1])
    of, first = np.unique(stance, return_index=True)
    last = np.searchsorted(stance, of, side="right")
    along, aside = (
        _totals(np.where(goes, np.diff(values, prepend=0.0), 0.0), first, last) for values in (x, y)
    )
    distance = np.hypot(along, aside)
    reach = np.full(count, np.nan)
    reach[of] = 0.0
    np.maximum.at(reach, stance, distance)
    return reach, *_reach_times(time, distance, stance, reach)


def _totals(values: Floats, begin: Ints, end: Ints) -> Floats:
    """(n,) running totals of each run, to the bit as if it stood alone."""
    totals = np.empty_like(values)
    for first, last in zip(begin.tolist(), end.tolist(), strict=True):
        np.cumsum(values[first:last], out=totals[first:last])
    return totals


def _reach_times(time: Floats, way: Floats, stance: Ints, reach: Floats) -> tuple[Floats, Floats]:
    """Return when the contact point leaves its place, and when it has come as far as it goes.

    Args:
        time: (n,) s after touchdown.
        way: (n,) m from where it began.
        stance: (n,) ascending, the stance of each row.
        reach: (k,) m, of each stance.

    Returns:
        (k,) s each; NaN where the reach is not known, or 0.
    """
    begins, ends = np.full((2, len(reach)), np.nan)
    share = np.divide(way, reach[stance], out=np.zeros_like(way), where=reach[stance] > 0.0)
    of, first = np.unique(stance[half := np.flatnonzero(share >= 0.5)], return_index=True)
    before, half = np.flatnonzero(share <= 0.1), half[first]
    rest = np.searchsorted(before, half) - 1
    row = np.where(rest >= 0, before[rest] if len(before) else half, half)
    begins[of] = time[np.where(stance[row] == of, row, half)]
    of, first = np.unique(stance[full := np.flatnonzero(share >= 0.9)], return_index=True)
    ends[of] = time[full[first]]
    return begins, ends
