"""The base's accelerometer against the feet's forces and the base's poses.

Over whole strides the accelerometer of a robot that climbs at constant speed reads g, whatever the
robot weighs; the feet's vertical forces over its mass are the same; and both are g and what the
poses say of its acceleration. So of the three the one that is odd can be told. All are compared as
means over one stride about each of 25 instants a second. How the sensor sits on the base, and in
which unit it reads, is told by gravity.
"""

from typing import Final

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Floats, Integral, Ints, all_finite, trapezoids
from dogbot_logtool.core.base.poses import BaseHistory
from dogbot_logtool.core.loads import CELL_RATE_HZ, mean_impulses, vertical_is_known
from dogbot_logtool.core.metrics import Imu
from dogbot_logtool.core.rotations import conjugate, from_roll_pitch_yaw, normalised, rotate
from dogbot_logtool.core.settings import GRAVITY_MPS2
from dogbot_logtool.core.vectors import ForceComparison, ImuComparison, Reading
from dogbot_logtool.core.walk import Walk

STANDING_WINDOW_S: Final = 0.5
"""s, what means are over in a log without strides."""
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
_SHIFTS: Final = 0.05
"""Standard deviation of a foot's share from which the load shifts to and from it."""

_LEVEL: Final = np.array([0.0, 0.0, 0.0, 1.0])


def compare_imu(walk: Walk) -> ImuComparison | None:
    """Compare accelerometer, forces and poses.

    Args:
        walk: what its accelerometer reads, in its own frame, its base and its feet.

    Returns:
        None where accelerometer and poses have too little time in common.
    """
    sensed = walk.corrected.inertial
    if sensed is None:
        return None
    base, mounting = walk.poses, walk.settings.imu_mounting
    angles = base.angles_at(sensed.time)
    rows = np.flatnonzero(all_finite(angles))
    if len(rows) < 2:
        return None
    at, attitude, body = sensed.time[rows], from_roll_pitch_yaw(angles[rows]), sensed.vector[rows]
    if mounting is not None:
        body = rotate(np.array([mounting]), body)
    half = round((walk.period_s or STANDING_WINDOW_S) * 5e8)
    silent = np.flatnonzero(np.diff(at) > min(sensed.gap_ns, SPARSE_NS))
    gaps = np.stack([at[silent], at[silent + 1]], axis=1)
    known = timespans.intersect([at[[0, -1]][None, :], base.known])
    left_out = timespans.merge(np.concatenate([gaps, walk.jumps.spans, walk.fallen]))
    known = timespans.subtract(known, left_out)
    time = timespans.ticks(known, _CELL_NS)
    time = time[timespans.hold_window(known, time, half + _SPEED_NS, half + _SPEED_NS)]
    if len(time) < FEWEST:
        return None
    poses = _acceleration(base, time, half)
    up = rotate(conjugate(attitude), np.broadcast_to([0.0, 0.0, GRAVITY_MPS2], body.shape))
    means = _integral(at, np.concatenate([body, up], axis=1)).mean(time, 2 * half)
    turned = from_roll_pitch_yaw(base.angles_at(time))
    expected = means[:, 3:] + rotate(conjugate(turned), poses)
    mean, wanted = means[:, :3].mean(axis=0), expected.mean(axis=0)
    size = float(np.linalg.norm(mean))
    scale = size / float(np.linalg.norm(wanted))
    turn, tilt_rad = _between(mean, wanted) if size >= NO_GRAVITY * GRAVITY_MPS2 else (_LEVEL, None)
    off = rotate(turn[None], means[:, :3]) - scale * expected
    reading = _reading(size, scale, float(np.sqrt((off * off).sum(axis=1).mean())))
    forces = None
    if reading == "m/s^2":
        world = _integral(at, rotate(attitude, rotate(turn[None], body)))
        forces = _compare_forces(walk, world, time, half)
    metrics = Imu(
        topic=sensed.topic,
        known_s=len(time) / CELL_RATE_HZ,
        accelerometer_mps2=size,
        tilt_rad=None if reading == "unclear" else tilt_rad,
        forces_over_accelerometer=None if forces is None else forces.ratio,
    )
    return ImuComparison(metrics, reading, scale, forces)


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


def _integral(time: Ints, values: Floats) -> Integral:
    """Add up values, (n, k), over times, (n,) ns."""
    return Integral(time, trapezoids(np.diff(time) / 1e9, values))


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
) -> ForceComparison | None:
    """Return what the forces say; None where they are not known for long enough.

    Args:
        walk: its feet, which carry the robot in whole strides only.
        world: of the levelled accelerometer, gravity included, m/s along the world's axes.
        time: (n,) ns, 25 a second: means over the window about them are known.
        half_ns: half of the window, which is a stride.
    """
    feet, mass_kg = walk.records, walk.settings.mass_kg
    apart = walk.feet_clocks_are_apart or walk.base_is_apart or walk.settings.lacks_feet
    if mass_kg is None or apart or not walk.vertical_known:
        return None
    loaded = [foot for foot in feet if len(foot.in_contact)]
    if not loaded or not all(vertical_is_known(foot) for foot in loaded):
        return None
    known = timespans.intersect(
        [timespans.merge(walk.strides), *(foot.vertical_known for foot in feet)]
    )
    rows = timespans.hold_window(known, time, half_ns, half_ns)
    time = time[rows]
    if len(time) < FEWEST:
        return None
    expected = mass_kg * float(world.mean(time, 2 * half_ns)[:, 2].mean())
    cells, half_cell = time + _CELL_NS // 2, _CELL_NS // 2
    wanted = mass_kg * world.mean(cells, 2 * half_cell)[:, 2]
    by_cell = mean_impulses(feet, "vertical_impulse", cells, half_cell)
    vertical = float(mean_impulses(feet, "vertical_impulse", time, half_ns).sum(axis=1).mean())
    return ForceComparison(vertical / expected, odd_scale(by_cell, wanted, mass_kg))


def odd_scale(vertical: Floats, wanted: Floats, mass_kg: float) -> tuple[int, float] | None:
    """Fit mass x vertical specific force = sum of factor x force, for all feet and for each.

    Args:
        vertical: (n, feet) N.
        wanted: (n,) N, mass times vertical specific force at the same times.
        mass_kg: of the robot.

    Returns:
        The odd foot, as in `ForceComparison`.
    """
    total = vertical.sum(axis=1)
    shares = vertical / np.where(total > 0.0, total, np.inf)[:, None]
    # Feet that always press together have no factors of their own.
    if not total.any() or (shares.std(axis=0) < _SHIFTS).any() or np.linalg.cond(vertical) > 1e3:
        return None
    inverse = np.linalg.pinv(vertical.T @ vertical)
    factors = inverse @ (vertical.T @ wanted)
    common = float(total @ wanted) / float(total @ total)
    left = [_rms(wanted - common * total), _rms(wanted - vertical @ factors)]
    # What is left may come back in every stride: more of them make a factor no surer.
    spread = left[1] * np.sqrt(len(total) * np.diag(inverse))
    off = np.flatnonzero(np.abs(factors - 1.0) > ODD)
    one = left[0] > left[1] + _AS_GOOD * mass_kg * GRAVITY_MPS2 and len(off) == 1
    return (int(off[0]), float(factors[off[0]])) if one and (spread <= _CERTAIN).all() else None


def _rms(values: Floats) -> float:
    return float(np.sqrt((values * values).mean()))
