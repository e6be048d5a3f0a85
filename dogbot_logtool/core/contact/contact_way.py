"""How far the contact point of a foot goes in a stance, and when."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.arrays import Flags, Floats, Ints
from dogbot_logtool.core.contact.stance_samples import StanceSamples, own_rows

LOADED: Final = 0.5
"""Share of a stance's mean force from which its foot is loaded."""
QUICK_S: Final = 0.06
"""s in which a slip goes most of its way."""
LEAST_M: Final = 0.005
"""m: a shorter quick way is none."""
FASTEST_MPS: Final = 2.0
"""m/s: a contact point that goes faster has jumped to another part of the foot."""


class Ways(NamedTuple):
    """How far contact points go in k stances, (k,) each; NaN where nothing is known."""

    metres: Floats
    begins_s: Floats
    """s after touchdown, with a tenth of the way; also `ends_s`, with nine tenths. NaN where it
    goes nowhere."""
    ends_s: Floats


def contact_ways(samples: StanceSamples) -> tuple[Floats, Floats]:
    """(k,) m, net travel of the contact point from 10 % to 90 % of a stance, and its reach.

    The reach is the largest distance from where the point is at 10 %. Both are horizontal.

    A round foot that rolls moves its contact point without slipping, so this is not slip yet.
    NaN when no samples with a contact point surround both instants.
    """
    travel, reach = np.full((2, len(samples.end)), np.nan)
    known = _is_placed(samples)
    phase, stance = _phase(samples)[known], samples.stance[known]
    x, y = samples.x[known], samples.y[known]
    of, first, count = np.unique(stance, return_index=True, return_counts=True)
    around = (phase[first] <= 0.1) & (phase[first + count - 1] >= 0.9) & (count >= 2)
    of = of[around]
    if not len(of):
        return travel, reach
    # Stances follow each other on one axis, so that all are interpolated at once.
    axis = 4.0 * stance + np.clip(phase, -1.0, 1.0)
    starts = [np.interp(4.0 * of + 0.1, axis, each) for each in (x, y)]
    ends = [np.interp(4.0 * of + 0.9, axis, each) for each in (x, y)]
    travel[of] = np.hypot(ends[0] - starts[0], ends[1] - starts[1])
    origin = np.full((2, len(travel)), np.nan)
    origin[:, of] = starts
    away = np.hypot(x - origin[0, stance], y - origin[1, stance])
    reach[of] = travel[of]
    counts = (phase >= 0.1) & (phase <= 0.9) & np.isfinite(away)
    np.maximum.at(reach, stance[counts], away[counts])
    return travel, reach


def ways_under_load(samples: StanceSamples, mean: Floats) -> tuple[Ways, Ways]:
    """(k,) all and quick ways of samples from 10 % to 90 % of a stance, with a contact point.

    Args:
        samples: of k stances.
        mean: (k,) N, mean of |F| in each.
    """
    phase = _phase(samples)
    counts = own_rows(samples) & _is_placed(samples) & (phase >= 0.1) & (phase <= 0.9)
    rows = np.flatnonzero(counts)
    stance = samples.stance[rows]
    loaded = samples.force[rows] >= (LOADED * mean)[stance]
    columns = samples.time[rows], samples.x[rows], samples.y[rows]
    single = loaded & samples.single[rows]
    return (
        loaded_ways(*columns, loaded, stance, len(mean)),
        quick_ways(*columns, single, stance, len(mean)),
    )


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
        the largest distance from where the point began.
    """
    first, last = _runs(stance)
    path = _path(x, y, _neighbours(loaded, stance), first)
    return _ways(time, path, stance, first, last, count)


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
        the furthest way, 0 where it is shorter than `LEAST_M`.
    """
    goes = _neighbours(counts, stance)
    length = np.hypot(np.diff(x, prepend=x[:1]), np.diff(y, prepend=y[:1]))
    goes &= length <= FASTEST_MPS * np.diff(time, prepend=time[:1])
    if not goes.any():
        return Ways(*np.full((3, count), np.nan))
    first, last = _runs(stance)
    path, own = _path(x, y, goes, first), np.repeat(np.arange(len(first)), last - first + 1)
    # Times of one stance after those of the one before, more than a window apart.
    begun = np.cumsum(np.append(0.0, time[last] - time[first] + 2.0 * QUICK_S))[:-1]
    at = time - time[first][own] + begun[own]
    after = np.searchsorted(at, at + QUICK_S * (1.0 + 1e-9), side="right") - 1
    quick = np.abs(path[after] - path)
    furthest = np.maximum.reduceat(quick, first)
    rows = np.arange(len(quick))
    start = np.minimum.reduceat(np.where(quick == furthest[own], rows, len(rows) - 1), first)
    found = _ways(time, path, stance, start, after[start], count)
    short = found.metres < LEAST_M
    found.metres[short] = 0.0
    found.begins_s[short] = found.ends_s[short] = np.nan
    found.metres[np.bincount(stance[goes], minlength=count) == 0] = np.nan
    return found


def _phase(samples: StanceSamples) -> Floats:
    """(n,) share of its stance that has passed at each row."""
    return np.asarray(samples.time / samples.time[samples.end][samples.stance])


def _is_placed(samples: StanceSamples) -> Flags:
    """(n,) tell which rows have a contact point."""
    return np.isfinite(samples.x) & np.isfinite(samples.y)


def _runs(stance: Ints) -> tuple[Ints, Ints]:
    """Return the first and the last row of each stance that has any, of ascending stances."""
    first = np.flatnonzero(np.diff(stance, prepend=-1))
    return first, np.append(first[1:], len(stance))[: len(first)] - 1


def _neighbours(counts: Flags, stance: Ints) -> Flags:
    """(n,) tell which rows count, and follow one of their stance that does."""
    goes = counts.copy()
    goes[:1] = False
    goes[1:] &= counts[:-1] & (stance[1:] == stance[:-1])
    return goes


def _path(x: Floats, y: Floats, goes: Flags, first: Ints) -> NDArray[np.complex128]:
    """(n,) m, x + i y: how far the contact point has gone since the stance's first row.

    Args:
        x: (n,) m, contact point; also `y`.
        y: (n,) m.
        goes: (n,) whether the step to each row counts.
        first: (m,) first row of each stance.
    """
    total = np.cumsum(np.where(goes, np.diff(x + 1j * y, prepend=0.0), 0.0))
    return np.asarray(total - np.repeat(total[first], np.diff(first, append=len(x))))


def _ways(
    time: Floats,
    path: NDArray[np.complex128],
    stance: Ints,
    start: Ints,
    last: Ints,
    count: int,
) -> Ways:
    """Return how far contact points go between two rows of each stance that has any.

    Args:
        time: (n,) s after touchdown.
        path: (n,) m; see `_path`.
        stance: (n,) ascending, the stance of each row.
        start: (m,) the row that each way is counted from.
        last: (m,) the last row that counts.
        count: number of stances.
    """
    found = Ways(*np.full((3, count), np.nan))
    first, _ = _runs(stance)
    if not len(first):
        return found
    own, rows = np.cumsum(np.diff(stance, prepend=stance[:1]) > 0), np.arange(len(stance))
    inside = (rows >= start[own]) & (rows <= last[own])
    way = np.where(inside, np.abs(path - path[start][own]), 0.0)
    reach = np.maximum.reduceat(way, first)
    share = way / np.where(reach > 0.0, reach, 1.0)[own]
    half, ends = (
        np.minimum.reduceat(np.where(inside & (share >= part), rows, len(rows)), first)
        for part in (0.5, 0.9)
    )
    rests = inside & (share <= 0.1) & (rows < half[own])
    begins = np.maximum.reduceat(np.where(rests, rows, -1), first)
    found.metres[stance[first]] = reach
    # Where samples are too far apart, it is not seen when it begins.
    goes = (reach > 0.0) & (begins >= 0) & (ends < len(rows))
    found.begins_s[stance[first[goes]]] = time[begins[goes]]
    found.ends_s[stance[first[goes]]] = time[ends[goes]]
    return found
