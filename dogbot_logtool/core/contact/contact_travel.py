"""How far the contact point of a foot goes in a stance, and when."""

from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Complexes, Floats, Ints, rows_of_runs, runs_of
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.contact.track import FootTrack

LOADED: Final = 0.5
"""Share of a stance's mean force from which its foot is loaded."""


def contact_travel(samples: Samples, time: Ints, begin: Ints, end: Ints) -> tuple[Floats, Floats]:
    """(k,) m, net travel of the contact point from 10 % to 90 % of a stance, and its reach.

    The reach is the largest distance from where the point is at 10 %. Both are horizontal.

    A round foot that rolls moves its contact point without slipping, so this is not slip yet.
    NaN when no samples with a contact point surround both instants.

    Args:
        samples: n samples of a foot.
        time: (n,) ns.
        begin: (k,) rows of touchdowns.
        end: (k,) rows that end the stances.
    """
    travel, reach = np.full((2, len(begin)), np.nan)
    rows, stance, _ = rows_of_runs(np.maximum(begin - 1, 0), end + 1)
    point = _points(samples, rows)
    known = np.isfinite(point)
    rows, stance, point = rows[known], stance[known], point[known]
    phase = (time[rows] - time[begin][stance]) / (time[end] - time[begin])[stance]
    first, count = runs_of(stance)
    surround = (phase[first] <= 0.1) & (phase[first + count - 1] >= 0.9) & (count >= 2)
    of = stance[first[surround]]
    if not len(of):
        return travel, reach
    # Stances follow each other on one axis, so that all are interpolated at once.
    axis = 4.0 * stance + np.clip(phase, -1.0, 1.0)
    origin = np.full(len(begin), np.nan, np.complex128)
    origin[of], last = (np.interp(4.0 * of + share, axis, point) for share in (0.1, 0.9))
    travel[of] = reach[of] = np.abs(last - origin[of])
    away = np.abs(point - origin[stance])
    counts = (phase >= 0.1) & (phase <= 0.9) & np.isfinite(away)
    np.maximum.at(reach, stance[counts], away[counts])
    return travel, reach


def _points(samples: Samples, rows: Ints) -> Complexes:
    """(m,) m, contact points in the world; not finite where there are none."""
    x, y, _ = samples.position.take(rows, axis=0).astype(np.float64, copy=False).T
    return np.asarray(x + 1j * y)


def travel_under_load(
    samples: Samples, track: FootTrack, begin: Ints, end: Ints, mean: Floats
) -> Floats:
    """Find how far contact points go from 10 % to 90 % of a stance, while loaded.

    Args:
        samples: n samples of a foot.
        track: their times and forces.
        begin: (k,) rows of touchdowns.
        end: (k,) rows that end the stances.
        mean: (k,) N, mean of |F| in each stance.

    Returns:
        (3, k): m, the largest distance from where the point began, by steps between neighbouring
        loaded samples; s after touchdown, with a tenth and with nine tenths of that. NaN where
        nothing is known, and times where the point goes nowhere.
    """
    found = np.full((3, len(mean)), np.nan)
    rows, stance, _ = rows_of_runs(begin, end)
    since = track.time[rows] - track.time[begin][stance]
    phase = since / (track.time[end] - track.time[begin])[stance]
    point = _points(samples, rows)
    inside = (phase >= 0.1) & (phase <= 0.9) & np.isfinite(point)
    if inside.any():
        rows, stance, time, point = rows[inside], stance[inside], since[inside] / 1e9, point[inside]
        first, count = runs_of(stance)
        own = np.repeat(np.arange(len(first)), count)
        step = np.diff(point, prepend=point[0])
        loaded = track.force[rows] >= (LOADED * mean)[stance]
        # A step counts between two loaded rows of one stance.
        counts = loaded & np.roll(loaded, 1)
        counts[first] = False
        total = np.cumsum(np.where(counts, step, 0.0))
        found[:, stance[first]] = _travel(time, total - total[first][own], own, first)
    return found


def _travel(time: Floats, path: Complexes, own: Ints, first: Ints) -> Floats:
    """(3, m): how far contact points go in each of m stances; see `travel_under_load`.

    Args:
        time: (n,) s after touchdown.
        path: (n,) m, way of the contact point since the stance's first row.
        own: (n,) ascending, the stance of each row.
        first: (m,) first row of each stance.
    """
    rows, distance = np.arange(len(path)), np.abs(path)
    reach = np.maximum.reduceat(distance, first)
    share = distance / np.where(reach > 0.0, reach, 1.0)[own]
    half, ends = (
        np.minimum.reduceat(np.where(share >= part, rows, len(rows)), first) for part in (0.5, 0.9)
    )
    rests = (share <= 0.1) & (rows < half[own])
    begins = np.maximum.reduceat(np.where(rests, rows, -1), first)
    # Where samples are too far apart, it is not seen when it begins.
    goes = (reach > 0.0) & (begins >= 0) & (ends < len(rows))
    times = (np.where(goes, time[np.where(goes, row, 0)], np.nan) for row in (begins, ends))
    return np.stack([reach, *times])
