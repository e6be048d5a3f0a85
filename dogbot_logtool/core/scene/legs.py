"""Lines from the body to the feet that stand, where no transforms tell how the legs bend."""

from collections.abc import Sequence

import numpy as np

from dogbot_logtool.core.arrays import Floats, Ints, concatenated
from dogbot_logtool.core.base.poses import Odometry
from dogbot_logtool.core.hulls import NEAR_NS
from dogbot_logtool.core.rotations import normalised, rotate
from dogbot_logtool.core.scene.feet import DrawnFoot
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


def leg_lines(
    poses: Odometry, feet: Sequence[DrawnFoot], hips: Floats, opening: int | None = None
) -> LegLines:
    """Return the legs that stand at the times of poses.

    Args:
        poses: usable ones of the base, (n).
        feet: all feet of the robot.
        hips: (feet, 3) m, base frame; NaN where not known.
        opening: ns, the log's first time, at which the first of its poses stands, too, if it
            follows at once; None: these are later ones.
    """
    states = [foot.at(poses.log_time) for foot in feet]
    point = np.stack([state.point for state in states], axis=1)
    down = np.stack([state.down & state.known for state in states], axis=1)
    turn = np.repeat(normalised(poses.orientation), len(feet), axis=0)
    turned = rotate(turn, np.tile(hips, (len(poses.log_time), 1)))
    hip = poses.position[:, None] + turned.reshape(point.shape)
    ends = np.stack([hip, point], axis=2)
    told = down & np.isfinite(ends).all(axis=(2, 3))
    legs = LegLines(poses.log_time, poses.time, np.where(told[:, :, None, None], ends, np.nan))
    if opening is None or not _follows(poses.log_time, opening):
        return legs
    first = LegLines(np.array([opening]), np.array([opening]), legs.ends[:1])
    return concatenated([first, legs])


def _follows(log_time: Ints, opening: int) -> bool:
    """Tell whether the first of some log times, ns, follows the log's first time at once."""
    return len(log_time) > 0 and 0 < int(log_time[0]) - opening <= NEAR_NS
