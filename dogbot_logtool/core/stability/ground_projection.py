"""The walk seen from above: where the feet were put down, and where the load had its centre."""

from collections.abc import Sequence

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Floats, Ints
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.hulls import centre_of_pressure
from dogbot_logtool.core.stability.stability import feet_down, instants_of
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

    Stances without any are left out. The times are those of touchdown.
    """
    stances = foot.stances
    time, point = foot.track.contact_points
    first = np.searchsorted(time, stances.touchdown)
    within = np.flatnonzero(first < len(time))
    within = within[time[first[within]] < stances.liftoff[within]]
    return GroundPoints(stances.touchdown[within], point[first[within], :2])


def pressure_path(feet: Sequence[FootHistory]) -> GroundPoints:
    """Return the centre of pressure, sum(Fz p) / sum(Fz), at up to 100 Hz.

    Only over the time known to all feet: without one of them it would be that of the others.
    Its points are NaN where no foot is loaded.

    Args:
        feet: records of all feet, whose vertical forces must be known.
    """
    if not feet:
        return GroundPoints(np.empty(0, np.int64), np.empty((0, 2)))
    known = timespans.intersect([foot.vertical_known for foot in feet])
    time = instants_of(feet[0], known)
    points, load = feet_down(time, feet)
    return GroundPoints(time, centre_of_pressure(points[:, :, :2], load))
