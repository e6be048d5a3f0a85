"""Running totals of forces and accelerations, so that means over any time can be asked for."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Floats, Ints, added_within, all_finite, distinct
from dogbot_logtool.core.base.poses import BaseHistory
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.contact.stance_curves import PARTS
from dogbot_logtool.core.load.loads import GRAVITY_MPS2
from dogbot_logtool.core.rotations import conjugate, from_roll_pitch_yaw, rotate
from dogbot_logtool.core.vectors import VectorHistory
from dogbot_logtool.dataclass import dataclass

SPARSE_NS: Final = 1_000_000_000
"""ns; readings further apart than this tell no acceleration."""


@dataclass(frozen=True, slots=True)
class Running:
    """Integrals of some columns over time."""

    origin: int
    """ns."""
    time: Floats
    """(n,) ns since the origin, increasing."""
    total: Floats
    """(n, k) unit times s."""
    known: Ints
    """(s, 2) ns, the time in which they mean something."""

    def mean(self, time: Ints, half_ns: int) -> Floats:
        """(m, k) means over a window about each time."""
        since = (time - self.origin).astype(np.float64)
        return added_within(self.total, self.time, since, half_ns) / (2e-9 * half_ns)


def running_accelerations(
    sensed: VectorHistory, base: BaseHistory, mounting: Sequence[float] | None
) -> Running | None:
    """Add up what an accelerometer reads, turned by the base's attitude.

    Args:
        sensed: m/s^2 in the sensor's frame.
        base: poses without jumps.
        mounting: x, y, z, w: the sensor's frame in the base's; None: it is the base's.

    Returns:
        Nine columns, m/s: the specific force in the world and in the base's frame, and the reaction
        to gravity in the base's frame. None with fewer than two readings at a known attitude.
    """
    attitude = base.angles_at(sensed.time)
    rows = np.flatnonzero(all_finite(attitude))
    if len(rows) < 2:
        return None
    time, body = sensed.time[rows], sensed.vector[rows]
    if mounting is not None:
        body = rotate(np.array([mounting]), body)
    turn = from_roll_pitch_yaw(attitude[rows])
    up = np.broadcast_to([0.0, 0.0, GRAVITY_MPS2], body.shape)
    values = np.concatenate([rotate(turn, body), body, rotate(conjugate(turn), up)], axis=1)
    step = np.diff(time)
    parts = (values[1:] + values[:-1]) / 2.0 * (step / 1e9)[:, None]
    silent = np.flatnonzero(step > min(sensed.gap_ns, SPARSE_NS))
    gaps = np.stack([time[silent], time[silent + 1]], axis=1)
    known = timespans.subtract(time[[0, -1]][None, :], gaps)
    return Running(
        origin=int(time[0]),
        time=(time - time[0]).astype(np.float64),
        total=np.concatenate([np.zeros((1, 9)), np.cumsum(parts, axis=0)]),
        known=timespans.intersect([known, base.known]),
    )


def horizontal_impulses(feet: Sequence[FootHistory]) -> Running | None:
    """Add up the horizontal forces of all feet, from the parts of their stances.

    Returns:
        Two columns, N s along the world's x and y; None where there is no stance.
    """
    starts = [foot.stances.touchdown for foot in feet]
    origin = min((int(each[0]) for each in starts if len(each)), default=None)
    if origin is None:
        return None
    known = timespans.intersect([foot.known for foot in feet])
    curves = []
    for foot in feet:
        stances, forces = foot.stances, foot.stance_forces
        told = np.isfinite(forces[:, :2]).all(axis=(1, 2))
        spans = np.stack([stances.touchdown, stances.liftoff], axis=1)
        known = timespans.subtract(known, timespans.merge(spans[~told]))
        curves.append(_of_stances(spans[told] - origin, forces[told, :2]))
    time = distinct(np.concatenate([knots for knots, _ in curves]))
    total = np.zeros((len(time), 2))
    for knots, sums in curves:
        for axis in range(2):
            total[:, axis] += np.interp(time, knots, sums[:, axis])
    return Running(origin, time, total, known)


def _of_stances(spans: Ints, forces: Floats) -> tuple[Floats, Floats]:
    """Return the edges of all parts of stances, (p,) ns, and the impulse up to each, (p, 2) N s.

    Args:
        spans: (k, 2) ns.
        forces: (k, 2, PARTS) N, mean in each part.
    """
    if len(spans) == 0:
        return np.zeros(1), np.zeros((1, 2))
    length = (spans[:, 1] - spans[:, 0])[:, None]
    knots = spans[:, :1] + length * np.linspace(0.0, 1.0, PARTS + 1)
    each = np.zeros((len(spans), PARTS + 1, 2))
    each[:, 1:] = forces.transpose(0, 2, 1) * (length / (PARTS * 1e9))[:, :, None]
    return knots.ravel(), np.cumsum(each.reshape(-1, 2), axis=0)
