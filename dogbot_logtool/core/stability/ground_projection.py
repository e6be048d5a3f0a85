"""The walk seen from above: where the feet were put down, and where the load had its centre."""

from collections.abc import Sequence

import numpy as np

from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.geometry import timespans
from dogbot_logtool.core.geometry.arrays import Floats, Ints, all_finite
from dogbot_logtool.core.geometry.support_polygon import centre_of_pressure
from dogbot_logtool.core.stability.stability import feet_down
from dogbot_logtool.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class GroundPoints:
    """Points on the ground over time."""

    time: Ints
    """(n,) ns, strictly increasing."""
    point: Floats
    """(n, 2) m, horizontal, world frame."""


def footprints(foot: FootHistory) -> GroundPoints:
    """Return where a foot stood: its first known contact point of each stance.

    Points are kept at 25 Hz, so it is one of the first 40 ms; stances without any are left out.
    The times are those of touchdown.
    """
    track, stances = foot.track, foot.stances
    known = np.flatnonzero(all_finite(track.point[:, :2]))
    time = track.time[known]
    first = np.searchsorted(time, stances.touchdown)
    within = np.flatnonzero(first < len(time))
    within = within[time[first[within]] < stances.liftoff[within]]
    return GroundPoints(stances.touchdown[within], track.point[known[first[within]], :2])


def pressure_path(feet: Sequence[FootHistory]) -> GroundPoints:
    """Return the centre of pressure, sum(Fz p) / sum(Fz), at 25 Hz.

    Only over the time known to all feet: without one of them it would be that of the others.
    Its points are NaN where no foot is loaded.

    Args:
        feet: records of all feet, whose vertical forces must be known.
    """
    if not feet:
        return GroundPoints(np.empty(0, np.int64), np.empty((0, 2)))
    known = timespans.intersect([foot.vertical_known for foot in feet])
    time = feet[0].track.time
    time = time[timespans.covers(known, time)]
    points, load = feet_down(time, feet)
    return GroundPoints(time, centre_of_pressure(points[:, :, :2], load))
