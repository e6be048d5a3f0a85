"""Poses whose z axis is not up, of the world or of the body, told by a walk that goes on."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Floats, median_of
from dogbot_logtool.core.base.base_history import BaseHistory
from dogbot_logtool.core.base.falls import TILT_RAD, UPRIGHT_RAD, tilt_rad
from dogbot_logtool.core.contact.foot_history import FootHistory

STEEP_RAD: Final = np.radians(45.0)
"""No legged robot walks with its back so steep."""
FEWEST_STRIDES: Final = 3
"""Strides of a foot, while the base leans so far."""
TOPPLES_NS: Final = 1_000_000_000
"""From upright to lying, a robot falls in less."""
ALIKE: Final = 0.8
"""Least ratio of periods, and of duty factors, of strides that are the same walk."""


def leaning_walk_rad(base: BaseHistory, feet: Sequence[FootHistory]) -> float | None:
    """Return how far the base leans at most while the robot walks on as it does upright, rad.

    A robot that fell may move its legs, but does not carry itself on them as before. One that walks
    on has poses whose z axis is not up: those of motion capture with y up, say.

    Args:
        base: poses.
        feet: histories of all feet.

    Returns:
        None where it does not lean, or hardly any foot walks on.
    """
    if not len(base.time):
        return None
    tilt = tilt_rad(base.angles)
    if not (tilt > STEEP_RAD).any() or _topples(base, tilt):
        return None
    leaning = [_walks_on(foot, base, tilt) for foot in feet if len(foot.stances.touchdown)]
    if not leaning or 2 * sum(leaning) <= len(leaning):
        return None
    return float(tilt.max())


def _topples(base: BaseHistory, tilt: Floats) -> bool:
    """Tell whether the base leans all at once, as in a fall; a turn on the spot is slower."""
    lies = np.flatnonzero(tilt > TILT_RAD)
    stood = np.flatnonzero(tilt[: lies[0]] < UPRIGHT_RAD) if len(lies) else lies
    return len(stood) > 0 and bool(base.time[lies[0]] - base.time[stood[-1]] < TOPPLES_NS)


def _walks_on(foot: FootHistory, base: BaseHistory, tilt: Floats) -> bool:
    """Tell whether a foot's strides with a leaning base are like those with an upright one."""
    down, up = foot.stances.touchdown, foot.stances.liftoff
    if len(down) <= FEWEST_STRIDES:
        return False
    at = np.interp((down - base.time[0]).astype(np.float64), base.time - base.time[0], tilt)
    period, stance = np.diff(down).astype(np.float64), (up - down)[:-1].astype(np.float64)
    leans = (at[:-1] > STEEP_RAD) & (at[1:] > STEEP_RAD)
    if leans.sum() < FEWEST_STRIDES:
        return False
    upright = (at[:-1] < STEEP_RAD) & (at[1:] < STEEP_RAD)
    if not upright.any():
        return True
    duty = stance / period
    ratios = [median_of(each[leans]) / median_of(each[upright]) for each in (period, duty)]
    return all(ALIKE <= ratio <= 1.0 / ALIKE for ratio in ratios)
