"""How the base moves, by its legs alone: a foot that stands rests on the ground.

    legs = leg_odometry(time, place, standing, turn_rate)
    base = dead_reckoned(legs)                         # a BaseHistory, where a log has no poses

With p the place of a standing foot in the base's axes and w the base's turn rate, the base moves
by ``v = -(dp/dt + w x p)`` (Roston and Krotkov 1991), in its own axes.
"""

from typing import Final, NamedTuple

import numpy as np

from dogbot_logtool.core.arrays import Flags, Floats, Ints, median_of, median_of_known
from dogbot_logtool.core.base.poses import BaseHistory
from dogbot_logtool.core.rotations import from_roll_pitch_yaw, rotate

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
        velocity = -(moved[1:] + moved[:-1]) / 2.0
    velocity[~inner | (seconds[:, :, 0] > LONGEST_INTERVAL_S)] = np.nan
    middle = (place[1:] + place[:-1]) / 2.0
    if turn_rate is None:
        turns = _fitted_turn(velocity, middle)
    else:
        turns = (turn_rate[1:] + turn_rate[:-1]) / 2.0
    velocity -= np.cross(np.nan_to_num(turns)[:, None, :], middle)
    feet = np.isfinite(velocity[:, :, 0]).sum(axis=1)
    found = np.full((len(feet), 3), np.nan)
    known = feet > 0
    found[known] = median_of_known(velocity[known], axis=1)
    return LegOdometry(time, found, turns, feet, _noise(velocity, found, feet))


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
    # Two feet are each half of their difference away from their median.
    degrees = float((feet[rows] / (feet[rows] - 1.0)).mean())
    return float(median_of(apart)) / _NORMAL_MEDIAN * float(np.sqrt(degrees))


def dead_reckoned(
    legs: LegOdometry, roll_pitch: Floats | None = None, acceleration: Floats | None = None
) -> BaseHistory:
    """Add up the legs' velocities to poses of the base, from the origin on, with heading 0.

    Velocity and turn are interpolated while no foot stands, for up to `LONGEST_FLIGHT_S`; a longer
    time is a gap.

    Args:
        legs: velocities.
        roll_pitch: (n, 2) rad, of an inertial unit; None: taken as level.
        acceleration: (n, 3) m/s^2, of the base along its axes, without gravity's: how its velocity
            changes while no foot stands; None: evenly.

    Returns:
        poses at the times of the samples.
    """
    time, seconds = legs.time, np.diff(legs.time) / 1e9
    middle = (time[1:] - time[0]) / 1e9 - seconds / 2.0
    known = np.isfinite(legs.velocity[:, 0])
    gained = np.zeros_like(legs.velocity)
    if acceleration is not None:
        step = (acceleration[1:] + acceleration[:-1]) / 2.0 * seconds[:, None]
        gained = np.cumsum(step, axis=0) - step / 2.0
    velocity = gained + _bridged(legs.velocity - gained, middle)
    turns = _bridged(legs.turn_rate, middle)
    angles = np.zeros((len(time), 3))
    angles[1:, 2] = np.cumsum(turns[:, 2] * seconds)
    if roll_pitch is not None:
        angles[:, :2] = roll_pitch
    halfway = (angles[1:] + angles[:-1]) / 2.0
    step = rotate(from_roll_pitch_yaw(halfway), velocity) * seconds[:, None]
    position = np.zeros((len(time), 3))
    position[1:] = np.cumsum(step, axis=0)
    at = np.flatnonzero(known)
    edges = np.concatenate([[0], at, [len(known)]])
    begin, end = time[np.minimum(edges[:-1] + 1, len(time) - 1)], time[edges[1:]]
    begin[0] = time[0]
    long = end - begin > LONGEST_FLIGHT_S * 1e9
    return BaseHistory(time, position, angles, np.stack([begin[long], end[long]], axis=1))


def _bridged(values: Floats, seconds: Floats) -> Floats:
    """(n, 3) values with linear interpolation for those that are not known; zeros of none."""
    filled = np.zeros_like(values)
    for axis, column in enumerate(values.T):
        known = np.isfinite(column)
        if known.any():
            filled[:, axis] = np.interp(seconds, seconds[known], column[known])
    return filled
