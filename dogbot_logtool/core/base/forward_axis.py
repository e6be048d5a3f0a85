"""Which way is forward, where the robot was only guessed."""

from dataclasses import replace
from typing import Final

import numpy as np

from dogbot_logtool.core.base.base_motion import FORWARD_ANGLES, BaseTrack
from dogbot_logtool.core.base.ground import axis_by_legs, nearest_axis
from dogbot_logtool.core.metrics import Base
from dogbot_logtool.core.settings import StatsSettings

WALKED_M: Final = 0.5
"""m, way to a side from which its direction means something."""


def with_forward_axis(
    settings: StatsSettings, track: BaseTrack, motion: Base | None
) -> StatsSettings:
    """Let evidence correct a guessed forward axis.

    The fore and hind feet's contact points decide. Where these are not known, the motion does, if
    it is clearly to a side of the guessed axis; a robot that walks backward contradicts nothing.

    Args:
        settings: with the forward axis of the robot.
        track: the poses of its base.
        motion: of the base along that axis; None: not known.
    """
    if not settings.forward_axis_is_assumed:
        return settings
    positions = [foot.leg_position for foot in settings.feet]
    measured = axis_by_legs(track.history, track.feet, positions)
    because = "the fore feet are on that side of the hind feet"
    if measured is None:
        measured = axis_by_motion(motion, settings.forward_axis)
        because = "the robot moves that way"
    if measured is None or measured == settings.forward_axis:
        return settings
    reason = f"{settings.forward_axis} of the guessed robot is not forward here: {because}"
    return replace(settings, forward_axis=measured, forward_axis_reason=reason)


def axis_by_motion(motion: Base | None, forward_axis: str) -> str | None:
    """Return the body's axis that the motion follows, if it is to a side of the given one."""
    if motion is None or motion.forward_speed_mps is None or motion.lateral_speed_mps is None:
        return None
    forward, left = motion.forward_speed_mps, motion.lateral_speed_mps
    if abs(left) * (motion.duration_s or 0.0) < WALKED_M or abs(left) <= abs(forward):
        return None
    turn = FORWARD_ANGLES[forward_axis]
    along = np.array([forward * np.cos(turn), forward * np.sin(turn)])
    aside = np.array([-left * np.sin(turn), left * np.cos(turn)])
    return nearest_axis(along + aside)
