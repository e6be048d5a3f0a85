"""Feet without sensors and a base without poses: what the joints of the legs tell of both."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final, Literal

import numpy as np

from dogbot_logtool.core.arrays import Flags, Floats, Ints, all_finite, median_of, nearest_rows
from dogbot_logtool.core.base.attitude import LONG_S, Inertial, by_attitude, inertial_at, level
from dogbot_logtool.core.base.leg_odometry import dead_reckoned, leg_odometry
from dogbot_logtool.core.base.poses import Odometry, base_history
from dogbot_logtool.core.contact.contact_rule import find_stances, rows_in_stances
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.corrections.clock import advancing
from dogbot_logtool.core.estimated.ground import (
    FEWEST,
    SLOWEST_S,
    LegJoints,
    effort_fault,
    ground_forces,
    loaded_feet,
    low_feet,
    resting_feet,
    slopes,
)
from dogbot_logtool.core.frames.kinematics import Leg, LegMotion, leg_motion
from dogbot_logtool.core.recording import Recording
from dogbot_logtool.core.rotations import from_roll_pitch_yaw, rotate
from dogbot_logtool.core.settings import GRAVITY_MPS2

SHORTEST_S: Final = 0.04
"""s: shorter swings and stances are none."""
CONTRADICTS: Final = 0.5
"""Share of the mean turn rate by which a gyroscope's differs from that of the feet if it is wrong;
not less than `LEAST_TURN_RADPS`."""
LEAST_TURN_RADPS: Final = 0.1
_BY_FEET: Final = "the feet alone"
TURNS_S: Final = 0.1
"""s before and after a time, over which turns by the feet are averaged."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Estimate:
    """What legs tell."""

    feet: tuple[Samples, ...]
    """Contacts of each leg's foot, with forces and points in the world."""
    base: Odometry
    """Poses of the base from the origin on, with heading 0; the height is that over the feet."""
    contact_from: Literal["joint_torques", "kinematics"]
    why_no_force: str
    """Empty where forces are known."""
    turns_from: str
    tells_up: bool
    """Whether roll and pitch are told; else the base is taken as level."""


def estimate(
    recording: Recording,
    legs: Sequence[Leg],
    joints: LegJoints,
    mounting: Floats,
    mass_kg: float | None,
) -> Estimate:
    """Work out contacts and forces of the feet, and poses of the base.

    Args:
        recording: the columns of a log.
        legs: of the robot.
        joints: of these legs.
        mounting: (4,) x, y, z, w, of the inertial unit's frame in the base's.
        mass_kg: of the robot; None: not known, so that efforts tell no forces.
    """
    seconds, motions, rates = joints.seconds, [], []
    for leg in legs:
        positions = joints.position[:, joints.columns(leg.measured)]
        motions.append(leg_motion(leg, positions))
        rates.append(slopes(seconds, positions))
    inertial, turns_from = _inertial(recording, joints, mounting)
    points = np.stack([each.foot - each.leg.radius_m * inertial.up for each in motions], axis=1)
    velocity = np.stack(
        [
            np.einsum("nik,nk->ni", motion.jacobian(points[:, foot])[0], rates[foot])
            for foot, motion in enumerate(motions)
        ],
        axis=1,
    )
    low = low_feet(seconds, points, inertial.up)
    by_feet = _turned_by_feet(joints.time, points, low, inertial)
    turns = float(inertial.yaw_rate.mean()), float(by_feet.yaw_rate.mean())
    if not turns_from:
        turns_from = _BY_FEET
    elif abs(turns[0] - turns[1]) > max(CONTRADICTS * max(map(abs, turns)), LEAST_TURN_RADPS):
        says = f"{turns[0]:.2f} rad/s of {turns_from} contradict {turns[1]:.2f} of theirs"
        turns_from = f"{_BY_FEET}, since {says}"
    by_feet_alone = turns_from.startswith(_BY_FEET)
    inertial = by_feet if by_feet_alone else inertial
    ground = resting_feet(seconds, points, velocity, inertial.turn, inertial.up)
    if by_feet_alone:
        inertial = _turned_by_feet(joints.time, points, ground.resting, inertial)
        ground = resting_feet(seconds, points, velocity, inertial.turn, inertial.up)
    force, why = _forces(joints, motions, points, inertial, mass_kg)
    standing = ground.resting
    if force is not None:
        vertical = np.einsum("nfi,ni->nf", force, inertial.up)
        standing = loaded_feet(seconds, vertical, (mass_kg or 0.0) * GRAVITY_MPS2, ground)
    standing = np.stack([_debounced(joints.time, each) for each in standing.T], axis=1)
    moved = leg_odometry(joints.time, points, ground.surely(standing), inertial.turn, velocity)
    yaw_rate = np.stack([0.0 * inertial.yaw_rate, 0.0 * inertial.yaw_rate, inertial.yaw_rate], 1)
    moved = replace(moved, turn_rate=(yaw_rate[1:] + yaw_rate[:-1]) / 2.0)
    own = inertial.felt - GRAVITY_MPS2 * inertial.up
    found = dead_reckoned(moved, inertial.roll_pitch, own)
    position = found.position.copy()
    position[:, 2] = _height(seconds, points, standing, inertial.up)
    turned, rate = from_roll_pitch_yaw(found.angles), np.gradient(position, seconds, axis=0)
    base = Odometry(joints.log_time, joints.stamp, position, turned, rate, inertial.turn)
    placed = base
    if len(recording.base.log_time):
        poses = base_history(recording.base, joints.clock)
        turned = from_roll_pitch_yaw(poses.angles_at(joints.time))
        placed = replace(base, position=poses.position_at(joints.time), orientation=turned)
    return Estimate(
        feet=tuple(
            _samples(
                foot,
                standing[:, foot],
                points[:, foot],
                None if force is None else force[:, foot],
                placed,
            )
            for foot in range(len(legs))
        ),
        base=base,
        contact_from="kinematics" if force is None else "joint_torques",
        why_no_force=why,
        turns_from=turns_from,
        tells_up=inertial.tells_up,
    )


def _inertial(recording: Recording, joints: LegJoints, mounting: Floats) -> tuple[Inertial, str]:
    """Return how the base leans and turns, and by what: its inertial unit, else its poses."""
    readings = recording.accelerations
    if readings is not None:
        read, times = readings.samples, joints.clock.of(readings.samples)
        reach = round(LONG_S * 1e9)
        near = (times >= joints.time[0] - reach) & (times <= joints.time[-1] + reach)
        rows = np.flatnonzero(near & all_finite(read.vector) & all_finite(read.turn_rate))
        rows = rows[advancing(times[rows])]
        if len(rows) >= FEWEST:
            seconds = (times[rows] - joints.time[0]) / 1e9
            felt, turn = (rotate(mounting[None], e[rows]) for e in (read.vector, read.turn_rate))
            return inertial_at(joints.seconds, seconds, felt, turn, GRAVITY_MPS2), "a gyroscope"
    angles = base_history(recording.base, joints.clock).angles_at(joints.time)
    known = np.flatnonzero(all_finite(angles))
    if len(known):
        row = np.arange(len(angles))
        filled = np.stack([np.interp(row, known, each[known]) for each in angles.T], axis=1)
        return by_attitude(joints.seconds, filled, GRAVITY_MPS2), "its poses"
    return level(len(joints.time), GRAVITY_MPS2), ""


def _turned_by_feet(time: Ints, points: Floats, resting: Flags, inertial: Inertial) -> Inertial:
    """Return readings with the turn about the vertical that the resting feet tell."""
    turns = leg_odometry(time, points, resting).turn_rate[:, 2]
    known = np.flatnonzero(np.isfinite(turns))
    if not len(known):
        return inertial
    rates = np.interp(np.arange(len(time)), known, turns[known])
    step_s = float(median_of(np.diff(time))) / 1e9
    around = min(2 * round(TURNS_S / step_s) + 1, len(rates))
    rates = np.convolve(np.pad(rates, around // 2, "edge"), np.ones(around) / around, "valid")
    turn = inertial.turn.copy()
    turn[:, 2] = rates[: len(turn)]
    return replace(inertial, turn=turn)


def _forces(
    joints: LegJoints,
    motions: Sequence[LegMotion],
    points: Floats,
    inertial: Inertial,
    mass_kg: float | None,
) -> tuple[Floats | None, str]:
    """Return (n, f, 3) N along the base's axes; None, and why, where efforts tell none."""
    if not np.isfinite(joints.effort).all():
        some = np.isfinite(joints.effort).any()
        return None, "some joints tell no effort" if some else "efforts are empty"
    if not joints.effort.any():
        return None, "efforts are constantly zero"
    efforts = [joints.effort[:, joints.columns(each.leg.measured)] for each in motions]
    force = ground_forces(joints.seconds, motions, points, efforts, inertial.felt)
    vertical = np.einsum("nfi,ni->nf", force, inertial.up)
    why = effort_fault(vertical, None if mass_kg is None else mass_kg * GRAVITY_MPS2)
    return (None if why else force), why


def _debounced(time: Ints, standing: Flags) -> Flags:
    begin, end, _, _ = find_stances(time, standing, SHORTEST_S)
    return rows_in_stances(begin, end, standing)


def _height(seconds: Floats, points: Floats, standing: Flags, up: Floats) -> Floats:
    """(n,) m, of the base over the mean of the standing feet."""
    below = np.where(standing, -np.einsum("nfi,ni->nf", points, up), 0.0)
    count = standing.sum(axis=1)
    some = np.flatnonzero(count)
    if not len(some):
        return np.zeros(len(seconds))
    heights = below.sum(axis=1)[some] / count[some]
    return np.asarray(np.interp(seconds, seconds[some], heights))


def _samples(
    foot: int, standing: Flags, points: Floats, force: Floats | None, base: Odometry
) -> Samples:
    """Return contact samples, with forces and points in the world."""
    count, there = len(standing), standing[:, None]
    place = np.where(there, base.position + rotate(base.orientation, points), np.nan)
    push = np.zeros((count, 3))
    if force is not None:
        push = np.where(there, rotate(base.orientation, force), 0.0)
    return Samples(
        foot=np.broadcast_to(np.int64(foot), count),
        log_time=base.log_time,
        stamp=base.stamp,
        in_contact=standing,
        force=push,
        in_world=np.ones(count, np.bool_),
        points=np.isfinite(place[:, 0]).astype(np.int64),
        position=place,
        normal=np.full((count, 3), np.nan),
    )


def placed_by_legs(sensed: Samples, estimated: Samples) -> Samples:
    """Return a sensor's samples with the places where its leg rests."""
    if not len(sensed.log_time):
        return sensed
    row = nearest_rows(estimated.log_time, sensed.log_time)
    near = np.abs(estimated.log_time[row] - sensed.log_time) <= SLOWEST_S * 1e9
    return replace(sensed, position=np.where(near[:, None], estimated.position[row], np.nan))
