"""What odometry does to the world: another origin, drift, jumps, noise."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from tests.truth.recording import (
    BaseRecording,
    Disturbance,
    Floats,
    FootRecording,
    Recording,
    about_axis,
    inverse,
    of_base,
    product,
    turned,
)
from tests.truth.robots import GRAVITY_MPS2


@of_base
def displaced(base: BaseRecording, metres: Sequence[float]) -> BaseRecording:
    """Let the odometry count from another place than the contact points."""
    return _moved(base, np.array(metres, np.float64))


def _moved(base: BaseRecording, by: Floats) -> BaseRecording:
    return replace(base, position=base.position + by)


@of_base
def from_zero(base: BaseRecording) -> BaseRecording:
    """Let the odometry begin at the origin, wherever the base is."""
    return _moved(base, -base.position[0])


def points_drifting(share: float) -> Disturbance:
    """Let contact points be placed by another odometry, which drifts by a share of the way."""

    def change(recording: Recording) -> Recording:
        base = recording.base

        def moved(_: int, foot: FootRecording) -> FootRecording:
            at = [np.interp(foot.time, base.time, axis) for axis in base.position[:, :2].T]
            way = np.stack([*at, np.zeros(len(foot.time))], axis=1)
            return replace(foot, point=foot.point + share * way)

        return recording.each_foot(moved)

    return change


@of_base
def drifting(base: BaseRecording, metres_per_metre: float) -> BaseRecording:
    """Let the odometry overrate the way by a part of it, sideways."""
    way = np.linalg.norm(base.position - base.position[0], axis=1)
    return _moved(base, np.outer(way * metres_per_metre, (0.0, 1.0, 0.0)))


@of_base
def rising(base: BaseRecording, metres_per_second: float) -> BaseRecording:
    """Let z of the odometry drift."""
    return _moved(base, np.outer(base.time * metres_per_second, (0.0, 0.0, 1.0)))


@of_base
def leaning(base: BaseRecording, at_s: float, metres: Sequence[float]) -> BaseRecording:
    """Let the body lean elsewhere over its feet from some moment on, within a second."""
    part = np.clip(base.time - at_s, 0.0, 1.0)
    return _moved(base, np.outer(part * part * (3.0 - 2.0 * part), metres))


@of_base
def jump(base: BaseRecording, at_s: float, metres: Sequence[float]) -> BaseRecording:
    """Let a localisation move the base at once."""
    return _moved(base, np.outer(base.time >= at_s, metres))


@of_base
def reset_height(base: BaseRecording, at_s: float) -> BaseRecording:
    """Let the odometry count z from the base's height on."""
    return _moved(base, np.outer(base.time >= at_s, (0.0, 0.0, -base.position[0, 2])))


@of_base
def pose_noise(base: BaseRecording, std_m: float) -> BaseRecording:
    """Add white noise to the base's position."""
    return _moved(base, np.random.default_rng(0).normal(0.0, std_m, base.position.shape))


def driven(recording: Recording) -> Recording:
    """Let the base go up and down as the feet's vertical forces drive it."""
    time = np.arange(0.0, recording.seconds, 0.001)
    force = sum(np.interp(time, foot.time, foot.force[:, 2]) for foot in recording.feet)
    excess = force / recording.robot.mass_kg - GRAVITY_MPS2
    speed = np.cumsum(excess) * 0.001
    way = np.cumsum(speed - np.polyval(np.polyfit(time, speed, 1), time)) * 0.001
    heave = way - np.polyval(np.polyfit(time, way, 1), time)
    above = np.interp(recording.base.time, time, heave)
    base = _moved(recording.base, np.outer(above, (0.0, 0.0, 1.0)))
    return replace(recording, base=base)


@of_base
def restamped(base: BaseRecording, seconds: float) -> BaseRecording:
    """Let a recorder stamp the odometry anew, late: by stamps and log times alike."""
    late = round(seconds * 1e9)
    return replace(base, stamp=base.stamp + late, log_time=base.log_time + late)


def z_down(recording: Recording) -> Recording:
    """Let base, contact points and forces be in a world with z down and y to the right."""
    flip, turn = np.array([1.0, -1.0, -1.0]), np.array([1.0, -1.0, -1.0, 1.0])
    base = recording.base
    turned_base = replace(
        base,
        position=base.position * flip,
        orientation=base.orientation * turn,
        velocity=base.velocity * flip,
    )
    return replace(recording, base=turned_base).each_foot(
        lambda _, foot: replace(
            foot, force=foot.force * flip, point=foot.point * flip, normal=foot.normal * flip
        )
    )


def swapped(first: str, second: str) -> Disturbance:
    """Let two feet's sensors speak on each other's topics."""

    def change(recording: Recording) -> Recording:
        rows = [recording.robot.feet.index(name) for name in (first, second)]
        feet = list(recording.feet)
        feet[rows[0]], feet[rows[1]] = feet[rows[1]], feet[rows[0]]
        return replace(recording, feet=tuple(feet))

    return change


@of_base
def y_up(base: BaseRecording, *, body: bool) -> BaseRecording:
    """Let motion capture count in a world whose y is up, and x forward.

    Args:
        base: its poses.
        body: whether the body's y is up, too, as that of a rigid body that was defined in it.
    """
    turn = about_axis(0, np.full(len(base.time), -np.pi / 2.0))
    orientation = product(turn, base.orientation)
    return replace(
        base,
        position=turned(turn, base.position),
        orientation=product(orientation, inverse(turn)) if body else orientation,
        velocity=turned(turn, base.velocity),
    )
