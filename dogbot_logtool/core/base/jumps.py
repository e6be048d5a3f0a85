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


@dataclass(frozen=True, slots=True)
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
    in_gap = np.isin(base.time[:-1], base.gaps[:, 0])
    candidates = np.flatnonzero((norms(step) > SMALLEST_JUMP_M) & ~in_gap)
    parts = [
        _unexplained(base.time, step, in_gap, candidates[first : first + _CHUNK])
        for first in range(0, len(candidates), _CHUNK)
    ]
    size = np.full_like(step, np.nan)
    size[candidates] = np.concatenate(parts) if parts else np.empty((0, 3))
    turning = np.flatnonzero((np.abs(turn) > SMALLEST_TURN_RAD) & ~in_gap)
    turns = np.zeros_like(turn)
    for first in range(0, len(turning), _CHUNK):
        chunk = turning[first : first + _CHUNK]
        turns[chunk] = _turns(turn, in_gap, chunk)
    rows = np.flatnonzero(np.isfinite(size[:, 0]) | (np.abs(turns) > SMALLEST_STEP_RAD))
    spans = np.stack([base.time[rows], base.time[rows + 1]], axis=1)
    return PoseJumps(rows, spans, np.nan_to_num(size[rows]), turns[rows])


def _turns(turn: Floats, in_gap: Flags, rows: Ints) -> Floats:
    """(c,) rad, turns less the usual one of those around; 0 where others around are as large."""
    around = rows[:, None] + _AROUND
    inside = (around >= 0) & (around < len(turn))
    around = np.clip(around, 0, len(turn) - 1)
    others = np.where(inside & ~in_gap[around], turn[around], np.nan)
    others[np.isfinite(others).sum(axis=1) < _FEWEST] = 0.0
    unexplained: Floats = turn[rows] - median_of_known(others, axis=1)
    deviation = np.nan_to_num(np.abs(others - median_of_known(others, axis=1)[:, None]))
    limit = np.maximum(SMALLEST_TURN_RAD, UNUSUAL * np.sort(deviation, axis=1)[:, -3])
    return np.where(np.abs(unexplained) > limit, unexplained, 0.0)


def _unexplained(time: Ints, step: Floats, in_gap: Flags, rows: Ints) -> Floats:
    """(c, 3) m by which steps are no motion; NaN for those that are explained."""
    seconds = np.diff(time) / 1e9
    around = rows[:, None] + _AROUND
    inside = (around >= 0) & (around < len(step))
    around = np.clip(around, 0, len(step) - 1)
    velocity = step[around] / seconds[around][:, :, None]
    velocity[~inside | in_gap[around]] = np.nan
    enough = np.isfinite(velocity[:, :, 0]).sum(axis=1) >= _FEWEST
    velocity[~enough] = 0.0
    usual = median_of_known(velocity, axis=1)
    duration = seconds[rows][:, None]
    size: Floats = step[rows] - usual * duration
    deviation = np.nan_to_num(np.linalg.norm(velocity - usual[:, None, :], axis=2)) * duration
    third = np.sort(deviation, axis=1)[:, -3]
    change = np.minimum(GRAVITY_MPS2 * seconds[rows] ** 2 / 2.0, COARSE_M)
    unexplained = size.copy()
    unexplained[:, 2] = np.where(
        size[:, 2] < 0.0,
        np.minimum(size[:, 2] + FALLS_AT_MPS * seconds[rows], 0.0),
        size[:, 2],
    )
    limit = np.maximum(np.maximum(SMALLEST_JUMP_M, change), UNUSUAL * third)
    size[~enough | (norms(unexplained) <= limit)] = np.nan
    return size


def without_jumps(base: BaseHistory, jumps: PoseJumps) -> BaseHistory:
    """Return the poses with the jumps taken out: the motion that the base made itself.

    Where the course turns with the yaw, the world was turned: what comes after is turned back.
    """
    if len(jumps.rows) == 0:
        return base
    steps = len(jumps.rows)
    turns = np.where(_follows(base, jumps), jumps.turn_rad, 0.0)
    turned = np.concatenate([[0.0], np.cumsum(turns)])
    moved = np.zeros((steps + 1, 3))
    for number, row in enumerate(jumps.rows.tolist()):
        after = base.position[row + 1]
        before = _turned(after - jumps.size_m[number], turned[number]) + moved[number]
        moved[number + 1] = before - _turned(after, turned[number + 1])
    passed = np.searchsorted(jumps.rows, np.arange(len(base.time)) - 1, side="right")
    angles = base.angles.copy()
    angles[:, 2] -= np.concatenate([[0.0], np.cumsum(jumps.turn_rad)])[passed]
    position = _turned(base.position, turned[passed]) + moved[passed]
    return replace(base, position=position, angles=angles)


def _turned(position: Floats, turn_rad: Floats | float) -> Floats:
    """(..., 3) m, turned back about the vertical."""
    x, y, z = np.moveaxis(position, -1, 0)
    cos, sin = np.cos(turn_rad), np.sin(turn_rad)
    return np.stack([cos * x + sin * y, cos * y - sin * x, z], axis=-1)


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
