"""Feet without sensors and a base without poses: what the joints of the legs tell of both."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import Final, Literal, NamedTuple

import numpy as np

from dogbot_logtool.core.arrays import (
    Flags,
    Floats,
    Ints,
    all_finite,
    flagged_runs,
    mean_of_known,
    median_of,
)
from dogbot_logtool.core.base.leg_odometry import (
    BY_FEET,
    LONG_NS,
    Inertial,
    LegOdometry,
    bridged,
    dead_reckoned,
    inertial_at,
    level,
    means,
)
from dogbot_logtool.core.base.poses import Odometry, base_history
from dogbot_logtool.core.clock import TimeSource, advancing
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.contact.foot_history import find_stances, rows_in_stances
from dogbot_logtool.core.frames.kinematics import Leg, leg_motion
from dogbot_logtool.core.legs.ground import (
    BOUNCE,
    FEWEST,
    LONGEST_BOUNCE_S,
    FeetOnGround,
    at_rest,
    effort_fault,
    ground_forces,
    loaded_feet,
    resting_feet,
    settled,
    stuck_joint,
)
from dogbot_logtool.core.recording import JointTable, Recording
from dogbot_logtool.core.rotations import from_roll_pitch_yaw, rotate
from dogbot_logtool.core.settings import GRAVITY_MPS2

SHORTEST_S: Final = 0.04
"""s: shorter swings and stances are none."""
CONTRADICTS: Final = 0.5
"""Share of the mean turn rate by which a gyroscope's differs from that of the feet if it is wrong;
not less than `LEAST_TURN_RADPS`."""
LEAST_TURN_RADPS: Final = 0.1
AGREES: Final = 0.15
"""Share of the time in which standing feet agree on how the base moves, at least: it is 0.3 and
more in all gaits of a physics engine."""
FEWEST_IN_STRIDE: Final = 16
"""Joint states in a stride, at least: with fewer, speeds may be off by a third."""
STILL_NS: Final = 1_000_000_000
"""ns in which a robot whose joints move by less than `STILL_RAD` stands, and does not turn."""
STILL_RAD: Final = 0.01
LARGEST_BIAS_RADPS: Final = 0.05
"""What a gyroscope reads at rest, at most; more is a turn."""
_TURNS_NS: Final = 100_000_000
"""ns before and after a time, over which turns by the feet are averaged."""


class Estimate(NamedTuple):
    """What legs tell."""

    feet: tuple[Samples, ...]
    """Contacts of each leg's foot, with forces and points in the world."""
    base: Odometry
    """Poses of the base from the origin on, with heading 0; the height is that over the feet."""
    contact_from: Literal["joint_torques", "kinematics"]
    why_no_force: str
    """Empty where forces are known."""
    inertial: Inertial
    """How the base leans and turns."""


def estimate(
    recording: Recording,
    legs: Sequence[Leg],
    joints: JointTable,
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

    Raises:
        ValueError: a sentence: why they tell nothing.
    """
    motions = [leg_motion(leg, joints.of(leg.measured).position) for leg in legs]
    if stuck := stuck_joint(joints, legs):
        raise ValueError(stuck)
    feet = resting_feet(joints, motions, _inertial(recording, joints, mounting))
    if feet.inertial.turns_from == BY_FEET:
        feet = _turned_by_feet(feet)
    force, why = _forces(feet, mass_kg)
    standing = feet.resting
    if not why:
        standing = loaded_feet(feet.upwards(force), (mass_kg or 0.0) * GRAVITY_MPS2, feet)
    standing = np.stack([*map(partial(_debounced, joints), standing.T, feet.resting.T)], axis=1)
    moved = feet.odometry(standing)
    if why_not := _unsure(feet, standing, moved):
        raise ValueError(why_not)
    base = _poses(feet, standing, moved)
    placed = base
    if len(recording.base.log_time):
        poses = base_history(recording.base, TimeSource.HEADER)
        turned = from_roll_pitch_yaw(poses.angles_at(joints.samples.stamp))
        placed = replace(base, position=poses.position_at(joints.samples.stamp), orientation=turned)
    return Estimate(
        feet=tuple(
            _samples(foot, standing[:, foot], feet.points[:, foot], force[:, foot], placed)
            for foot in range(len(legs))
        ),
        base=base,
        contact_from="kinematics" if why else "joint_torques",
        why_no_force=why,
        inertial=feet.inertial,
    )


def _turned_by_feet(feet: FeetOnGround) -> FeetOnGround:
    """Tell which feet rest where the base turns as they tell: first the low ones, then these."""
    time, standing = feet.joints.samples.stamp, feet.low()
    between = time[:-1] + np.diff(time) // 2
    for _ in range(2):
        rates = bridged(feet.turn_by(standing), (between - time[0]) / 1e9)
        turn = means(between, rates, time, _TURNS_NS)
        feet = feet._replace(inertial=feet.inertial._replace(turn=turn))
        feet = at_rest(feet, feet.low())
        standing = feet.resting
    return feet


def _unsure(feet: FeetOnGround, standing: Flags, moved: LegOdometry) -> str:
    """Say why feet do not tell surely when they stand and how the base moves; empty: they do.

    Args:
        feet: with what tells how the base turns.
        standing: (n, f) which feet stand.
        moved: how the base moves by them.
    """
    steps = np.concatenate([np.diff(flagged_runs(each)[:, 0]) for each in standing.T])
    if len(steps) and (states := float(median_of(steps))) < FEWEST_IN_STRIDE:
        return f"joint states come {states:.3g} times in a stride, too rarely"
    turns = f"turns by {feet.inertial.turns_from}"
    if (agree := float((moved.feet > 0).mean())) < AGREES:
        return (
            f"standing feet agree on how the base moves in {agree:.0%} of the time only: positions "
            f"of joints are not exact enough, or not those of the robot description, or {turns} "
            "are not the base's in rad/s"
        )
    stepped = feet.turn_by(feet.low())[:, 2]
    known = np.isfinite(stepped)
    told, by_feet = (
        float(each[known].sum() / max(known.sum(), 1))
        for each in (feet.inertial.yaw_rate[1:], stepped)
    )
    if abs(told - by_feet) <= max(CONTRADICTS * max(abs(told), abs(by_feet)), LEAST_TURN_RADPS):
        return ""
    return (
        f"{turns}, {told:.2f} rad/s in the mean, and by the standing feet, {by_feet:.2f} rad/s, "
        "contradict each other"
    )


def _inertial(recording: Recording, joints: JointTable, mounting: Floats) -> Inertial:
    """Return how the base leans and turns by its inertial unit, if it has one.

    Args:
        recording: the columns of a log.
        joints: of the legs.
        mounting: of the inertial unit, as in `estimate`.
    """
    readings = recording.accelerations
    if readings is not None:
        read, times = readings.samples, readings.samples.stamp
        near = (times >= joints.samples.stamp[0] - LONG_NS) & (
            times <= joints.samples.stamp[-1] + LONG_NS
        )
        rows = np.flatnonzero(near & all_finite(read.vector) & all_finite(read.turn_rate))
        rows = rows[advancing(times[rows])]
        if len(rows) >= FEWEST:
            felt, turn = (rotate(mounting[None], e[rows]) for e in (read.vector, read.turn_rate))
            turn -= _bias(joints, times[rows], turn)
            return inertial_at(joints.samples.stamp, times[rows], felt, turn)
    return level(len(joints.samples.stamp))


def _bias(joints: JointTable, time: Ints, turn: Floats) -> Floats:
    """(3,) rad/s that a gyroscope reads while the robot stands, as far as it does.

    Args:
        joints: of the legs.
        time: (m,) ns, of the readings.
        turn: (m, 3) rad/s.
    """
    part, position = joints.samples.stamp // STILL_NS, joints.samples.position
    starts = np.flatnonzero(np.diff(part, prepend=part[0] - 1))
    moved = np.maximum.reduceat(position, starts) - np.minimum.reduceat(position, starts)
    still = np.isin(time // STILL_NS, part[starts][moved.max(axis=1) < STILL_RAD])
    bias = turn[still].mean(axis=0) if still.any() else np.zeros(3)
    return np.where(np.abs(bias) < LARGEST_BIAS_RADPS, bias, 0.0)


def _forces(feet: FeetOnGround, mass_kg: float | None) -> tuple[Floats, str]:
    """Return (n, f, 3) N along the base's axes; zeros, and why, where efforts tell none."""
    none, effort = np.zeros_like(feet.points), feet.joints.samples.effort
    if not (np.isfinite(effort).all() and effort.any()):
        return none, "efforts are empty or zero"
    force = ground_forces(feet)
    weight_n = None if mass_kg is None else mass_kg * GRAVITY_MPS2
    why = effort_fault(feet.upwards(force), weight_n)
    return (none if why else force), why


def _debounced(joints: JointTable, standing: Flags, resting: Flags) -> Flags:
    """(n,) when a foot stands, also while it bounces at touchdown."""
    swings = np.diff(joints.seconds[flagged_runs(~resting) - [0, 1]])
    bounce_s = min(BOUNCE * float(median_of(swings)), LONGEST_BOUNCE_S) if len(swings) else 0.0
    begin, end, _, _ = find_stances(joints.samples.stamp, standing, SHORTEST_S, bounce_s)
    return rows_in_stances(begin, end, standing)


def _poses(feet: FeetOnGround, standing: Flags, moved: LegOdometry) -> Odometry:
    """Return poses of the base from the origin on, with heading 0 and the height over the feet.

    Args:
        feet: which rest.
        standing: (n, f) which feet stand.
        moved: how the base moves by them.
    """
    joints, inertial = feet.joints, feet.inertial
    if inertial.tells_up:
        # An accelerometer bridges the ends of contacts better than feet do that land or leave.
        moved = feet.odometry(settled(joints.samples.stamp, standing))
    found = dead_reckoned(moved, inertial)
    position = found.position.copy()
    height = np.where(standing, -feet.upwards(feet.points), np.nan)
    position[:, 2] = bridged(mean_of_known(height)[:, None], joints.seconds)[:, 0]
    turned, rate = from_roll_pitch_yaw(found.angles), np.gradient(position, joints.seconds, axis=0)
    return Odometry(joints.samples.log_time, joints.samples.stamp, position, turned, rate)


def _samples(foot: int, standing: Flags, points: Floats, force: Floats, base: Odometry) -> Samples:
    """Return contact samples, with forces and points in the world."""
    count, there = len(standing), standing[:, None]
    place = np.where(there, base.position + rotate(base.orientation, points), np.nan)
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
