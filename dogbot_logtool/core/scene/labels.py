"""Labels beside the feet: their loads in newtons."""

from dataclasses import dataclass
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Flags, Floats, Ints, all_finite, norms
from dogbot_logtool.core.corrections.clock import first_at_each_tick
from dogbot_logtool.core.scene.feet import DrawnFoot

RATE_HZ: Final = 20.0
"""Labels a second: numbers that change faster cannot be read."""
_BELOW_M: Final = 0.1
"""m from the contact point down to the label, so that neither leg nor arrow hides it."""


@dataclass(frozen=True, slots=True)
class Labels:
    """Labels to draw or to remove, one row a written message."""

    foot: Ints
    """(n,) index of the foot among the robot's feet."""
    log_time: Ints
    """(n,) ns."""
    stamp: Ints
    """(n,) ns."""
    shown: Flags
    """(n,) whether to draw it; else the foot's label is removed."""
    position: Floats
    """(n, 3) m, world frame."""
    force: Floats
    """(n,) N, magnitude."""


def foot_labels(foot: DrawnFoot, rows: slice) -> Labels:
    """Return labels of a foot's samples, at most `RATE_HZ`.

    A label is removed at once when its foot leaves the ground.

    Args:
        foot: the foot.
        rows: of its samples; the one before them tells whether a tick or a swing begins.
    """
    first = max(rows.start - 1, 0)
    touching = foot.touching[first : rows.stop]
    chosen = first_at_each_tick(foot.samples.log_time[first : rows.stop], RATE_HZ)
    chosen[1:] |= touching[:-1] & ~touching[1:]
    row = first + np.flatnonzero(chosen)
    row = row[row >= rows.start]
    samples = foot.samples.pick(row)
    force = norms(samples.force.astype(np.float64))
    shown = foot.touching[row] & (samples.points > 0) & (force > 0.0)
    shown &= np.isfinite(force) & all_finite(samples.position)
    position = samples.position - np.array([0.0, 0.0, _BELOW_M])
    number = np.full(len(row), foot.number)
    return Labels(number, samples.log_time, samples.time, shown, position, force)
