"""Which feet rest on the ground, by the motion of the legs.

A foot that stands rests on the ground, so that the base moves by ``-(v + w x p)``, with p the foot
and v its velocity in the base's axes, and w the base's turn rate. The feet that agree on that, and
are low, stand.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import (
    Flags,
    Floats,
    flagged_runs,
    latched,
    median_of,
    median_of_known,
    percentiles_of,
)
from dogbot_logtool.core.timespans import covers

SLOPE_S: Final = 0.02
"""s over which velocities are differences of positions."""
GROUND_S: Final = 1.0
"""s, a third of the time around a moment in which the lowest places of a foot are the ground."""
LOW: Final = 0.25
"""Share of a foot's usual lift below which it may stand; at first, and `LOW_AND_SLOW` later."""
LOW_AND_SLOW: Final = 0.6
LEAST_LIFT_M: Final = 0.004
"""m: noise may lift a standing foot as far."""
SLOW: Final = 0.12
"""Share of the usual speed of a swing below which a foot rests."""
FAST: Final = 0.5
"""Share of that speed beyond which no foot is in contact."""
SLOWEST_MPS: Final = (0.04, 0.3)
"""m/s, bounds of that speed."""
AGREE: Final = 0.5
"""Share of the speed of rest below which a foot tells how the base moves."""
LOOSELY: Final = 3.0
"""Times that speed by which a foot that rested leaves the ground."""
AROUND_S: Final = 0.03
"""s before and after, over which the velocity of the base is the median."""
EDGE: Final = 0.2
"""Share of a contact at either end in which the foot may not rest yet, or any more."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Ground:
    """What the feet tell of the ground below."""

    resting: Flags
    """(n, f) whether each foot rests on it."""
    agreeing: Flags
    """(n, f) whether each is slow against what all of them agree on."""
    fast: Flags
    """(n, f) whether each is so fast that it swings, whatever its leg's torques say."""

    def surely(self, standing: Flags) -> Flags:
        """(n, f) which feet surely rest, of those in contact.

        Just after a touchdown and before a lift-off a foot does not.
        """
        return np.stack([_middles(column) for column in standing.T], axis=1) & self.agreeing


def slopes(seconds: Floats, values: Floats) -> Floats:
    """Return time derivatives, by differences over `SLOPE_S`.

    Args:
        seconds: (n,) s.
        values: (n, ...), of any unit.

    Returns:
        (n, ...); of less than two values zeros.
    """
    if len(seconds) < 2:
        return np.zeros_like(values)
    step = max(float(median_of(np.diff(seconds))), 1e-6)
    reach = max(1, round(SLOPE_S / 2.0 / step))
    row = np.arange(len(seconds))
    before, after = np.maximum(row - reach, 0), np.minimum(row + reach, len(row) - 1)
    apart = (seconds[after] - seconds[before]).reshape(-1, *(1,) * (values.ndim - 1))
    return np.asarray((values[after] - values[before]) / apart)


def resting_feet(
    seconds: Floats, feet: Floats, velocity: Floats, turn: Floats, up: Floats
) -> Ground:
    """Tell which feet rest on the ground: those that are low, and agree on the base's velocity.

    Args:
        seconds: (n,) s.
        feet: (n, f, 3) m, where they may touch the ground, along the base's axes.
        velocity: (n, f, 3) m/s, of the matter there.
        turn: (n, 3) rad/s, of the base.
        up: (n, 3) unit vectors, against gravity, along the base's axes.
    """
    implied = -(velocity + np.cross(turn[:, None], feet))
    lift, usual = _lift(seconds, feet, up)
    resting, top = low_feet(seconds, feet, up), 0.0
    for _ in range(4):
        base = _common(seconds, implied, resting)
        speed = np.linalg.norm(implied - base[:, None], axis=2)
        top = float(percentiles_of(speed, 95.0))
        limit = float(np.clip(SLOW * top, *SLOWEST_MPS))
        close = lift < np.maximum(LOW_AND_SLOW * usual, 2.0 * LEAST_LIFT_M)
        resting = latched(close & (speed < limit), ~close | (speed > LOOSELY * limit))
    return Ground(resting, speed < AGREE * limit, speed > max(FAST * top, LOOSELY * limit))


def low_feet(seconds: Floats, feet: Floats, up: Floats) -> Flags:
    """(n, f) which feet are so low that they may stand; see `resting_feet`."""
    lift, usual = _lift(seconds, feet, up)
    return np.asarray(lift < np.maximum(LOW * usual, LEAST_LIFT_M))


def _lift(seconds: Floats, feet: Floats, up: Floats) -> tuple[Floats, Floats]:
    """Return how high feet are above where each is lowest in the seconds around, and usually lift.

    Returns:
        (n, f) m, less that of the lowest foot: when all rise together, it is the base that sinks;
        and (f,) m.
    """
    height = np.einsum("nfi,ni->nf", feet, up)
    block = ((seconds - seconds[0]) / GROUND_S).astype(np.int64)
    _, first = np.unique(block, return_index=True)
    edges = np.array([*first.tolist(), len(seconds)])
    middles = (seconds[edges[:-1]] + seconds[edges[1:] - 1]) / 2.0
    around = zip([0, *edges[:-2]], [*edges[2:], edges[-1]], strict=True)
    lowest = [percentiles_of(height[begin:end], (10.0,), axis=0)[0] for begin, end in around]
    ground = [np.interp(seconds, middles, column) for column in np.array(lowest).T]
    lift = height - np.stack(ground, axis=1)
    lift -= lift.min(axis=1, keepdims=True)
    return lift, np.maximum(percentiles_of(lift, (95.0,), axis=0)[0], LEAST_LIFT_M)


def _common(seconds: Floats, implied: Floats, resting: Flags) -> Floats:
    """(n, 3) m/s, the median velocity that resting feet imply, smoothed over time."""
    some = np.flatnonzero(resting.any(axis=1))
    if not len(some):
        return np.zeros((len(seconds), 3))
    known = np.where(resting[some][:, :, None], implied[some], np.nan)
    found = median_of_known(known, axis=1)
    total = np.concatenate([np.zeros((1, 3)), np.cumsum(found, axis=0)])
    begin = np.searchsorted(seconds[some], seconds - AROUND_S)
    end = np.searchsorted(seconds[some], seconds + AROUND_S, side="right")
    begin = np.minimum(begin, len(some) - 1)
    end = np.maximum(end, begin + 1)
    return np.asarray((total[end] - total[begin]) / (end - begin)[:, None])


def _middles(standing: Flags) -> Flags:
    """(n,) the rows of contacts that are away from their ends."""
    runs = flagged_runs(standing)
    edge = np.ceil(EDGE * (runs[:, 1] - runs[:, 0])).astype(np.int64)
    inner = runs + edge[:, None] * [1, -1]
    return covers(inner[inner[:, 0] < inner[:, 1]], np.arange(len(standing)))
