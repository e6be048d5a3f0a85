"""Jumps of the base's pose: steps that its own speeds before and after do not explain."""

from dataclasses import replace
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Flags, Floats, Ints, median_of, median_of_known, norms
from dogbot_logtool.core.base.base_history import BaseHistory
from dogbot_logtool.dataclass import dataclass

SMALLEST_JUMP_M: Final = 0.05
"""m, what is smaller may be noise."""
SMALLEST_TURN_RAD: Final = 0.02
"""rad, the same."""
GRAVITY_MPS2: Final = 9.81
FALLS_AT_MPS: Final = 3.0
"""m/s, a falling base is not faster."""
COARSE_M: Final = 0.5
"""m, smallest jump at rates so low that the base may change its speed between poses."""
UNUSUAL: Final = 5.0
"""Times by which a jump exceeds the third largest of the deviations around it."""
_AROUND: Final = np.concatenate([np.arange(-10, 0), np.arange(1, 11)])
"""Steps before and after that tell the base's own speed."""
_FEWEST: Final = 6
_CHUNK: Final = 20_000


@dataclass(frozen=True, slots=True)
class PoseJumps:
    """Steps between neighbouring poses that are no motion of the base."""

    spans: Ints
    """(j, 2) ns, the pose before and the one after each jump."""
    size_m: Floats
    """(j, 3) m, the step less what the base's own speed explains."""
    turn_rad: Floats
    """(j,) rad, by how much the yaw jumps, too."""

    def turned_rad(self, start: int, end: int) -> float:
        """Return how far all jumps between two times, ns, turn the base."""
        inside = (self.spans[:, 0] >= start) & (self.spans[:, 1] <= end)
        return float(self.turn_rad[inside].sum())


def find_jumps(base: BaseHistory) -> PoseJumps:
    """Find the steps that the median of the velocities around them does not explain.

    A step counts that deviates from it by more than the other steps around do, more than a fall
    explains, and more than a change of speed between two poses may be.
    """
    step = np.diff(base.position, axis=0)
    in_gap = np.isin(base.time[:-1], base.gaps[:, 0])
    candidates = np.flatnonzero((norms(step) > SMALLEST_JUMP_M) & ~in_gap)
    parts = [
        _unexplained(base.time, step, in_gap, candidates[first : first + _CHUNK])
        for first in range(0, len(candidates), _CHUNK)
    ]
    size = np.concatenate(parts) if parts else np.empty((0, 3))
    jumps = np.isfinite(size[:, 0])
    rows = candidates[jumps]
    spans = np.stack([base.time[rows], base.time[rows + 1]], axis=1)
    return PoseJumps(spans, size[jumps], _turns(np.diff(base.angles[:, 2]), rows))


def _turns(turn: Floats, rows: Ints) -> Floats:
    """(j,) rad, the turns of some steps less the usual one of those around, where that is much."""
    around = np.clip(rows[:, None] + _AROUND, 0, max(len(turn) - 1, 0))
    unexplained: Floats = turn[rows] - median_of(turn[around], axis=1) if len(rows) else turn[:0]
    return np.where(np.abs(unexplained) > SMALLEST_TURN_RAD, unexplained, 0.0)


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
    """Return the poses with the jumps taken out: the motion that the base made itself."""
    if len(jumps.spans) == 0:
        return base
    passed = np.searchsorted(jumps.spans[:, 1], base.time, side="right")
    moved = np.concatenate([np.zeros((1, 3)), np.cumsum(jumps.size_m, axis=0)])
    return replace(base, position=base.position - moved[passed])
