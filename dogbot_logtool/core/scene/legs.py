"""Lines from the body to the feet that stand, where no transforms tell how the legs bend."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dogbot_logtool.core.arrays import Floats, Ints
from dogbot_logtool.core.base.poses import Odometry
from dogbot_logtool.core.rotations import normalised, rotate
from dogbot_logtool.core.scene.feet import DrawnFoot


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


def leg_lines(poses: Odometry, feet: Sequence[DrawnFoot], hips: Floats) -> LegLines:
    """Return the legs that stand at the times of poses.

    Args:
        poses: usable ones of the base, (n).
        feet: all feet of the robot.
        hips: (feet, 3) m, base frame; NaN where not known.
    """
    ends = np.empty((len(poses.log_time), len(feet), 2, 3))
    turn = normalised(poses.orientation)
    for column, (foot, hip) in enumerate(zip(feet, hips, strict=True)):
        state = foot.at(poses.log_time)
        turned = rotate(turn, np.broadcast_to(hip, poses.position.shape))
        ends[:, column] = np.stack([poses.position + turned, state.point], axis=1)
        ends[~(state.down & state.known), column] = np.nan
    ends[~np.isfinite(ends).all(axis=(2, 3))] = np.nan
    return LegLines(poses.log_time, poses.time, ends)
