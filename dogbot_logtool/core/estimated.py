"""Contact and force of feet without sensors, from the motion and the torques of their legs.

A foot that stands rests on the ground, so that the base moves by ``-(v + w x p)``, with p the foot
and v its velocity in the base's axes, and w the base's turn rate. The feet that agree on that, and
are low, stand. Motors of a leg carry its own links and push the ground:
``tau = sum(m Jc^T (c'' + s)) - J^T f``, with m the links' masses at c, s what an accelerometer on
the base reads, and f the ground's force on the foot (Featherstone 2008); solved for f.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import (
    Flags,
    Floats,
    Ints,
    median_of,
    median_of_known,
    percentiles_of,
)
from dogbot_logtool.core.frames.kinematics import LegMotion

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
LOADED: Final = 0.4
"""Share of the weight a foot, were it spread evenly, from which a foot is loaded."""
UNLOADED: Final = 0.2
"""The same, below which it is not any more."""
BOUNCE: Final = 0.35
"""Share of the usual time without rest below which a foot without load bounces, or less than
`LONGEST_BOUNCE_S`."""
LONGEST_BOUNCE_S: Final = 0.08
RESTED: Final = 0.2
"""Share of a foot's time under load in which it rests, at least."""
FORCE_ONLY: Final = 1e-6
"""How little forces are damped in a least-squares fit, and how much `MOMENT` moments at a foot."""
MOMENT: Final = 1e-2
CARRY: Final = (0.75, 1.33)
"""Mean vertical force of all feet over the weight within which efforts are torques in N m."""
WRONG_SIGN: Final = "efforts have the wrong sign"
TOO_MUCH: Final = "by the efforts, feet carry"


@dataclass(frozen=True, slots=True)
class Ground:
    """What the feet tell of the ground below."""

    implied: Floats
    """(n, f, 3) m/s, how the base moves along its axes if each foot rests on the ground."""
    resting: Flags
    """(n, f) whether each foot rests there."""
    agreeing: Flags
    """(n, f) whether each is slow against what all of them agree on."""
    fast: Flags
    """(n, f) whether each is so fast that it swings, whatever its leg's torques say."""

    def velocity(self, standing: Flags) -> Floats:
        """(n, 3) m/s, of the base by the median over standing feet; NaN where none stands.

        Just after a touchdown and before a lift-off a foot does not rest.

        Args:
            standing: (n, f) which feet are in contact.
        """
        inner = np.stack([_middles(column) for column in standing.T], axis=1) & self.agreeing
        found = np.full((len(standing), 3), np.nan)
        some = inner.any(axis=1)
        known = np.where(inner[some][:, :, None], self.implied[some], np.nan)
        found[some] = median_of_known(known, axis=1)
        return found


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
    lift = _lift(seconds, np.einsum("nfi,ni->nf", feet, up))
    # When all rise together, it is the base that sinks.
    lift -= lift.min(axis=1, keepdims=True)
    usual = np.maximum(percentiles_of(lift, (95.0,), axis=0)[0], LEAST_LIFT_M)
    low = lift < np.maximum(LOW * usual, LEAST_LIFT_M)
    resting, top = low, 0.0
    for _ in range(4):
        base = _common(seconds, implied, resting)
        speed = np.linalg.norm(implied - base[:, None], axis=2)
        top = float(percentiles_of(speed, 95.0))
        limit = float(np.clip(SLOW * top, *SLOWEST_MPS))
        close = lift < np.maximum(LOW_AND_SLOW * usual, 2.0 * LEAST_LIFT_M)
        resting = _held(close & (speed < limit), ~close | (speed > LOOSELY * limit))
    return Ground(implied, resting, speed < AGREE * limit, speed > max(FAST * top, LOOSELY * limit))


def _lift(seconds: Floats, height: Floats) -> Floats:
    """(n, f) m, how high feet are above where each is lowest in the seconds around."""
    block = ((seconds - seconds[0]) / GROUND_S).astype(np.int64)
    _, first = np.unique(block, return_index=True)
    edges = [*first.tolist(), len(seconds)]
    middles, lowest = [], []
    for row in range(len(first)):
        begin, end = edges[max(row - 1, 0)], edges[min(row + 2, len(first))]
        middles.append((seconds[edges[row]] + seconds[edges[row + 1] - 1]) / 2.0)
        lowest.append(percentiles_of(height[begin:end], (10.0,), axis=0)[0])
    ground = np.array(lowest)
    return np.stack(
        [
            column - np.interp(seconds, middles, ground[:, foot])
            for foot, column in enumerate(height.T)
        ],
        axis=1,
    )


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


def ground_forces(
    seconds: Floats,
    legs: Sequence[LegMotion],
    points: Floats,
    efforts: Sequence[Floats],
    felt: Floats,
) -> Floats:
    """Return the ground's force on each foot by the torques of its leg.

    Args:
        seconds: (n,) s.
        legs: of each foot.
        points: (n, f, 3) m, where feet touch the ground, along the base's axes.
        efforts: (n, k) N m or N of each leg's joints.
        felt: (n, 3) m/s^2, what an accelerometer on the base reads: gravity, upwards.

    Returns:
        (n, f, 3) N along the base's axes.
    """
    forces = [
        _force(seconds, leg, points[:, foot], efforts[foot], felt) for foot, leg in enumerate(legs)
    ]
    return np.stack(forces, axis=1)


def _force(seconds: Floats, leg: LegMotion, point: Floats, effort: Floats, felt: Floats) -> Floats:
    """(n, 3) N, the force on a foot; moments too where joints tell, which are damped."""
    carried = np.zeros_like(effort)
    for number, mass in enumerate(leg.leg.masses):
        centre = leg.centres[:, number]
        moved, _ = leg.jacobian(centre, mass.joint + 1)
        pull = mass.mass_kg * (slopes(seconds, slopes(seconds, centre)) + felt)
        carried += np.einsum("nik,ni->nk", moved, pull)
    moved, turned = leg.jacobian(point)
    both = np.concatenate([moved, turned], axis=1)
    damped = np.diag([FORCE_ONLY] * 3 + [MOMENT] * 3)
    square = both @ both.transpose(0, 2, 1) + damped
    asked = np.einsum("nik,nk->ni", both, carried - effort)
    return np.asarray(np.linalg.solve(square, asked[:, :, None])[:, :3, 0])


def loaded_feet(seconds: Floats, vertical: Floats, weight_n: float, ground: Ground) -> Flags:
    """(n, f) which feet carry a load, and rest meanwhile, but for touchdown and lift-off.

    Args:
        seconds: (n,) s.
        vertical: (n, f) N, of the ground on each foot.
        weight_n: N, of the robot.
        ground: what the motion of the feet tells.
    """
    share = weight_n / vertical.shape[1]
    on, off = vertical >= LOADED * share, vertical < UNLOADED * share
    loaded = _held(on & ~ground.fast, off | ground.fast)
    for foot in range(vertical.shape[1]):
        resting = ground.resting[:, foot]
        # A foot that bounces at touchdown, while it is there already.
        begin, end = _runs(~loaded[:, foot])
        swings = _runs(~resting)
        usual = (
            float(median_of(seconds[swings[1] - 1] - seconds[swings[0]])) if len(swings[0]) else 0.0
        )
        short = seconds[end - 1] - seconds[begin] < min(BOUNCE * usual, LONGEST_BOUNCE_S)
        for first, behind in zip(begin[short].tolist(), end[short].tolist(), strict=True):
            loaded[first:behind, foot] = True
        rested = np.concatenate([[0], np.cumsum(resting)])
        for first, behind in zip(*(each.tolist() for each in _runs(loaded[:, foot])), strict=True):
            if rested[behind] - rested[first] < RESTED * (behind - first):
                loaded[first:behind, foot] = False
    return loaded


def _runs(flags: Flags) -> tuple[Ints, Ints]:
    """Return the first row of each run of true flags, and the row behind it."""
    change = np.diff(flags.astype(np.int8), prepend=0, append=0)
    return np.flatnonzero(change > 0), np.flatnonzero(change < 0)


def _middles(standing: Flags) -> Flags:
    """(n,) the rows of contacts that are away from their ends."""
    begin, end = _runs(standing)
    edge = np.ceil(EDGE * (end - begin)).astype(np.int64)
    inside = np.zeros(len(standing) + 1, np.int64)
    some = end - begin > 2 * edge
    np.add.at(inside, (begin + edge)[some], 1)
    np.add.at(inside, (end - edge)[some], -1)
    return np.asarray(np.cumsum(inside[:-1]) > 0)


def _held(on: Flags, off: Flags) -> Flags:
    """(n, f) states that last from on to off; at first off."""
    row = np.arange(len(on))[:, None]
    last = np.maximum.accumulate(np.where(on | off, row, -1), axis=0)
    state = np.take_along_axis(on, np.maximum(last, 0), axis=0)
    return np.asarray(state & (last >= 0))


def effort_fault(vertical: Floats, weight_n: float | None) -> str:
    """Say why efforts are no torques in N m; empty if they are.

    Args:
        vertical: (n, f) N, forces that follow from them.
        weight_n: N, of the robot; None: not known.
    """
    if weight_n is None:
        return "the mass is not known, so that efforts cannot be checked against the weight"
    ratio = float(vertical.sum(axis=1).mean()) / weight_n
    if CARRY[0] <= ratio <= CARRY[1]:
        return ""
    if -CARRY[1] <= ratio <= -CARRY[0]:
        return f"{WRONG_SIGN}: by them, the feet pull at the ground"
    return f"{TOO_MUCH} {ratio:.3g} times the weight: they are no torques in N m"
