"""What the joints of legs tell of their feet: which rest on the ground, and with which force.

A foot that stands rests on the ground, so that the base moves by ``-(v + w x p)``, with p the foot
and v its velocity in the base's axes, and w the base's turn rate. The feet that agree on that, and
are low, stand.

Motors of a leg carry its own links and push the ground: ``tau = sum(m Jc^T (c'' + s)) - J^T f``,
with m the links' masses at c, s what an accelerometer on the base reads, and f the ground's force
on the foot (Featherstone 2008); solved for f.
"""

from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np

from dogbot_logtool.core.arrays import (
    Flags,
    Floats,
    Ints,
    all_finite,
    flagged_runs,
    latched,
    median_of,
    median_of_known,
    percentiles_of,
    picked,
)
from dogbot_logtool.core.base.leg_odometry import (
    Inertial,
    LegOdometry,
    leg_odometry,
)
from dogbot_logtool.core.clock import TimeSource, first_at_each_tick, rows_in_time
from dogbot_logtool.core.frames.kinematics import Leg, LegMotion
from dogbot_logtool.core.recording import JointTable
from dogbot_logtool.core.timespans import covers

RATE_HZ: Final = 200.0
"""At which legs are looked at, at most."""
FEWEST: Final = 20
"""Joint states at least."""


def joints_of_legs(tables: Sequence[JointTable], names: Sequence[str]) -> JointTable:
    """Return the joints of the topic that tells of most of them.

    Args:
        tables: joint states, at least one, the best topic first.
        names: of the joints.

    Raises:
        ValueError: a sentence: not all of them are told, or too rarely.
    """
    table = max(tables, key=lambda each: len(set(names).intersection(each.names)))
    if lacking := [name for name in names if name not in table.names]:
        text = f"joint states of {table.topic} do not tell of {', '.join(lacking)}"
        raise ValueError(f"{text}, which the robot description has")
    samples = table.of(names)
    rows = rows_in_time(samples, TimeSource.HEADER, all_finite(samples.position))
    rows = rows[first_at_each_tick(samples.stamp[rows], RATE_HZ)]
    if len(rows) < FEWEST:
        raise ValueError("too few joint states tell the positions of all joints of the legs")
    return JointTable(table.topic, tuple(names), picked(samples, rows))


MOVES_RAD: Final = 0.05
"""rad, or m: a joint that goes further moves."""


def stuck_joint(joints: JointTable, legs: Sequence[Leg]) -> str:
    """Say which joint tells one position while the other legs' joints of its place move.

    Args:
        joints: of all legs.
        legs: of the robot.

    Returns:
        a sentence; empty: there is none.
    """
    for alike in zip(*(leg.measured for leg in legs), strict=False):
        moved = np.ptp(joints.of(alike).position, axis=0)
        if moved.min() == 0.0 and median_of(moved) > MOVES_RAD:
            return f"{alike[moved.argmin()]} tells one position while other legs move"
    return ""


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
LONGEST_EDGE_NS: Final = 200_000_000
"""ns, but no longer: a foot of a robot that stands rests from then on."""


class FeetOnGround(NamedTuple):
    """Which feet rest on the ground, by how they and the base move."""

    joints: JointTable
    legs: Sequence[LegMotion]
    """How each moves with them."""
    inertial: Inertial
    """How the base leans and turns."""
    points: Floats
    """(n, f, 3) m, where feet may touch the ground, along the base's axes; also `velocity`, m/s, of
    the matter there."""
    velocity: Floats
    resting: Flags
    """(n, f) whether each foot rests; also `agreeing`, whether each is slow against what all of
    them agree on, and `fast`, so fast that it swings, whatever its leg's torques say."""
    agreeing: Flags
    fast: Flags

    def upwards(self, vectors: Floats) -> Floats:
        """(n, f) the parts of vectors, (n, f, 3), against gravity."""
        return np.asarray(np.einsum("nfi,ni->nf", vectors, self.inertial.up))

    def turn_by(self, standing: Flags) -> Floats:
        """(n - 1, 3) rad/s, by feet that stand, about z only; NaN where they do not tell."""
        return leg_odometry(self.joints.samples.stamp, self.points, standing).turn_rate

    def low(self) -> Flags:
        """(n, f) which feet are so low that they may stand, however the base turns."""
        lift, usual = _lift(self)
        return np.asarray(lift < np.maximum(LOW * usual, LEAST_LIFT_M))

    def odometry(self, standing: Flags) -> LegOdometry:
        """Return how the base moves by those of standing feet that agree."""
        sure = standing & self.agreeing
        turn = self.inertial.turn
        return leg_odometry(self.joints.samples.stamp, self.points, sure, turn, self.velocity)


def slopes(seconds: Floats, values: Floats) -> Floats:
    """Return time derivatives, by differences over `SLOPE_S`.

    Args:
        seconds: (n,) s.
        values: (n, ...), of any unit.

    Returns:
        (n, ...).
    """
    step = max(float(median_of(np.diff(seconds))), 1e-6)
    reach = max(1, round(SLOPE_S / 2.0 / step))
    row = np.arange(len(seconds))
    before, after = np.maximum(row - reach, 0), np.minimum(row + reach, len(row) - 1)
    apart = (seconds[after] - seconds[before]).reshape(-1, *(1,) * (values.ndim - 1))
    return np.asarray((values[after] - values[before]) / apart)


def resting_feet(joints: JointTable, legs: Sequence[LegMotion], inertial: Inertial) -> FeetOnGround:
    """Tell which feet rest on the ground: those that are low, and agree on the base's velocity.

    Args:
        joints: of all legs.
        legs: motion of each.
        inertial: how the base leans and turns.
    """
    points, moved = [], []
    for each in legs:
        points.append(each.foot - each.leg.radius_m * inertial.up)
        jacobian, _ = each.jacobian(points[-1])
        rates = slopes(joints.seconds, joints.of(each.leg.measured).position)
        moved.append(np.einsum("nik,nk->ni", jacobian, rates))
    none = np.zeros((len(joints.seconds), len(legs)), np.bool_)
    places, velocity = np.stack(points, axis=1), np.stack(moved, axis=1)
    feet = FeetOnGround(joints, legs, inertial, places, velocity, none, none, none)
    return at_rest(feet, feet.low())


def at_rest(feet: FeetOnGround, resting: Flags) -> FeetOnGround:
    """Tell anew which feet rest, by (n, f) those that may."""
    seconds = feet.joints.seconds
    implied = -(feet.velocity + np.cross(feet.inertial.turn[:, None], feet.points))
    lift, usual = _lift(feet)
    close, top = lift < np.maximum(LOW_AND_SLOW * usual, 2.0 * LEAST_LIFT_M), 0.0
    for _ in range(4):
        base = _common(seconds, implied, resting)
        speed = np.linalg.norm(implied - base[:, None], axis=2)
        top = float(percentiles_of(speed, 95.0))
        limit = float(np.clip(SLOW * top, *SLOWEST_MPS))
        resting = latched(close & (speed < limit), ~close | (speed > LOOSELY * limit))
    fast = speed > max(FAST * top, LOOSELY * limit)
    return feet._replace(resting=resting, agreeing=speed < AGREE * limit, fast=fast)


def _lift(feet: FeetOnGround) -> tuple[Floats, Floats]:
    """Return how high feet are above where each is lowest in the seconds around, and usually lift.

    Returns:
        (n, f) m, less that of the lowest foot: when all rise together, it is the base that sinks;
        and (f,) m.
    """
    seconds, height = feet.joints.seconds, feet.upwards(feet.points)
    lift = height.copy()
    for start in np.unique(seconds // GROUND_S * GROUND_S):
        before, begin, end, after = np.searchsorted(seconds, start + GROUND_S * np.arange(-1, 3))
        lift[begin:end] -= percentiles_of(height[before:after], (10.0,), axis=0)[0]
    lift -= lift.min(axis=1, keepdims=True)
    return lift, np.maximum(percentiles_of(lift, (95.0,), axis=0)[0], LEAST_LIFT_M)


def _common(seconds: Floats, implied: Floats, resting: Flags) -> Floats:
    """(n, 3) m/s, the median velocity that resting feet imply, smoothed over time."""
    some = np.flatnonzero(resting.any(axis=1))
    known = np.where(resting[some][:, :, None], implied[some], np.nan)
    total = np.concatenate([np.zeros((1, 3)), np.cumsum(median_of_known(known, axis=1), axis=0)])
    begin = np.searchsorted(seconds[some], seconds - AROUND_S)
    end = np.searchsorted(seconds[some], seconds + AROUND_S, side="right")
    begin = np.minimum(begin, len(some) - 1)
    end = np.maximum(end, begin + 1)
    return np.asarray((total[end] - total[begin]) / (end - begin)[:, None])


def settled(time: Ints, standing: Flags) -> Flags:
    """(n, f) which of the feet in contact are so not just after touchdown or before lift-off."""
    inner = np.zeros_like(standing)
    for foot, column in enumerate(standing.T):
        spans = time[flagged_runs(column) - [0, 1]]
        edge = np.minimum(EDGE * np.diff(spans), LONGEST_EDGE_NS).astype(np.int64)
        inner[:, foot] = covers(spans + edge * [1, -1], time)
    return inner


LOADED: Final = 0.4
"""Share of the weight a foot, were it spread evenly, from which a foot is loaded."""
UNLOADED: Final = 0.2
"""The same, below which it is not any more."""
BOUNCE: Final = 0.35
"""Share of the usual time without rest below which a foot without load bounces, or less than
`LONGEST_BOUNCE_S`."""
LONGEST_BOUNCE_S: Final = 0.08
FORCE_ONLY: Final = 1e-6
"""How little forces are damped in a least-squares fit, and how much `MOMENT` moments at a foot."""
MOMENT: Final = 1e-2
CARRY: Final = (0.75, 1.33)
"""Mean vertical force of all feet over the weight within which efforts are torques in N m."""
TOO_MUCH: Final = "by the efforts, feet carry"


def ground_forces(feet: FeetOnGround) -> Floats:
    """(n, f, 3) N along the base's axes, the ground's force on each foot by its leg's torques."""
    return np.stack([_force(feet, *each) for each in enumerate(feet.legs)], axis=1)


def _force(feet: FeetOnGround, foot: int, leg: LegMotion) -> Floats:
    """(n, 3) N, the force on a foot; moments too where joints tell, which are damped."""
    seconds, felt, point = feet.joints.seconds, feet.inertial.felt, feet.points[:, foot]
    effort = feet.joints.of(leg.leg.measured).effort
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


def loaded_feet(vertical: Floats, weight_n: float, ground: FeetOnGround) -> Flags:
    """(n, f) which feet carry a load, and do not swing.

    Args:
        vertical: (n, f) N, of the ground on each foot.
        weight_n: N, of the robot.
        ground: what the motion of the feet tells.
    """
    share = weight_n / vertical.shape[1]
    on, off = vertical >= LOADED * share, vertical < UNLOADED * share
    return latched(on & ~ground.fast, off | ground.fast)


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
    what = "have the wrong sign" if ratio < 0.0 else "are no torques in N m"
    return f"{TOO_MUCH} {ratio:.3g} times the weight: they {what}"
