"""How far the contact point of a foot goes while the foot is loaded, and when."""

from typing import Final, NamedTuple

import numpy as np

from dogbot_logtool.core.geometry.arrays import Flags, Floats, Ints

QUICK_S: Final = 0.06
"""s in which a slip goes most of its way."""
LEAST_M: Final = 0.005
"""m: a quick way that is certainly shorter is not looked for."""
FASTEST_MPS: Final = 2.0
"""m/s: a contact point that goes faster has jumped to another part of the foot."""


class Ways(NamedTuple):
    """How far contact points go in k stances, (k,) each; NaN where nothing is known."""

    metres: Floats
    begins_s: Floats
    """s after touchdown; also `ends_s`. NaN where it goes nowhere."""
    ends_s: Floats


def loaded_ways(
    time: Floats, x: Floats, y: Floats, loaded: Flags, stance: Ints, count: int
) -> Ways:
    """Add up the steps of the contact point between neighbouring loaded samples.

    Args:
        time: (n,) s after touchdown.
        x: (n,) m, contact point in the world.
        y: (n,) m, the same.
        loaded: (n,) whether the foot is loaded.
        stance: (n,) ascending, the stance of each row.
        count: number of stances.

    Returns:
        the largest distance from where the point began; when it leaves, and when it has come as
        far as it goes.
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
    return Ways(reach, *_reach_times(time, distance, stance, reach))


def quick_ways(time: Floats, x: Floats, y: Floats, counts: Flags, stance: Ints, count: int) -> Ways:
    """Find the furthest way of each stance within `QUICK_S`.

    A foot that rolls moves its contact point, too, but slowly; one that slips does so at once.

    Args:
        time: (n,) s after touchdown.
        x: (n,) m, contact point in the world.
        y: (n,) m, the same.
        counts: (n,) whether the foot is loaded, on one contact point.
        stance: (n,) ascending, the stance of each row.
        count: number of stances.

    Returns:
        the furthest way, 0 where it is shorter than `LEAST_M`, or so; begin and end of its middle
        four fifths.
    """
    step_x, step_y, step_s = (np.diff(each, prepend=each[:1]) for each in (x, y, time))
    length = _length(step_x, step_y)
    goes = np.zeros(len(stance), np.bool_)
    goes[1:] = counts[1:] & counts[:-1] & (stance[1:] == stance[:-1])
    goes &= length <= FASTEST_MPS * step_s
    found = Ways(*np.full((3, count), np.nan))
    found.metres[stance[goes]] = 0.0
    rows = np.flatnonzero(_may_be_quick(time, np.where(goes, length, 0.0), stance, count)[stance])
    if len(rows):
        along, aside = (np.where(goes, step, 0.0)[rows] for step in (step_x, step_y))
        _find_quickest(time[rows], along, aside, stance[rows], found)
    return found


def _may_be_quick(time: Floats, length: Floats, stance: Ints, count: int) -> Flags:
    """(count,) tell in which stances two neighbouring windows have a path of `LEAST_M`.

    Args:
        time: (n,) s after touchdown.
        length: (n,) m, of the step up to each row.
        stance: (n,) ascending.
        count: number of stances.
    """
    window: Ints = (time / QUICK_S).astype(np.int64)
    windows = int(window.max(initial=0)) + 2
    path = np.bincount(stance * windows + window, length, count * windows)
    path = path.reshape(count, windows)
    return np.asarray((path[:, 1:] + path[:, :-1] >= LEAST_M).any(axis=1))


def _find_quickest(time: Floats, step_x: Floats, step_y: Floats, stance: Ints, found: Ways) -> None:
    """Find the furthest quick way of each stance that these rows are of.

    Args:
        time: (n,) s after touchdown.
        step_x: (n,) m, how far the contact point goes up to each row.
        step_y: (n,) m, the same.
        stance: (n,) ascending.
        found: where the results go.
    """
    first = np.flatnonzero(np.diff(stance, prepend=-1))
    of, last = stance[first], np.append(first[1:], len(stance))
    along, aside = (_totals(step, first, last) for step in (step_x, step_y))
    own = np.repeat(np.arange(len(of)), last - first)
    # Times of one stance after those of the one before, a window apart.
    later = np.append(0.0, np.cumsum(time[last - 1] - time[first] + 2.0 * QUICK_S)[:-1])
    at = time - time[first][own] + later[own]
    after = np.searchsorted(at, at + QUICK_S * (1.0 + 1e-9), side="right") - 1
    way = _length(along[after] - along, aside[after] - aside)
    furthest = np.maximum.reduceat(way, first)
    rows = np.arange(len(own))
    start = np.minimum.reduceat(np.where(way == furthest[own], rows, len(rows) - 1), first)
    inside = (rows >= start[own]) & (rows <= after[start][own])
    share = _length(along - along[start][own], aside - aside[start][own])
    share /= np.where(furthest > 0.0, furthest, 1.0)[own]
    begins = np.maximum.reduceat(np.where(inside & (share <= 0.1), rows, -1), first)
    ends = np.minimum.reduceat(np.where(inside & (share >= 0.9), rows, len(rows)), first)
    # Where samples are further apart than the window, nothing goes any way in it.
    goes = (furthest > 0.0) & (begins >= 0) & (ends < len(rows))
    found.metres[of] = furthest
    found.begins_s[of[goes]], found.ends_s[of[goes]] = time[begins[goes]], time[ends[goes]]


def _length(x: Floats, y: Floats) -> Floats:
    """(n,) lengths; unlike numpy's `hypot` in no need of care for the last digit, and faster."""
    length: Floats = np.sqrt(x * x + y * y)
    return length


def _totals(values: Floats, begin: Ints, end: Ints) -> Floats:
    """(n,) running totals of each run; every row is in one."""
    totals = np.cumsum(values)
    before: Floats = np.repeat(totals[begin] - values[begin], end - begin)
    return totals - before


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
