"""How the base moved: path, speed, height, attitude. From poses, never from the recorded twist."""

from collections.abc import Sequence
from math import hypot
from typing import Final, NamedTuple

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Flags, Floats, Ints, aggregate, flagged_runs, median_of
from dogbot_logtool.core.base.ground import LOWEST_M, slope_rad
from dogbot_logtool.core.base.poses import BaseHistory
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.corrections.clock import first_at_each_tick
from dogbot_logtool.core.metrics import Base
from dogbot_logtool.core.settings import GRAVITY_MPS2

AWAY_M: Final = 0.05
"""m, a base that does not get so far away goes nowhere: it stands, and sways."""
_LOOK_HZ: Final = 5.0
_PACE: Final = 2
"""Times the last way of `AWAY_M` that the rest of it may take."""
_LONGEST_BLOCK_NS: Final = 1_000_000_000
"""ns, in which poses are averaged at most."""


class BaseTrack(NamedTuple):
    """The poses that the base's motion is measured on."""

    history: BaseHistory
    """Poses without jumps."""
    height_m: Floats
    """(n,) over the feet, at each pose; NaN where not known."""
    feet: Sequence[FootHistory]
    standing: Ints
    """(s, 2) ns, time in which the robot stands."""
    travels: Ints
    """(t, 2) ns, time in which the base goes somewhere."""
    block: int
    """Poses whose mean makes one point of the path."""

    def path_length_m(self, moves: Flags) -> float:
        """Return the length of the base's horizontal path through means of some poses each, m.

        Args:
            moves: (n - 1,) which steps between poses count.
        """
        time, position = self.history.time, self.history.position[:, :2]
        runs = flagged_runs(moves & timespans.covers(self.travels, time[:-1]))
        return sum(self._path_length(position[start : end + 1]) for start, end in runs.tolist())

    def _path_length(self, path: Floats) -> float:
        """Length of an unbroken path, m."""
        size = min(self.block, max(1, len(path) // 4))
        blocks = len(path) // size
        points = path[: blocks * size].reshape(blocks, size, 2).mean(axis=1)
        length = float(np.hypot(*np.diff(points, axis=0).T).sum())
        # The means lie half a block inside the path's ends.
        return length * (len(path) - 1) / ((blocks - 1) * size) if blocks > 1 else 0.0


def base_track(
    base: BaseHistory, height_m: Floats, feet: Sequence[FootHistory], standing: Ints
) -> BaseTrack:
    """Find when the base goes somewhere, and how many poses make a point of its path.

    Their mean is taken while the base goes half of `AWAY_M`: the noise of single poses would
    lengthen the path.
    """
    away, block = _away_spans(base), 1
    if len(away):
        lasts_ns = min(float(median_of(np.diff(away))) / 2.0, _LONGEST_BLOCK_NS)
        block = max(1, round(lasts_ns / float(median_of(np.diff(base.time)))))
    travels = timespans.intersect([timespans.merge(away), base.known])
    return BaseTrack(base, height_m, feet, standing, travels, block)


def _away_spans(base: BaseHistory) -> Ints:
    """(t, 2) ns, from each place to the time at which the base is `AWAY_M` away from it."""
    rows = np.flatnonzero(first_at_each_tick(base.time, _LOOK_HZ))
    time = base.time[rows].tolist()
    points = base.position[rows, :2].tolist()
    spans = []
    start = 0
    for row, (x, y) in enumerate(points):
        from_x, from_y = points[start]
        if hypot(x - from_x, y - from_y) >= AWAY_M:
            spans.append((time[start], time[row]))
            start = row
    if spans:
        # What is left of the way, as far as the base keeps its pace.
        began, ended = spans[-1]
        spans.append((ended, min(int(base.time[-1]), ended + _PACE * (ended - began))))
    return np.array(spans, np.int64).reshape(-1, 2)


def base_motion(
    track: BaseTrack, forward_rad: float, within: Ints = timespans.ALWAYS
) -> Base | None:
    """Measure the motion of the base; None without two poses.

    Args:
        track: poses, and what the feet say of them.
        forward_rad: from the body's x axis to the axis that points forward.
        within: (w, 2) ns, a part of the log.
    """
    base = track.history
    inside = timespans.covers(within, base.time)
    rows = np.flatnonzero(inside)
    if len(rows) < 2:
        return None
    first, last = int(rows[0]), int(rows[-1])
    moves = inside[:-1] & inside[1:] & ~np.isin(base.time[:-1], base.gaps[:, 0])
    duration = float(np.diff(base.time)[moves].sum() / 1e9)
    travelled = (float(each[moves].sum()) for each in base.steps(forward_rad))
    forward_speed, left_speed, yaw_rate = (
        each / duration if duration > 0.0 else None for each in travelled
    )
    walked = moves & ~timespans.covers(track.standing, base.time[:-1])
    path = track.path_length_m(walked)
    height = aggregate(track.height_m[rows])
    roll, pitch = roll_and_pitch(base.angles[rows], forward_rad)
    net = base.position[last] - base.position[first]
    return Base(
        duration_s=duration,
        path_length_m=path,
        net_displacement_m=float(np.hypot(net[0], net[1])),
        forward_speed_mps=forward_speed,
        lateral_speed_mps=left_speed,
        yaw_change_rad=float(base.angles[last, 2] - base.angles[first, 2]),
        yaw_rate_radps=yaw_rate,
        height_m=height,
        climb_m=float(net[2]),
        slope_rad=slope_rad(track.feet, within),
        roll_rad=aggregate(roll),
        pitch_rad=aggregate(pitch),
        froude=froude_number(forward_speed, height.mean if height else None),
    )


def roll_and_pitch(angles: Floats, forward_rad: float) -> tuple[Floats, Floats]:
    """Return roll and pitch about the robot's own forward axis and the axis to its left.

    Args:
        angles: (n, 3) rad, roll, pitch, yaw of the body's x, y, z axes (REP-103).
        forward_rad: from the body's x axis to the axis that points forward.

    Returns:
        (n,) rad each.
    """
    roll, pitch = angles[:, 0], angles[:, 1]
    # Heights of the ends of the body's unit vectors.
    x, y, z = -np.sin(pitch), np.cos(pitch) * np.sin(roll), np.cos(pitch) * np.cos(roll)
    forward = np.cos(forward_rad) * x + np.sin(forward_rad) * y
    left = np.cos(forward_rad) * y - np.sin(forward_rad) * x
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
