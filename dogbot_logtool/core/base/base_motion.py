"""How the base moved: path, speed, height, attitude. From poses, never from the recorded twist."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Flags, Floats, Ints, aggregate
from dogbot_logtool.core.base.base_history import BaseHistory
from dogbot_logtool.core.base.ground import LOWEST_M, slope_rad
from dogbot_logtool.core.base.pose_jumps import PoseJumps
from dogbot_logtool.core.base.travel import Travel, path_length_m
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.load.loads import GRAVITY_MPS2
from dogbot_logtool.core.metrics import Base
from dogbot_logtool.core.rotations import along_heading
from dogbot_logtool.dataclass import dataclass

FORWARD_ANGLES: Final = {"+x": 0.0, "+y": np.pi / 2.0, "-x": np.pi, "-y": -np.pi / 2.0}
"""rad from the body's x axis to the axis that points forward."""
_CHUNK: Final = 1_000_000
"""Poses that are worked on at once, to spare memory."""


@dataclass(frozen=True, slots=True)
class BaseTrack:
    """The poses that the base's motion is measured on."""

    history: BaseHistory
    """Poses without jumps."""
    travel: Travel
    height_m: Floats
    """(n,) over the feet, at each pose; NaN where not known."""
    feet: Sequence[FootHistory]
    standing: Ints
    """(s, 2) ns, time in which the robot stands."""
    jumps: PoseJumps
    """Jumps that are taken out of the poses' places, but not out of their yaw."""


def base_motion(track: BaseTrack, forward_axis: str, within: Ints | None = None) -> Base | None:
    """Measure the motion of the base; None without two poses.

    Args:
        track: poses, and what the feet say of them.
        forward_axis: the body's axis that points forward, ``+x`` and so on.
        within: (w, 2) ns, a part of the log; None: all of it.
    """
    base = track.history
    inside = np.ones(len(base.time), np.bool_)
    if within is not None:
        inside = timespans.covers(within, base.time)
    rows = np.flatnonzero(inside)
    if len(rows) < 2:
        return None
    first, last = int(rows[0]), int(rows[-1])
    moves = inside[:-1] & inside[1:] & ~np.isin(base.time[:-1], base.gaps[:, 0])
    duration, forward, left, turned = _travelled(base, moves, forward_axis)
    walked = moves & ~timespans.covers(track.standing, base.time[:-1])
    path = path_length_m(base, track.travel, walked)
    height = aggregate(track.height_m[rows])
    roll, pitch = roll_and_pitch(base.angles[rows], forward_axis)
    jumped = track.jumps.turned_rad(int(base.time[first]), int(base.time[last]))
    net = base.position[last] - base.position[first]
    forward_speed = forward / duration if duration > 0.0 else None
    return Base(
        duration_s=duration,
        path_length_m=path,
        net_displacement_m=float(np.hypot(net[0], net[1])),
        forward_speed_mps=forward_speed,
        lateral_speed_mps=left / duration if duration > 0.0 else None,
        yaw_change_rad=float(base.angles[last, 2] - base.angles[first, 2]) - jumped,
        yaw_rate_radps=(turned - jumped) / duration if duration > 0.0 else None,
        height_m=height,
        climb_m=float(net[2]),
        slope_rad=slope_rad(track.feet, within),
        roll_rad=aggregate(roll),
        pitch_rad=aggregate(pitch),
        froude=froude_number(forward_speed, height.mean if height else None),
    )


def _travelled(
    base: BaseHistory, moves: Flags, forward_axis: str
) -> tuple[float, float, float, float]:
    """Add up the steps from pose to pose that count.

    Returns:
        s known; m along the forward axis, m to the left of it; rad turned.
    """
    total = np.zeros(4)
    for start in range(0, len(base.time) - 1, _CHUNK):
        rows = slice(start, start + _CHUNK + 1)
        chosen = moves[start : start + _CHUNK]
        time, yaw = base.time[rows], base.angles[rows, 2]
        step = np.diff(base.position[rows, :2], axis=0)[chosen]
        heading = (yaw[1:] + yaw[:-1])[chosen] / 2.0 + FORWARD_ANGLES[forward_axis]
        forward, left = along_heading(step, heading)
        seconds = np.diff(time)[chosen].sum() / 1e9
        total += (seconds, forward.sum(), left.sum(), np.diff(yaw)[chosen].sum())
    duration, ahead, aside, turned = total.tolist()
    return duration, ahead, aside, turned


def roll_and_pitch(angles: Floats, forward_axis: str) -> tuple[Floats, Floats]:
    """Return roll and pitch about the robot's own forward axis and the axis to its left.

    Args:
        angles: (n, 3) rad, roll, pitch, yaw of the body's x, y, z axes (REP-103).
        forward_axis: the body's axis that points forward.

    Returns:
        (n,) rad each.
    """
    turn = FORWARD_ANGLES[forward_axis]
    roll, pitch = angles[:, 0], angles[:, 1]
    # Heights of the ends of the body's unit vectors.
    x, y, z = -np.sin(pitch), np.cos(pitch) * np.sin(roll), np.cos(pitch) * np.cos(roll)
    forward = np.cos(turn) * x + np.sin(turn) * y
    left = np.cos(turn) * y - np.sin(turn) * x
    return np.arctan2(left, z), -np.arcsin(np.clip(forward, -1.0, 1.0))


def froude_number(speed_mps: float | None, height_m: float | None) -> float | None:
    """Return v^2 / (g h); None without a speed, or a height over the ground."""
    if speed_mps is None or height_m is None or height_m < LOWEST_M:
        return None
    return speed_mps**2 / (GRAVITY_MPS2 * height_m)


def stride_lengths(base: BaseHistory, touchdown: Ints, end: Ints) -> Floats:
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
