"""How the base moves by its legs, and leans and turns by its inertial unit, without poses.

    legs = leg_odometry(time, place, standing, turn_rate)
    base = dead_reckoned(legs)                         # a BaseHistory, where a log has no poses

A foot that stands rests on the ground. With p the place of a standing foot in the base's axes and w
the base's turn rate, the base moves by ``v = -(dp/dt + w x p)`` (Roston and Krotkov 1991), in its
own axes.
"""

from typing import Final, NamedTuple

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import (
    Flags,
    Floats,
    Ints,
    integral,
    interpolated,
    median_of,
    median_of_known,
    middles,
    norms,
)
from dogbot_logtool.core.base.poses import BaseHistory
from dogbot_logtool.core.rotations import (
    conjugate,
    from_roll_pitch_yaw,
    multiply,
    normalised,
    rotate,
)
from dogbot_logtool.core.settings import GRAVITY_MPS2

LONGEST_FLIGHT_S: Final = 0.5
"""s without a standing foot over which the velocity is interpolated; no gait flies for longer."""
LONGEST_INTERVAL_S: Final = 0.1
"""s: places further apart in time tell no velocity."""
_NORMAL_MEDIAN: Final = 0.6745
"""Median of |x| of a normal distribution, in standard deviations."""
_APART: Final = 0.25
"""Share of the largest distance between standing feet from which they tell a turn."""


class LegOdometry(NamedTuple):
    """The base's velocity by its legs, in each of the n - 1 intervals between n samples."""

    time: Ints
    """(n,) ns, the samples that bound the intervals."""
    velocity: Floats
    """(n - 1, 3) m/s, of the base's origin along the base's axes; NaN where no foot stands."""
    turn_rate: Floats
    """(n - 1, 3) rad/s about the base's axes: the one given, or by the legs about z only."""
    feet: Ints
    """(n - 1,) number of standing feet that tell."""
    noise_mps: float
    """m/s, standard deviation of one foot's velocity along one axis, by how far standing feet
    disagree; 0 where never two stand."""


def leg_odometry(
    time: Ints,
    place: Floats,
    standing: Flags,
    turn_rate: Floats | None = None,
    moved: Floats | None = None,
) -> LegOdometry:
    """Work out how the base moves by the feet that stand.

    Args:
        time: (n,) ns, strictly increasing; an interval of more than 0.1 s tells nothing.
        place: (n, f, 3) m, of each foot along the base's axes, from the base's origin; NaN: not
            known.
        standing: (n, f) whether each foot stands. The sample after a touchdown and the one before
            a lift-off are left out, since a foot does not rest there yet, or any more.
        turn_rate: (n, 3) rad/s about the base's axes, of a gyroscope or of poses; None: that about
            z is fitted to the standing feet, where two stand, and the others are taken as zero.
        moved: (n, f, 3) m/s, of the matter at the place, along which a ball rolls; None: feet roll
            on nothing, and it is the difference of places.

    Returns:
        the median velocity over the standing feet in each interval.
    """
    seconds = np.diff(time)[:, None, None] / 1e9
    rests = standing & np.isfinite(place[:, :, 0])
    settled = rests[1:] & rests[:-1]
    inner = settled.copy()
    inner[1:] &= settled[:-1]
    inner[:-1] &= settled[1:]
    velocity = -np.diff(place, axis=0) / seconds
    if moved is not None:
        velocity = -middles(moved)
    velocity[~inner | (seconds[:, :, 0] > LONGEST_INTERVAL_S)] = np.nan
    middle = middles(place)
    turns = _fitted_turn(velocity, middle) if turn_rate is None else middles(turn_rate)
    # One foot tells no turn: it turns as before and after.
    turning = bridged(turns, _middle_s(time))
    velocity -= np.cross(turning[:, None, :], middle)
    feet = np.isfinite(velocity[:, :, 0]).sum(axis=1)
    found = np.full((len(feet), 3), np.nan)
    known = feet > 0
    found[known] = median_of_known(velocity[known], axis=1)
    return LegOdometry(time, found, turns, feet, _noise(velocity, found, feet))


def _middle_s(time: Ints) -> Floats:
    """(n - 1,) s, the middle of each interval since the first time."""
    middle: Floats = (time[1:] - time[0]) / 1e9 - np.diff(time) / 1e9 / 2.0
    return middle


def _fitted_turn(velocity: Floats, place: Floats) -> Floats:
    """(n, 3) rad/s, the turn about z that makes the standing feet's velocities agree best.

    Args:
        velocity: (n, f, 3) m/s, by each foot without the turn; NaN: it does not stand.
        place: (n, f, 3) m.
    """
    known = np.isfinite(velocity[:, :, 0])
    number = np.maximum(known.sum(axis=1), 1)[:, None, None]
    speeds = np.where(known[:, :, None], velocity, 0.0)
    places = np.where(known[:, :, None], place, 0.0)
    speeds -= np.where(known[:, :, None], speeds.sum(axis=1, keepdims=True) / number, 0.0)
    places -= np.where(known[:, :, None], places.sum(axis=1, keepdims=True) / number, 0.0)
    # Without the turn's part w x p, a foot at p seems to move the base by (-w y, w x).
    arms = (places[:, :, :2] ** 2).sum(axis=(1, 2))
    moments = (places[:, :, 0] * speeds[:, :, 1] - places[:, :, 1] * speeds[:, :, 0]).sum(axis=1)
    turns = np.zeros((len(arms), 3))
    least = max(_APART**2 * float(arms.max(initial=0.0)), np.finfo(np.float64).tiny)
    turns[:, 2] = np.where(arms > least, moments / np.maximum(arms, least), np.nan)
    return turns


def _noise(velocity: Floats, common: Floats, feet: Ints) -> float:
    """m/s, how far the feet's velocities are from their median, where two or more stand."""
    rows = feet > 1
    apart = np.abs(velocity[rows] - common[rows][:, None, :])
    apart = apart[np.isfinite(apart)]
    if not len(apart):
        return 0.0
    return float(median_of(apart)) / _NORMAL_MEDIAN


def dead_reckoned(legs: LegOdometry, inertial: "Inertial | None" = None) -> BaseHistory:
    """Add up the legs' velocities to poses of the base, from the origin on, with heading 0.

    Velocity and turn are interpolated while no foot stands, for up to `LONGEST_FLIGHT_S`; a longer
    time is a gap.

    Args:
        legs: velocities.
        inertial: (n,) how the base leans, turns, and changes its velocity while no foot stands;
            None: it is level, turns by the legs, and changes it evenly.

    Returns:
        poses at the times of the samples.
    """
    time, seconds = legs.time, np.diff(legs.time) / 1e9
    middle, gained = _middle_s(time), np.zeros_like(legs.velocity)
    position, angles = np.zeros((2, len(time), 3))
    turns = bridged(legs.turn_rate, middle)[:, 2]
    if inertial is not None:
        step = middles(inertial.felt - GRAVITY_MPS2 * inertial.up) * seconds[:, None]
        gained = np.cumsum(step, axis=0) - step / 2.0
        angles[:, :2], turns = inertial.roll_pitch, middles(inertial.yaw_rate)
    velocity = gained + bridged(legs.velocity - gained, middle)
    angles[1:, 2] = np.cumsum(turns * seconds)
    step = rotate(from_roll_pitch_yaw(middles(angles)), velocity) * seconds[:, None]
    position[1:] = np.cumsum(step, axis=0)
    flights = timespans.spans_where(time, ~np.isfinite(legs.velocity[:, 0]))
    gaps = flights[flights[:, 1] - flights[:, 0] > LONGEST_FLIGHT_S * 1e9]
    return BaseHistory(time, position, angles, gaps)


def bridged(values: Floats, seconds: Floats) -> Floats:
    """(n, 3) values with linear interpolation for those that are not known; zeros of none."""
    filled = np.zeros_like(values)
    for axis, column in enumerate(values.T):
        known = np.isfinite(column)
        if known.any():
            filled[:, axis] = np.interp(seconds, seconds[known], column[known])
    return filled


SHORT_NS: Final = 10_000_000
"""ns before and after a time, over which readings are averaged."""
LONG_NS: Final = 2_000_000_000
"""The same, over which a robot's own accelerations average to nothing beside gravity."""
_TICK_NS: Final = 20_000_000
"""At which turns are added up."""
LONGEST_PER_READING_S: Final = 1.0
"""s from reading to reading on average, beyond which they tell no turns."""
GRAVITY_IS: Final = (7.0, 13.0)
"""m/s^2: an accelerometer that usually reads less or more tells nothing of gravity."""


BY_FEET: Final = "the feet alone"
BY_GYROSCOPE: Final = "a gyroscope"


class Inertial(NamedTuple):
    """An inertial unit's readings at n times, along the base's axes."""

    turn: Floats
    """(n, 3) rad/s."""
    felt: Floats
    """(n, 3) m/s^2, accelerations without gravity's: at rest, gravity upwards."""
    up: Floats
    """(n, 3) unit vectors against gravity."""
    tells_up: bool = False
    """Whether the accelerometer tells of gravity; else the base is taken as level."""
    turns_from: str = BY_FEET
    """What tells the turns."""

    @property
    def roll_pitch(self) -> Floats:
        """(n, 2) rad, of the base's axes (REP-103)."""
        roll = np.arctan2(self.up[:, 1], self.up[:, 2])
        return np.stack([roll, -np.arcsin(np.clip(self.up[:, 0], -1.0, 1.0))], axis=1)

    @property
    def yaw_rate(self) -> Floats:
        """(n,) rad/s about the vertical."""
        return np.asarray((self.turn * self.up).sum(axis=1) / (self.up[:, 1:] ** 2).sum(axis=1))


def level(times: int) -> Inertial:
    """Return what a base that stays level and does not turn would read at some times."""
    up = np.tile([0.0, 0.0, 1.0], (times, 1))
    return Inertial(np.zeros((times, 3)), GRAVITY_MPS2 * up, up)


def inertial_at(at: Ints, time: Ints, acceleration: Floats, turn: Floats) -> Inertial:
    """Average readings around times, and find where up is.

    Turns are added up, which tells how the base leans from moment to moment; the acceleration,
    turned along, averages over seconds to gravity.

    Args:
        at: (n,) ns, increasing.
        time: (m,) ns, of the readings, increasing; at least two.
        acceleration: (m, 3) m/s^2, along the base's axes.
        turn: (m, 3) rad/s.
    """
    if time[-1] - time[0] > LONGEST_PER_READING_S * 1e9 * len(time):
        return level(len(at))
    ticks = np.arange(time[0], time[-1] + _TICK_NS, _TICK_NS)
    turned = _added_up(means(time, turn, ticks, _TICK_NS // 2) * (_TICK_NS / 1e9))
    fixed = rotate(turned, means(time, acceleration, ticks, _TICK_NS // 2))
    gravity = rotate(conjugate(turned), means(ticks, fixed, ticks, LONG_NS))
    reads = float(median_of(norms(gravity)))
    rates, felt = (means(time, each, at, SHORT_NS) for each in (turn, acceleration))
    if not GRAVITY_IS[0] <= reads <= GRAVITY_IS[1]:
        return level(len(at))._replace(turn=rates, turns_from=BY_GYROSCOPE)
    up = interpolated(at, ticks, gravity)
    up /= norms(up)[:, None]
    return Inertial(rates, felt, up, tells_up=True, turns_from=BY_GYROSCOPE)


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
    columns, (start, end) = np.concatenate([acceleration, turn_rate], axis=1), windows.T
    added = integral(time, columns).added(start, end)
    added[(start < time[:1].max(initial=0)) | (end > time[-1:].max(initial=0))] = np.nan
    size = norms(added[:, :3])
    usual = median_of_known(size / ((end - start) / 1e9), axis=0)
    if not GRAVITY_IS[0] <= float(usual) <= GRAVITY_IS[1]:
        size[:] = np.nan
    up = added[:, :3] / size[:, None]
    return np.asarray((added[:, 3:] * up).sum(axis=1)), up


def means(time: Ints, values: Floats, at: Ints, half_ns: int) -> Floats:
    """(n, 3) means of values over a window about each time; at the ends over what there is."""
    inside = np.clip(at, time[0], time[-1])
    begin, end = np.maximum(inside - half_ns, time[0]), np.minimum(inside + half_ns, time[-1])
    return np.asarray(integral(time, values).added(begin, end) / ((end - begin) / 1e9)[:, None])


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
