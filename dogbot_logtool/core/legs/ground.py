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
from dogbot_logtool.core.corrections.clock import (
    TimeSource,
    advancing,
    check_stamps,
    first_at_each_tick,
)
from dogbot_logtool.core.frames.kinematics import Leg, LegMotion
from dogbot_logtool.core.recording import JointTable
from dogbot_logtool.core.timespans import covers

RATE_HZ: Final = 200.0
"""At which legs are looked at, at most."""
SLOWEST_S: Final = 0.04
"""s between two joint states, beyond which they tell no contact."""
FEWEST: Final = 20
"""Joint states at least."""


class LegJoints(NamedTuple):
    """The k joints of all legs at n times."""

    names: tuple[str, ...]
    topic: str
    """The topic that tells of most of them."""
    clock: TimeSource
    log_time: Ints
    """(n,) ns; also `stamp`."""
    stamp: Ints
    time: Ints
    """(n,) ns on `clock`, strictly increasing."""
    position: Floats
    """(n, k) rad or m."""
    effort: Floats
    """(n, k) N m or N; NaN: not told."""

    @property
    def seconds(self) -> Floats:
        """(n,) s since the first."""
        return np.asarray((self.time - self.time[0]) / 1e9)

    def columns(self, names: Sequence[str]) -> list[int]:
        """Return the columns of some joints."""
        return [self.names.index(name) for name in names]


def joints_of_legs(tables: Sequence[JointTable], names: Sequence[str]) -> LegJoints:
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
    samples = table.samples.only(np.array([table.names.index(name) for name in names]))
    check = check_stamps(table.topic, samples.stamp, samples.log_time)
    usable, clock = all_finite(samples.position), TimeSource.LOG
    if check.mostly_usable:
        usable, clock = usable & check.usable, TimeSource.HEADER
    rows, time = np.flatnonzero(usable), clock.of(samples)
    rows = rows[advancing(time[rows])]
    rows = rows[first_at_each_tick(time[rows], RATE_HZ)]
    if len(rows) < FEWEST:
        raise ValueError("too few joint states tell the positions of all joints of the legs")
    interval_s = float(median_of(np.diff(time[rows]))) / 1e9
    if interval_s > SLOWEST_S:
        raise ValueError(f"joint states come {1.0 / interval_s:.3g} times a second, too rarely")
    kept = picked(samples, rows)
    times = kept.log_time, kept.stamp, time[rows]
    return LegJoints(tuple(names), table.topic, clock, *times, kept.position, kept.effort)


BLOCK_S: Final = 0.5
"""s, spans in which joints are looked at whether they move."""
STUCK: Final = 4
"""Spans in which a joint that tells one position is stuck, at least."""
MOVES_RAD: Final = 0.05
"""rad, or m: a joint that goes further in such a span moves."""


def stuck_joint(joints: LegJoints, legs: Sequence[Leg]) -> str:
    """Say which joint tells one position for long while the other legs' joints of its place move.

    Args:
        joints: of all legs.
        legs: of the robot.

    Returns:
        a sentence; empty: all move, or none, or legs have different joints.
    """
    columns = [joints.columns(leg.measured) for leg in legs]
    if len({len(each) for each in columns}) > 1:
        return ""
    _, first = np.unique((joints.seconds / BLOCK_S).astype(np.int64), return_index=True)
    highest, lowest = (
        extreme.reduceat(joints.position, first, axis=0) for extreme in (np.maximum, np.minimum)
    )
    ways = (highest - lowest)[:, columns]
    others_move = median_of(ways, axis=1)[:, None] > MOVES_RAD
    stuck = ((ways == 0.0) & others_move).sum(axis=0)
    if stuck.max(initial=0) < STUCK:
        return ""
    leg, column = np.unravel_index(stuck.argmax(), stuck.shape)
    seconds, name = stuck.max() * BLOCK_S, legs[leg].measured[column]
    return f"{name} tells one position for {seconds:.3g} s while other legs move"


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


class Ground(NamedTuple):
    """What the feet tell of the ground below."""

    resting: Flags
    """(n, f) whether each foot rests on it."""
    agreeing: Flags
    """(n, f) whether each is slow against what all of them agree on."""
    fast: Flags
    """(n, f) whether each is so fast that it swings, whatever its leg's torques say."""


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


def middles(standing: Flags) -> Flags:
    """(n, f) which of the feet in contact are so not just after touchdown or before lift-off."""
    inner = np.zeros_like(standing)
    for foot, column in enumerate(standing.T):
        runs = flagged_runs(column)
        edge = np.ceil(EDGE * (runs[:, 1] - runs[:, 0])).astype(np.int64)
        within = runs + edge[:, None] * [1, -1]
        inner[:, foot] = covers(within[within[:, 0] < within[:, 1]], np.arange(len(column)))
    return inner


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
    loaded = latched(on & ~ground.fast, off | ground.fast)
    for foot in range(vertical.shape[1]):
        resting = ground.resting[:, foot]
        # A foot that bounces at touchdown, while it is there already.
        swings = _lasting_s(seconds, flagged_runs(~resting))
        usual = float(median_of(swings)) if len(swings) else 0.0
        aloft = flagged_runs(~loaded[:, foot])
        short = _lasting_s(seconds, aloft) < min(BOUNCE * usual, LONGEST_BOUNCE_S)
        for first, behind in aloft[short].tolist():
            loaded[first:behind, foot] = True
        for first, behind in flagged_runs(loaded[:, foot]).tolist():
            if resting[first:behind].mean() < RESTED:
                loaded[first:behind, foot] = False
    return loaded


def _lasting_s(seconds: Floats, runs: Ints) -> Floats:
    """(k,) s from the first row of each run to its last."""
    return np.asarray(seconds[runs[:, 1] - 1] - seconds[runs[:, 0]])


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
