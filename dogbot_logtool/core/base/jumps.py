"""Jumps of the pose: steps between neighbouring poses that are no motion of the base."""

from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Flags, Floats, Ints, median_of_known, norms
from dogbot_logtool.core.base.poses import BaseHistory
from dogbot_logtool.core.settings import GRAVITY_MPS2

SMALLEST_JUMP_M: Final = 0.05
"""m, what is smaller may be noise."""
SMALLEST_TURN_RAD: Final = 0.02
"""rad, the same."""
FALLS_AT_MPS: Final = 3.0
"""m/s, a falling base is not faster."""
COARSE_M: Final = 0.5
"""m, smallest jump at rates so low that the base may change its speed between poses."""
SMALLEST_STEP_RAD: Final = np.radians(5.0)
"""rad, a turn without a step of the position is one from here on."""
COURSE_STEPS: Final = 30
"""Poses before and after a jump between which the course is told."""
COURSE_M: Final = 0.02
"""m, the shortest way that tells a course."""
UNUSUAL: Final = 5.0
"""Times by which a jump exceeds the third largest of the deviations around it."""
_AROUND: Final = np.concatenate([np.arange(-10, 0), np.arange(1, 11)])
"""Steps before and after that tell the base's own speed."""
_FEWEST: Final = 6
_CHUNK: Final = 20_000


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class PoseJumps:
    """Steps between neighbouring poses that are no motion of the base."""

    rows: Ints
    """(j,) the pose before each jump."""
    spans: Ints
    """(j, 2) ns, the pose before and the one after each jump."""
    size_m: Floats
    """(j, 3) m, the step less what the base's own speed explains."""
    turn_rad: Floats
    """(j,) rad, by how much the yaw jumps, too."""


def find_jumps(base: BaseHistory) -> PoseJumps:
    """Find the steps that the median of the velocities around them does not explain.

    A step counts that deviates from it by more than the other steps around do, more than a fall
    explains, and more than a change of speed between two poses may be; a turn, by more than the
    other turns around do.
    """
    step, turn = np.diff(base.position, axis=0), np.diff(base.angles[:, 2])
    seconds = np.diff(base.time) / 1e9
    in_gap = np.isin(base.time[:-1], base.gaps[:, 0])
    size, turned = np.zeros_like(step), np.zeros_like(turn)
    far = np.flatnonzero((norms(step) > SMALLEST_JUMP_M) & ~in_gap)
    for rows in np.split(far, range(_CHUNK, len(far), _CHUNK)):
        unusual, third = _unusual(step, seconds, in_gap, rows)
        change = np.minimum(GRAVITY_MPS2 * seconds[rows] ** 2 / 2.0, COARSE_M)
        limit = np.maximum(np.maximum(SMALLEST_JUMP_M, change), UNUSUAL * third)
        # What falls goes down by itself.
        sinks = np.minimum(unusual[:, 2] + FALLS_AT_MPS * seconds[rows], 0.0)
        jumps = unusual.copy()
        jumps[:, 2] = np.where(unusual[:, 2] < 0.0, sinks, unusual[:, 2])
        size[rows] = np.where((norms(jumps) > limit)[:, None], unusual, 0.0)
    turning = np.flatnonzero((np.abs(turn) > SMALLEST_TURN_RAD) & ~in_gap)
    for rows in np.split(turning, range(_CHUNK, len(turning), _CHUNK)):
        unusual, third = _unusual(turn[:, None], seconds, in_gap, rows)
        limit = np.maximum(SMALLEST_TURN_RAD, UNUSUAL * third)
        turned[rows] = np.where(np.abs(unusual[:, 0]) > limit, unusual[:, 0], 0.0)
    found = np.flatnonzero(size.any(axis=1) | (np.abs(turned) > SMALLEST_STEP_RAD))
    spans = np.stack([base.time[found], base.time[found + 1]], axis=1)
    return PoseJumps(found, spans, size[found], turned[found])


def _unusual(step: Floats, seconds: Floats, in_gap: Flags, rows: Ints) -> tuple[Floats, Floats]:
    """Compare steps with those around them.

    Args:
        step: (n, k) from each pose to the next.
        seconds: (n,) s, that each takes.
        in_gap: (n,) whether a silence lies between.
        rows: (c,) those that are compared.

    Returns:
        (c, k) what the usual velocity around does not explain, zero where too few are known; and
        (c,) the third largest deviation from that velocity over as long a time.
    """
    around = rows[:, None] + _AROUND
    outside = (around < 0) | (around >= len(step))
    around = np.clip(around, 0, len(step) - 1)
    velocity = step[around] / seconds[around][:, :, None]
    velocity[outside | in_gap[around]] = np.nan
    few = np.isfinite(velocity[:, :, 0]).sum(axis=1) < _FEWEST
    velocity[few] = 0.0
    usual, duration = median_of_known(velocity, axis=1), seconds[rows][:, None]
    deviation = np.nan_to_num(np.linalg.norm(velocity - usual[:, None, :], axis=2)) * duration
    unusual: Floats = np.where(few[:, None], 0.0, step[rows] - usual * duration)
    return unusual, np.sort(deviation, axis=1)[:, -3]


def without_jumps(base: BaseHistory, jumps: PoseJumps) -> BaseHistory:
    """Return the poses with the jumps taken out: the motion that the base made itself.

    Where the course turns with the yaw, the world was turned: what comes after is turned back.
    """
    if len(jumps.rows) == 0:
        return base
    turns = np.where(_follows(base, jumps), jumps.turn_rad, 0.0)
    turned = np.concatenate([[0.0], np.cumsum(turns)])
    after = base.position[jumps.rows + 1]
    moves = _turned(after - jumps.size_m, turned[:-1]) - _turned(after, turned[1:])
    moved = np.concatenate([np.zeros((1, 3)), np.cumsum(moves, axis=0)])
    passed = np.searchsorted(jumps.rows, np.arange(len(base.time)) - 1, side="right")
    angles = base.angles.copy()
    angles[:, 2] -= np.concatenate([[0.0], np.cumsum(jumps.turn_rad)])[passed]
    position = _turned(base.position, turned[passed]) + moved[passed]
    return replace(base, position=position, angles=angles)


def _turned(position: Floats, turn_rad: Floats) -> Floats:
    """(n, 3) m, turned back about the vertical."""
    x, y, z = position.T
    cos, sin = np.cos(turn_rad), np.sin(turn_rad)
    return np.stack([cos * x + sin * y, cos * y - sin * x, z], axis=1)


def _follows(base: BaseHistory, jumps: PoseJumps) -> Flags:
    """(j,) whether the course turns with the yaw, or is not known."""
    rows, last = jumps.rows, len(base.time) - 1
    start = np.maximum(rows - COURSE_STEPS, np.concatenate([[0], rows[:-1] + 1]))
    end = np.minimum(rows + 1 + COURSE_STEPS, np.concatenate([rows[1:], [last]]))
    before = base.position[rows, :2] - base.position[start, :2]
    after = base.position[end, :2] - base.position[rows + 1, :2]
    far = np.minimum(np.hypot(*before.T), np.hypot(*after.T)) > COURSE_M
    course = np.arctan2(after[:, 1], after[:, 0]) - np.arctan2(before[:, 1], before[:, 0])
    off = np.abs(np.angle(np.exp(1j * (course - jumps.turn_rad))))
    return np.asarray(~far | (off < np.abs(np.angle(np.exp(1j * course)))))
