"""How the base leans and turns, by its inertial unit."""

from typing import Final, NamedTuple

import numpy as np

from dogbot_logtool.core.arrays import (
    Floats,
    Integral,
    Ints,
    median_of,
    median_of_known,
    norms,
    trapezoids,
)
from dogbot_logtool.core.rotations import conjugate, multiply, normalised, rotate

SHORT_S: Final = 0.01
"""s before and after a time, over which readings are averaged."""
LONG_S: Final = 2.0
"""The same, over which a robot's own accelerations average to nothing beside gravity."""
RATE_HZ: Final = 50.0
"""At which turns are added up."""
LONGEST_PER_READING_S: Final = 1.0
"""s from reading to reading on average, beyond which they tell no turns."""
GRAVITY_IS: Final = (7.0, 13.0)
"""m/s^2: an accelerometer that usually reads less or more tells nothing of gravity."""


class Inertial(NamedTuple):
    """An inertial unit's readings at n times, along the base's axes."""

    turn: Floats
    """(n, 3) rad/s."""
    felt: Floats
    """(n, 3) m/s^2, accelerations without gravity's: at rest, gravity upwards."""
    up: Floats
    """(n, 3) unit vectors against gravity."""
    tells_up: bool
    """Whether the accelerometer tells of gravity; else the base is taken as level."""

    @property
    def roll_pitch(self) -> Floats:
        """(n, 2) rad, of the base's axes (REP-103)."""
        roll = np.arctan2(self.up[:, 1], self.up[:, 2])
        return np.stack([roll, -np.arcsin(np.clip(self.up[:, 0], -1.0, 1.0))], axis=1)

    @property
    def yaw_rate(self) -> Floats:
        """(n,) rad/s about the vertical."""
        return np.asarray((self.turn * self.up).sum(axis=1) / (self.up[:, 1:] ** 2).sum(axis=1))


def level(times: int, gravity_mps2: float) -> Inertial:
    """Return what a base that stays level and does not turn would read at some times."""
    up = np.tile([0.0, 0.0, 1.0], (times, 1))
    return Inertial(np.zeros((times, 3)), gravity_mps2 * up, up, tells_up=False)


def by_attitude(seconds: Floats, angles: Floats, gravity_mps2: float) -> Inertial:
    """Return what an inertial unit would read of a base that moves evenly.

    Args:
        seconds: (n,) s.
        angles: (n, 3) rad, roll, pitch and unwrapped yaw.
        gravity_mps2: m/s^2.
    """
    roll, pitch, _ = angles.T
    rates = np.gradient(angles, seconds, axis=0)
    turn = np.stack(
        [
            rates[:, 0] - rates[:, 2] * np.sin(pitch),
            rates[:, 1] * np.cos(roll) + rates[:, 2] * np.sin(roll) * np.cos(pitch),
            rates[:, 2] * np.cos(roll) * np.cos(pitch) - rates[:, 1] * np.sin(roll),
        ],
        axis=1,
    )
    up = np.stack(
        [-np.sin(pitch), np.sin(roll) * np.cos(pitch), np.cos(roll) * np.cos(pitch)], axis=1
    )
    return Inertial(turn, gravity_mps2 * up, up, tells_up=True)


def inertial_at(
    at: Floats, seconds: Floats, acceleration: Floats, turn: Floats, gravity_mps2: float
) -> Inertial:
    """Average readings around times, and find where up is.

    Turns are added up, which tells how the base leans from moment to moment; the acceleration,
    turned along, averages over seconds to gravity.

    Args:
        at: (n,) s, increasing.
        seconds: (m,) s, of the readings, increasing; at least two.
        acceleration: (m, 3) m/s^2, along the base's axes.
        turn: (m, 3) rad/s.
        gravity_mps2: m/s^2.
    """
    if seconds[-1] - seconds[0] > LONGEST_PER_READING_S * len(seconds):
        return level(len(at), gravity_mps2)
    ticks = np.arange(seconds[0], seconds[-1] + 1.0 / RATE_HZ, 1.0 / RATE_HZ)
    turned = _added_up(_means(seconds, turn, ticks, 0.5 / RATE_HZ) / RATE_HZ)
    fixed = rotate(turned, _means(seconds, acceleration, ticks, 0.5 / RATE_HZ))
    gravity = rotate(conjugate(turned), _means(ticks, fixed, ticks, LONG_S))
    reads = float(median_of(norms(gravity)))
    rates, felt = (_means(seconds, each, at, SHORT_S) for each in (turn, acceleration))
    if not GRAVITY_IS[0] <= reads <= GRAVITY_IS[1]:
        flat = level(len(at), gravity_mps2)
        return Inertial(rates, flat.felt, flat.up, tells_up=False)
    up = np.stack([np.interp(at, ticks, column) for column in gravity.T], axis=1)
    return Inertial(rates, felt, up / norms(up)[:, None], tells_up=True)


def turns_and_up(
    time: Ints, acceleration: Floats, turn_rate: Floats, windows: Ints
) -> tuple[Floats, Floats]:
    """Return how far an inertial unit turns about the vertical in windows, and where up is.

    Args:
        time: (n,) ns, of its readings, increasing.
        acceleration: (n, 3) m/s^2, along any axes.
        turn_rate: (n, 3) rad/s, along the same.
        windows: (k, 2) ns, whole strides, in which its own accelerations cancel out.

    Returns:
        (k,) rad and (k, 3) unit vectors; NaN outside the readings, and throughout where the
        accelerometer tells of no gravity.
    """
    columns = np.concatenate([acceleration, turn_rate], axis=1)
    total = Integral(time, trapezoids(np.diff(time) / 1e9, columns))
    added = total.added(*windows.T)
    added[
        (windows[:, 0] < time[:1].max(initial=0)) | (windows[:, 1] > time[-1:].max(initial=0))
    ] = np.nan
    size = norms(added[:, :3])
    usual = median_of_known(size / ((windows[:, 1] - windows[:, 0]) / 1e9), axis=0)
    if not GRAVITY_IS[0] <= float(usual) <= GRAVITY_IS[1]:
        size[:] = np.nan
    up = added[:, :3] / size[:, None]
    return np.asarray((added[:, 3:] * up).sum(axis=1)), up


def _means(seconds: Floats, values: Floats, at: Floats, half_s: float) -> Floats:
    """(n, 3) means of values over a window about each time; at the ends over what there is."""
    inside = np.clip(at, seconds[0], seconds[-1])
    begin, end = np.maximum(inside - half_s, seconds[0]), np.minimum(inside + half_s, seconds[-1])
    added = Integral(seconds, trapezoids(np.diff(seconds), values)).added(begin, end)
    return np.asarray(added / (end - begin)[:, None])


def _added_up(steps: Floats) -> Floats:
    """(n, 4) orientations from small rotations, (n, 3) rad, one after the other.

    Products of two, four, eight ... steps are made at once.
    """
    angle = norms(steps)
    half = np.sinc(angle / 2.0 / np.pi)[:, None] / 2.0 * steps
    turned = np.concatenate([half, np.cos(angle / 2.0)[:, None]], axis=1)
    reach = 1
    while reach < len(turned):
        turned[reach:] = multiply(turned[:-reach].copy(), turned[reach:])
        reach *= 2
    return normalised(turned)
