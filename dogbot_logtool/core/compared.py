"""How the base follows its velocity commands, feet their plan, and what its accelerometer reads.

All velocities and accelerations are means over one stride: a robot's gait swings about its speed
once or twice a stride, which is no error. Commands are averaged alike, so that this delays nothing.
A command holds until the next, but not beyond a time-out.

Over whole strides the accelerometer of a robot that climbs at constant speed reads g, whatever the
robot weighs; the feet's vertical forces over its mass are the same; and both are g and what the
poses say of its acceleration. So of the three the one that is odd can be told. All are compared
about each of 25 instants a second. How the sensor sits on the base, and in which unit it reads, is
told by gravity.
"""

from collections.abc import Sequence
from typing import Final

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import (
    Floats,
    Integral,
    Ints,
    aggregate,
    all_finite,
    integral,
    median_of,
    nearest_rows,
)
from dogbot_logtool.core.base.poses import BaseHistory
from dogbot_logtool.core.base.witness import motion_in
from dogbot_logtool.core.gait.feet import FootSteps
from dogbot_logtool.core.loads import CELL_RATE_HZ, mean_impulses
from dogbot_logtool.core.metrics import Imu, Planned
from dogbot_logtool.core.rotations import (
    along_heading,
    conjugate,
    from_roll_pitch_yaw,
    normalised,
    rotate,
)
from dogbot_logtool.core.settings import GRAVITY_MPS2
from dogbot_logtool.core.vectors import (
    AXES,
    TRACKING_HZ,
    CommandTrack,
    ImuComparison,
    PlannedFoot,
    Reading,
    VectorHistory,
)
from dogbot_logtool.core.walk import Walk

USUAL_WINDOW_S: Final = 0.5
"""s, what means are over in a log without strides."""
TIMEOUT_S: Final = 0.5
"""s; what ros2_controllers' diff_drive_controller waits for a command before it stops."""
_WORLD_FRAMES: Final = frozenset({"world", "odom", "map", "earth"})
_CLEARLY: Final = 0.7
"""The better of two readings of the axes has at most this share of the other's error."""
OPPOSED: Final = -0.7
"""Correlation up to which the base does the opposite of its command."""
_DELAYS_NS: Final = (0, 200_000_000, 400_000_000)
"""ns, by which the base may follow later: it does the opposite only if it does with each."""
_LEAST_CHANGE: Final = 0.03
"""m/s or rad/s, standard deviation from which a correlation means something."""
_FEWEST_WINDOWS: Final = 4
"""Times the window; a correlation over less time means nothing."""


def follow_commands(walk: Walk, history: VectorHistory) -> CommandTrack | None:
    """Compare commands with the base's velocity over time.

    Args:
        walk: with the base.
        history: linear x and y, and angular z.

    Returns:
        None without poses.
    """
    base, forward_rad = walk.track.history, walk.settings.forward_rad
    if len(base.time) < 2:
        return None
    window = round((walk.period_s or USUAL_WINDOW_S) * 1e9)
    timeout = round(max(TIMEOUT_S * 1e9, history.gap_ns if np.isfinite(history.gap_ns) else 0.0))
    until = np.append(history.time[1:], history.time[-1:] + timeout)
    held = np.stack([history.time, np.minimum(until, history.time + timeout)], axis=1)
    holds = timespans.merge(held)
    known = timespans.subtract(base.known, timespans.merge(walk.jumps.spans))
    both = timespans.intersect([known, holds])
    time = timespans.ticks(both, round(1e9 / TRACKING_HZ))
    half = window // 2
    time = time[timespans.hold_window(both, time, half, half)]
    motion = motion_in(base, time[:, None] + np.array([-half, half]), forward_rad)
    moved = motion.displacement.real, motion.displacement.imag, motion.turn
    measured = np.stack(moved, axis=1) / (2e-9 * half)
    command = _command(held, history.vector)
    commanded = command.mean(time, window)
    turn_rad, axes_known = _axes_turn(history.frames, commanded, measured, forward_rad)
    longest = timespans.hold_window(holds, time, half + max(_DELAYS_NS), half)
    opposed = []
    if longest.sum() / TRACKING_HZ >= _FEWEST_WINDOWS * window / 1e9:
        late = [
            along_heading(command.mean(time[longest] - delay, window), turn_rad)
            for delay in _DELAYS_NS
        ]
        opposed = [
            name
            for axis, name in enumerate(AXES)
            if (axes_known or axis == 2)
            and all(_oppose(measured[longest, axis], each[:, axis]) for each in late)
        ]
    return CommandTrack(
        history=history,
        axes_known=axes_known,
        window_ns=window,
        timeout_ns=timeout,
        commanded_s=timespans.total(both) / 1e9,
        no_command_s=(timespans.total(known) - timespans.total(both)) / 1e9,
        time=time,
        commanded=along_heading(commanded, turn_rad),
        measured=measured,
        opposed=tuple(opposed),
    )


def _command(held: Ints, velocity: Floats) -> Integral:
    """Add up commands: (n, 2) ns for which each holds, (n, 3) as in `AXES`; none counts as zero."""
    each = velocity * ((held[:, 1] - held[:, 0]) / 1e9)[:, None]
    total = np.zeros((2 * len(held), 3))
    total[1::2] = np.cumsum(each, axis=0)
    total[2::2] = total[1:-1:2]
    return Integral(held.ravel(), total)


def _axes_turn(
    frames: Sequence[str], commanded: Floats, measured: Floats, forward_rad: float
) -> tuple[float, bool]:
    """Tell by the smaller error in whose axes commands are: the robot's own, or the base's.

    Returns:
        rad by which commands are turned into the robot's own axes, and whether that is known.
    """
    if not _WORLD_FRAMES.isdisjoint(name.strip("/") for name in frames):
        return 0.0, False
    if forward_rad == 0.0:
        return 0.0, True
    turns = 0.0, forward_rad
    errors = [measured - along_heading(commanded, each) for each in turns]
    squares = [float((each[:, :2] ** 2).sum()) for each in errors]
    better = squares.index(min(squares))
    clear = squares[better] <= _CLEARLY**2 * squares[1 - better] or not commanded[:, :2].any()
    return turns[better], bool(clear)


def _oppose(measured: Floats, commanded: Floats) -> bool:
    """Tell whether what is measured, (n,), does the opposite of what is commanded, (n,)."""
    if min(measured.std(), commanded.std()) < _LEAST_CHANGE:
        return False
    return float(np.corrcoef(measured, commanded)[0, 1]) <= OPPOSED


ON_TIME_S: Final = 0.02
"""s; touchdowns that are off by less are on time, and by less than a sample of either, too."""
_LONE_NS: Final = 250_000_000
"""ns around a touchdown without neighbours in which its match is looked for."""


def follow_plan(measured: FootSteps, planned: FootSteps) -> PlannedFoot:
    """Compare a foot's steps with its plan.

    A planned touchdown is matched with the nearest measured one if it is the nearest of that one,
    too, and nearer than half of a planned stride. Touchdowns nearer than that to where either is
    unknown are left out: their match may be hidden.

    Args:
        measured: the foot.
        planned: the same foot in a plan, on the same clock.
    """
    records = measured.record, planned.record
    both = timespans.intersect([record.known for record in records])
    plan, steps = planned.touchdown, measured.touchdown
    steps_ns = np.diff(plan)
    reach = int(median_of(steps_ns)) // 2 if len(steps_ns) else _LONE_NS
    match = _matches(plan, steps, reach)
    found = match >= 0
    seen = found & timespans.covers(both, plan)
    counted = timespans.hold_window(both, plan, reach, reach) | seen
    delay = (steps[match[found & counted]] - plan[found & counted]) / 1e9
    tolerance = max(ON_TIME_S, *(record.median_interval_s or 0.0 for record in records))
    alone = np.setdiff1d(np.arange(len(steps)), match[found])
    down = [timespans.intersect([record.in_contact, both]) for record in records]
    together = timespans.total(timespans.intersect(down))
    differ = sum(map(timespans.total, down)) - 2 * together
    known = timespans.total(both)
    return PlannedFoot(
        topic=planned.topic,
        touchdowns=int(counted.sum()),
        early=int((delay < -tolerance).sum()),
        late=int((delay > tolerance).sum()),
        metrics=Planned(
            delay_s=aggregate(delay),
            missed=int((counted & ~found).sum()),
            unplanned=int(timespans.hold_window(both, steps[alone], reach, reach).sum()),
            agreement=1.0 - differ / known if known else None,
        ),
    )


def _matches(plan: Ints, steps: Ints, reach: int) -> Ints:
    """(p,) measured touchdown of each planned one; -1: none."""
    if not len(plan) or not len(steps):
        return np.full(len(plan), -1, np.int64)
    nearest = nearest_rows(steps, plan)
    mutual = nearest_rows(plan, steps)[nearest] == np.arange(len(plan))
    near = np.abs(steps[nearest] - plan) <= reach
    match: Ints = np.where(mutual & near, nearest, -1)
    return match


SPARSE_NS: Final = 1_000_000_000
"""ns; readings further apart than this tell no acceleration."""
FEWEST: Final = round(2.0 * CELL_RATE_HZ)
"""Instants, of 2 s, at which all that is compared must be known."""
_CELL_NS: Final = round(1e9 / CELL_RATE_HZ)
_SPEED_NS: Final = 50_000_000
"""ns before and after: the base's speed is its way over this time."""

TOLERANCE: Final = 0.05
"""Share by which an accelerometer of g may read too much or too little."""
NO_GRAVITY: Final = 0.04
"""Share of g: a mean specific force below it has no gravity in it; one in g reads 0.1 of it."""
STEADY: Final = 0.1
"""Share of g: root mean square of means over strides that a mounting need not explain."""

ODD: Final = 0.15
"""A factor that is further from 1, and from the others, is odd."""
_CERTAIN: Final = 0.1
"""Error up to which a factor is told."""
_AS_GOOD: Final = 0.02
"""Share of g by which one factor for all feet may explain less than one for each."""

_LEVEL: Final = np.array([0.0, 0.0, 0.0, 1.0])


def compare_imu(walk: Walk, sensed: VectorHistory) -> ImuComparison | None:
    """Compare accelerometer, forces and poses.

    Args:
        walk: its base and its feet.
        sensed: what the accelerometer reads, in its own frame.

    Returns:
        None where accelerometer and poses have too little time in common.
    """
    base, mounting = walk.poses, walk.settings.imu_mounting
    angles = base.angles_at(sensed.time)
    rows = np.flatnonzero(all_finite(angles))
    if len(rows) < 2:
        return None
    at, attitude, body = sensed.time[rows], from_roll_pitch_yaw(angles[rows]), sensed.vector[rows]
    if mounting is not None:
        body = rotate(np.array([mounting]), body)
    half = round((walk.period_s or USUAL_WINDOW_S) * 5e8)
    gaps = timespans.steps_where(at, np.diff(at) > min(sensed.gap_ns, SPARSE_NS))
    known = timespans.intersect([at[[0, -1]][None, :], base.known])
    left_out = timespans.merge(np.concatenate([gaps, walk.jumps.spans, walk.fallen]))
    known = timespans.subtract(known, left_out)
    time = timespans.ticks(known, _CELL_NS)
    time = time[timespans.hold_window(known, time, half + _SPEED_NS, half + _SPEED_NS)]
    if len(time) < FEWEST:
        return None
    poses = _acceleration(base, time, half)
    up = rotate(conjugate(attitude), np.broadcast_to([0.0, 0.0, GRAVITY_MPS2], body.shape))
    means = integral(at, np.concatenate([body, up], axis=1)).mean(time, 2 * half)
    turned = from_roll_pitch_yaw(base.angles_at(time))
    expected = means[:, 3:] + rotate(conjugate(turned), poses)
    mean, wanted = means[:, :3].mean(axis=0), expected.mean(axis=0)
    size = float(np.linalg.norm(mean))
    scale = size / float(np.linalg.norm(wanted))
    turn, tilt_rad = _between(mean, wanted) if size >= NO_GRAVITY * GRAVITY_MPS2 else (_LEVEL, None)
    off = rotate(turn[None], means[:, :3]) - scale * expected
    reading = _reading(size, scale, float(np.sqrt((off * off).sum(axis=1).mean())))
    ratio, odd_foot = None, None
    if reading == "m/s^2":
        world = integral(at, rotate(attitude, rotate(turn[None], body)))
        ratio, odd_foot = _compare_forces(walk, world, time, half)
    metrics = Imu(
        topic=sensed.topic,
        known_s=len(time) / CELL_RATE_HZ,
        accelerometer_mps2=size,
        tilt_rad=None if reading == "unclear" else tilt_rad,
        forces_over_accelerometer=ratio,
    )
    return ImuComparison(metrics, reading, scale, odd_foot)


def _reading(size: float, scale: float, off: float) -> Reading:
    """Tell what an accelerometer reads.

    Args:
        size: of its mean reading.
        scale: that over what is expected.
        off: root mean square of what its mounting does not explain, as it reads.
    """
    if not size:
        return "nothing"
    if size < NO_GRAVITY * GRAVITY_MPS2:
        return "without gravity"
    if off > scale * STEADY * GRAVITY_MPS2:
        return "unclear"
    if abs(scale - 1.0) <= TOLERANCE:
        return "m/s^2"
    return "g" if abs(scale * GRAVITY_MPS2 - 1.0) <= TOLERANCE else "another scale"


def _acceleration(base: BaseHistory, time: Ints, half_ns: int) -> Floats:
    """(n, 3) m/s^2, the base's mean acceleration in the world over a window about each time."""
    before, after = (
        (base.position_at(at + _SPEED_NS) - base.position_at(at - _SPEED_NS)) / (2e-9 * _SPEED_NS)
        for at in (time - half_ns, time + half_ns)
    )
    mean: Floats = np.nan_to_num((after - before) / (2e-9 * half_ns))
    return mean


def _between(first: Floats, second: Floats) -> tuple[Floats, float]:
    """Return the shortest rotation from one direction to another, x, y, z, w, and its angle."""
    one, other = (each / np.linalg.norm(each) for each in (first, second))
    axis, cosine = np.cross(one, other), float(one @ other)
    if cosine < 0.0 and float(np.linalg.norm(axis)) < 1e-9:
        # Any axis at a right angle will do for half a turn.
        axis = np.cross(one, np.eye(3)[int(np.abs(one).argmin())])
    turn = normalised(np.append(axis, 1.0 + cosine)[None, :])[0]
    return turn, 2.0 * float(np.arctan2(np.linalg.norm(turn[:3]), turn[3]))


def _compare_forces(
    walk: Walk, world: Integral, time: Ints, half_ns: int
) -> tuple[float | None, tuple[int, float] | None]:
    """Return forces over what the accelerometer says, and the odd foot, as in `ImuComparison`.

    None of both where forces are not known for long enough.

    Args:
        walk: its feet, which carry the robot in whole strides only.
        world: of the levelled accelerometer, gravity included, m/s along the world's axes.
        time: (n,) ns, 25 a second: means over the window about them are known.
        half_ns: half of the window, which is a stride.
    """
    feet, mass_kg = walk.records, walk.settings.mass_kg
    apart = walk.feet_clocks_are_apart or walk.base_is_apart or walk.settings.lacks_feet
    if mass_kg is None or apart or not walk.vertical_known:
        return None, None
    known = timespans.intersect(
        [timespans.merge(walk.strides), *(foot.vertical_known for foot in feet)]
    )
    rows = timespans.hold_window(known, time, half_ns, half_ns)
    time = time[rows]
    if len(time) < FEWEST:
        return None, None
    expected = mass_kg * float(world.mean(time, 2 * half_ns)[:, 2].mean())
    cells, half_cell = time + _CELL_NS // 2, _CELL_NS // 2
    wanted = mass_kg * world.mean(cells, 2 * half_cell)[:, 2]
    by_cell = mean_impulses(feet, "vertical_impulse", cells, half_cell)
    vertical = float(mean_impulses(feet, "vertical_impulse", time, half_ns).sum(axis=1).mean())
    return vertical / expected, odd_scale(by_cell, wanted, mass_kg)


def odd_scale(vertical: Floats, wanted: Floats, mass_kg: float) -> tuple[int, float] | None:
    """Fit mass x vertical specific force = sum of factor x force, for all feet and for each.

    Args:
        vertical: (n, feet) N.
        wanted: (n,) N, mass times vertical specific force at the same times.
        mass_kg: of the robot.

    Returns:
        The odd foot, as in `ImuComparison`.
    """
    total = vertical.sum(axis=1)
    if not total.any():
        return None
    fit = np.linalg.pinv(vertical)
    factors = fit @ wanted
    common = float(total @ wanted) / float(total @ total)
    left = [_rms(wanted - common * total), _rms(wanted - vertical @ factors)]
    # What is left may come back in every stride: more of them make a factor no surer.
    spread = left[1] * np.sqrt(len(total) * (fit * fit).sum(axis=1))
    off = np.flatnonzero(np.abs(factors - 1.0) > ODD)
    one = left[0] > left[1] + _AS_GOOD * mass_kg * GRAVITY_MPS2 and len(off) == 1
    return (int(off[0]), float(factors[off[0]])) if one and (spread <= _CERTAIN).all() else None


def _rms(values: Floats) -> float:
    return float(np.sqrt((values * values).mean()))
