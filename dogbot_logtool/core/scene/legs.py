"""Lines from the body to the feet that stand, where no transforms tell how the legs bend."""

from collections.abc import Sequence

import numpy as np

from dogbot_logtool.core.base.odometry import Odometry
from dogbot_logtool.core.contact.foot_tracker import FootTracker
from dogbot_logtool.core.geometry.arrays import Floats, Ints
from dogbot_logtool.core.geometry.rotations import normalised, rotate
from dogbot_logtool.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class LegLines:
    """The legs at some times."""

    log_time: Ints
    """(n,) ns."""
    stamp: Ints
    """(n,) ns."""
    ends: Floats
    """(n, feet, 2, 3) m, world frame: hip and contact point; NaN where the foot is not down, or
    where that or its position is not known."""


def leg_lines(poses: Odometry, feet: Sequence[FootTracker], hips: Floats) -> LegLines:
    """Return the legs that stand at the times of poses.

    Args:
        poses: usable ones of the base, (n).
        feet: all feet of the robot.
        hips: (feet, 3) m, base frame; NaN where not known.
    """
    states = [foot.at(poses.log_time) for foot in feet]
    point = np.stack([state.point for state in states], axis=1)
    down = np.stack([state.down & state.known for state in states], axis=1)
    turn = np.repeat(normalised(poses.orientation), len(feet), axis=0)
    turned = rotate(turn, np.tile(hips, (len(poses.log_time), 1)))
    hip = poses.position[:, None] + turned.reshape(point.shape)
    ends = np.stack([hip, point], axis=2)
    told = down & np.isfinite(ends).all(axis=(2, 3))
    return LegLines(poses.log_time, poses.time, np.where(told[:, :, None, None], ends, np.nan))
