"""Which way is forward, and which way is up."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Floats, median_of
from dogbot_logtool.core.base.falls import TILT_RAD, UPRIGHT_RAD, tilt_rad
from dogbot_logtool.core.base.ground import axis_by_legs, nearest_axis
from dogbot_logtool.core.base.motion import FORWARD_ANGLES, BaseTrack
from dogbot_logtool.core.base.poses import BaseHistory
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.metrics import Base
from dogbot_logtool.core.settings import WalkSettings

STRAIGHT: Final = 0.9
"""Net way over path of a base that goes straight."""
WALKED_M: Final = 0.5
"""m, way to a side from which its direction means something."""


def with_forward_axis(
    settings: WalkSettings, track: BaseTrack, motion: Base | None, *, in_one_world: bool
) -> WalkSettings:
    """Let evidence correct a guessed forward axis.

    The fore and hind feet's contact points decide. Where these are not known, the motion does, if
    it is clearly to a side of the guessed axis; a robot that walks backward contradicts nothing.

    Args:
        settings: with the forward axis of the robot.
        track: the poses of its base.
        motion: of the base along that axis; None: not known.
        in_one_world: whether base and contact points are, so that these tell of the body.
    """
    if not settings.forward_axis_is_assumed:
        return settings
    positions = [foot.leg_position for foot in settings.feet]
    tells = in_one_world and (motion is None or has_heading(motion))
    measured = axis_by_legs(track.history, track.feet, positions) if tells else None
    because = "the fore feet are on that side of the hind feet"
    if measured is None:
        measured = axis_by_motion(motion, settings.forward_axis)
        because = "the robot moves that way"
    if measured is None or measured == settings.forward_axis:
        return settings
    reason = f"{settings.forward_axis} of the guessed robot is not forward here: {because}"
    return replace(settings, forward_axis=measured, forward_axis_reason=reason)


def has_heading(motion: Base) -> bool:
    """Tell whether the heading turns with the way: one that never turns beside a bend is none."""
    net, path = motion.net_displacement_m or 0.0, motion.path_length_m or 0.0
    return bool(motion.yaw_rate_radps) or net >= STRAIGHT * path


def displacements_m(motion: Base | None) -> tuple[float, float]:
    """Return how far the base goes ahead and to the left, m; zeros where that is not known."""
    if motion is None or not has_heading(motion):
        return 0.0, 0.0
    speeds = motion.forward_speed_mps or 0.0, motion.lateral_speed_mps or 0.0
    seconds = motion.duration_s or 0.0
    return speeds[0] * seconds, speeds[1] * seconds


def axis_by_motion(motion: Base | None, forward_axis: str) -> str | None:
    """Return the body's axis that the motion follows, if it is to a side of the given one."""
    forward, left = displacements_m(motion)
    if abs(left) < WALKED_M or abs(left) <= abs(forward):
        return None
    turn = FORWARD_ANGLES[forward_axis]
    along = np.array([forward * np.cos(turn), forward * np.sin(turn)])
    aside = np.array([-left * np.sin(turn), left * np.cos(turn)])
    return nearest_axis(along + aside)


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
