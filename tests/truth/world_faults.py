"""What odometry does to the world: another origin, drift, jumps, noise."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from tests.truth.recording import (
    Disturbance,
    Floats,
    Recording,
    about_axis,
    inverse,
    product,
    turned,
)
from tests.truth.robots import GRAVITY_MPS2


def _moved(recording: Recording, by: Floats) -> Recording:
    base = recording.base
    return replace(recording, base=replace(base, position=base.position + by))


def displaced(metres: Sequence[float]) -> Disturbance:
    """Let the odometry count from another place than the contact points."""
    return lambda recording: _moved(recording, np.array(metres, np.float64))


def base_from_zero(recording: Recording) -> Recording:
    """Let the odometry begin at the origin, wherever the base is."""
    return _moved(recording, -recording.base.position[0])


def drifting(metres_per_metre: float) -> Disturbance:
    """Let the odometry overrate the way by a part of it, sideways."""

    def change(recording: Recording) -> Recording:
        position = recording.base.position
        way = np.linalg.norm(position - position[0], axis=1)
        return _moved(recording, np.outer(way * metres_per_metre, (0.0, 1.0, 0.0)))

    return change


def rising(metres_per_second: float) -> Disturbance:
    """Let z of the odometry drift."""
    return lambda recording: _moved(
        recording, np.outer(recording.base.time * metres_per_second, (0.0, 0.0, 1.0))
    )


def leaning(at_s: float, metres: Sequence[float]) -> Disturbance:
    """Let the body lean elsewhere over its feet from some moment on, within a second."""

    def change(recording: Recording) -> Recording:
        part = np.clip(recording.base.time - at_s, 0.0, 1.0)
        return _moved(recording, np.outer(part * part * (3.0 - 2.0 * part), metres))

    return change


def jump(at_s: float, metres: Sequence[float]) -> Disturbance:
    """Let a localisation move the base at once."""
    return lambda recording: _moved(
        recording,
        np.outer(np.where(recording.base.time >= at_s, 1.0, 0.0), np.array(metres, np.float64)),
    )


def reset_height(at_s: float) -> Disturbance:
    """Let the odometry count z from the base's height on."""
    return lambda recording: jump(at_s, (0.0, 0.0, -float(recording.base.position[0, 2])))(
        recording
    )


def pose_noise(std_m: float, seed: int = 0) -> Disturbance:
    """Add white noise to the base's position."""

    def change(recording: Recording) -> Recording:
        random = np.random.default_rng(seed)
        return _moved(recording, random.normal(0.0, std_m, recording.base.position.shape))

    return change


def driven(recording: Recording) -> Recording:
    """Let the base go up and down as the feet's vertical forces drive it."""
    time = np.arange(0.0, recording.seconds, 0.001)
    force = sum(np.interp(time, foot.time, foot.force[:, 2]) for foot in recording.feet)
    excess = force / recording.robot.mass_kg - GRAVITY_MPS2
    speed = np.cumsum(excess) * 0.001
    way = np.cumsum(speed - np.polyval(np.polyfit(time, speed, 1), time)) * 0.001
    heave = way - np.polyval(np.polyfit(time, way, 1), time)
    above = np.interp(recording.base.time, time, heave)
    return _moved(recording, np.outer(above, (0.0, 0.0, 1.0)))


def restamped(seconds: float) -> Disturbance:
    """Let a recorder stamp the odometry anew, late: by stamps and log times alike."""
    late = round(seconds * 1e9)

    def change(recording: Recording) -> Recording:
        base = recording.base
        return replace(
            recording, base=replace(base, stamp=base.stamp + late, log_time=base.log_time + late)
        )

    return change


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


def y_up(*, body: bool) -> Disturbance:
    """Let motion capture count in a world whose y is up, and x forward.

    Args:
        body: whether the body's y is up, too, as that of a rigid body that was defined in it.
    """

    def change(recording: Recording) -> Recording:
        base = recording.base
        turn = about_axis(0, np.full(len(base.time), -np.pi / 2.0))
        orientation = product(turn, base.orientation)
        moved = replace(
            base,
            position=turned(turn, base.position),
            orientation=product(orientation, inverse(turn)) if body else orientation,
            velocity=turned(turn, base.velocity),
        )
        return replace(recording, base=moved)

    return change
