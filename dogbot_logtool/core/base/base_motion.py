"""How the base moved: path, speed, height, attitude. From poses, never from the recorded twist."""

from dataclasses import dataclass
from typing import Final

import numpy as np

from dogbot_logtool.core.base.base_record import BaseRecord, TwistFit
from dogbot_logtool.core.geometry.aggregates import Aggregate, aggregate
from dogbot_logtool.core.geometry.arrays import Floats, Ints
from dogbot_logtool.core.load.loads import GRAVITY_MPS2

FORWARD_ANGLES: Final = {"+x": 0.0, "+y": np.pi / 2.0, "-x": np.pi, "-y": -np.pi / 2.0}
"""rad from the body's x axis to the axis that points forward."""
LOWEST_M: Final = 1e-3
"""m, lowest mean height of a base that has a Froude number."""
_CHUNK: Final = 1_000_000
"""Poses that are worked on at once, to spare memory."""
FEWEST_TWISTS: Final = 20
TOLD_APART_MPS: Final = 0.01
"""Root mean square difference of the readings from which the twist's frame can be told."""
LEANING: Final = 0.25
"""Half-way between undecided (0) and a perfect fit (0.5)."""


@dataclass(frozen=True, slots=True)
class BaseMotion:
    """Figures of the base over the time that poses are known."""

    duration_s: float
    """s, first to last pose, gaps left out."""
    path_length_m: float
    """m, sum of the horizontal steps between poses at up to 100 Hz; steps over gaps left out."""
    net_displacement_m: float
    """m, horizontal distance of last and first pose."""
    mean_speed_mps: float | None
    """m/s, path length over duration."""
    forward_speed_mps: float | None
    """m/s, mean of the displacement rate along the forward axis, yaw only."""
    lateral_speed_mps: float | None
    """m/s, the same to the left of it."""
    yaw_change_rad: float
    """rad, last minus first yaw, unwrapped."""
    height_m: Aggregate | None
    """m, z of the base in the world."""
    roll_rad: Aggregate | None
    pitch_rad: Aggregate | None
    froude: float | None
    """v^2 / (g h), v the mean speed and h the mean height (Alexander 1984); None below 1 mm."""
    twist_frame: str | None
    """``world``, ``body`` or ``ambiguous``; None with too few velocities."""


def base_motion(base: BaseRecord, forward_axis: str) -> BaseMotion | None:
    """Measure the motion of the base; None without two poses.

    Args:
        base: poses.
        forward_axis: the body's axis that points forward, ``+x`` and so on.
    """
    if len(base.time) < 2:
        return None
    duration, path, forward, left = _travel(base, forward_axis)
    height, roll, pitch = (
        aggregate(column) for column in (base.position[:, 2], base.angles[:, 0], base.angles[:, 1])
    )
    net = base.position[-1, :2] - base.position[0, :2]
    speed = path / duration if duration > 0.0 else None
    return BaseMotion(
        duration_s=duration,
        path_length_m=path,
        net_displacement_m=float(np.hypot(net[0], net[1])),
        mean_speed_mps=speed,
        forward_speed_mps=forward / duration if duration > 0.0 else None,
        lateral_speed_mps=left / duration if duration > 0.0 else None,
        yaw_change_rad=float(base.angles[-1, 2] - base.angles[0, 2]),
        height_m=height,
        roll_rad=roll,
        pitch_rad=pitch,
        froude=froude_number(speed, height.mean if height else None),
        twist_frame=twist_frame(base.twist),
    )


def _travel(base: BaseRecord, forward_axis: str) -> tuple[float, float, float, float]:
    """Add up the steps from pose to pose, gaps left out.

    Returns:
        s known; m of path, m along the forward axis, m to the left of it.
    """
    total = np.zeros(4)
    for start in range(0, len(base.time) - 1, _CHUNK):
        rows = slice(start, start + _CHUNK + 1)
        time, yaw = base.time[rows], base.angles[rows, 2]
        moves = ~np.isin(time[:-1], base.gaps[:, 0])
        step = np.diff(base.position[rows, :2], axis=0)[moves]
        heading = (yaw[1:] + yaw[:-1])[moves] / 2.0 + FORWARD_ANGLES[forward_axis]
        forward, left = along_heading(step, heading)
        length = np.hypot(step[:, 0], step[:, 1])
        seconds = np.diff(time)[moves].sum() / 1e9
        total += (seconds, length.sum(), forward.sum(), left.sum())
    duration, path, ahead, aside = total.tolist()
    return duration, path, ahead, aside


def along_heading(vector: Floats, heading: Floats) -> tuple[Floats, Floats]:
    """Split horizontal vectors into their parts along a heading and to the left of it.

    Args:
        vector: (n, 2) in the world.
        heading: (n,) rad.

    Returns:
        (n,) forward and (n,) left, in the vectors' unit.
    """
    cos, sin = np.cos(heading), np.sin(heading)
    return vector[:, 0] * cos + vector[:, 1] * sin, vector[:, 1] * cos - vector[:, 0] * sin


def froude_number(speed_mps: float | None, height_m: float | None) -> float | None:
    """Return v^2 / (g h); None without a speed, or a height above the ground."""
    if speed_mps is None or height_m is None or height_m < LOWEST_M:
        return None
    return speed_mps**2 / (GRAVITY_MPS2 * height_m)


def twist_frame(fit: TwistFit) -> str | None:
    """Decide the frame of recorded velocities by which reading fits the poses' derivative.

    The regression coefficient leaning / difference is 0.5 where the world reading fits exactly,
    -0.5 where the body reading does, and noise does not change its sign.
    """
    if fit.pairs < FEWEST_TWISTS:
        return None
    if fit.difference / fit.pairs < TOLD_APART_MPS**2:
        return "ambiguous"
    leaning = fit.leaning / fit.difference
    if abs(leaning) < LEANING:
        return "ambiguous"
    return "world" if leaning > 0.0 else "body"


def stride_lengths(base: BaseRecord, touchdown: Ints, end: Ints) -> Floats:
    """Return the horizontal distance of the base between consecutive touchdowns of a foot.

    Args:
        base: poses.
        touchdown: (n,) ns, of each stride.
        end: (n,) ns, the next touchdown.

    Returns:
        (n,) m; NaN where the poses do not tell.
    """
    travel = base.position_at(end) - base.position_at(touchdown)
    length: Floats = np.hypot(travel[:, 0], travel[:, 1])
    return length
