"""How far the contact point of a foot goes while the foot is loaded, and when."""

import numpy as np

from dogbot_logtool.core.geometry.arrays import Flags, Floats, Ints


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
