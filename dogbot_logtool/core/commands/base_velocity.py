"""The base's velocity in its own frame, from its poses, as a mean over about a stride."""

from typing import Final

import numpy as np

from dogbot_logtool.core.base.base_history import BaseHistory
from dogbot_logtool.core.base.base_motion import FORWARD_ANGLES
from dogbot_logtool.core.geometry import timespans
from dogbot_logtool.core.geometry.arrays import Floats, Ints
from dogbot_logtool.core.geometry.rotations import along_heading
from dogbot_logtool.core.geometry.runs import added_within
from dogbot_logtool.dataclass import dataclass

SPARSE_NS: Final = 1_000_000_000
"""ns; poses further apart than this tell no speed."""


@dataclass(frozen=True, slots=True)
class Odometer:
    """How far a robot has gone along axes that turn with it.

    Its difference over a time is the mean velocity in the robot's own frame, however it turns.
    """

    origin: int
    """ns."""
    seconds: Floats
    """(n,) s since the origin."""
    way: Floats
    """(n, 3) m forward, m to the left, rad turned to the left; since the first row."""
    known: Ints
    """(k, 2) ns, time without gaps and jumps."""

    def mean_rate(self, time: Ints, window_ns: int) -> Floats:
        """(m, 3) m/s and rad/s, means over a window about each time."""
        since = (time - self.origin) / 1e9
        half = window_ns / 2e9
        return added_within(self.way, self.seconds, since, half) / (2.0 * half)


def base_odometer(base: BaseHistory, forward_axis: str, jumps: Ints) -> Odometer | None:
    """Add up the steps from pose to pose in the robot's own frame (yaw only).

    Args:
        base: poses without jumps.
        forward_axis: the body's axis that points forward.
        jumps: (j, 2) ns, spans that nothing is measured across.

    Returns:
        None without two poses.
    """
    if len(base.time) < 2:
        return None
    yaw = base.angles[:, 2]
    heading = (yaw[1:] + yaw[:-1]) / 2.0 + FORWARD_ANGLES[forward_axis]
    forward, left = along_heading(np.diff(base.position[:, :2], axis=0), heading)
    steps = np.stack([forward, left, np.diff(yaw)], axis=1)
    sparse = np.flatnonzero(np.diff(base.time) > SPARSE_NS)
    broken = np.stack([base.time[sparse], base.time[sparse + 1]], axis=1)
    origin = int(base.time[0])
    return Odometer(
        origin=origin,
        seconds=(base.time - origin) / 1e9,
        way=np.concatenate([np.zeros((1, 3)), np.cumsum(steps, axis=0)]),
        known=timespans.subtract(base.known, timespans.merge(np.concatenate([jumps, broken]))),
    )
