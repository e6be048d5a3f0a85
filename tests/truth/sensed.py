"""What an inertial unit of the base reads."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from tests.truth.geometry import Floats, inverse, product, turned
from tests.truth.recording import Disturbance, FootRecording, Recording, VectorRecording
from tests.truth.robots import GRAVITY_MPS2

G = GRAVITY_MPS2
STRAIGHT = np.array([0.0, 0.0, 0.0, 1.0])


def with_imu(
    *,
    mounting: Floats = STRAIGHT,
    unit_mps2: float = 1.0,
    without_mps2: float = 0.0,
    noise_mps2: float = 0.0,
    frame: str = "base_link",
    gyroscope: bool = False,
) -> Disturbance:
    """Add the inertial unit of a robot whose feet feel all that moves it, while its poses are true.

    Forces must be in the world, at the times of the base's poses or more often.

    Args:
        mounting: (4,) the unit's frame in the base's.
        unit_mps2: what it reads as 1.
        without_mps2: gravity that it takes out.
        noise_mps2: standard deviation of white noise on each axis.
        frame: in its headers.
        gyroscope: whether it tells turns, too.
    """

    def change(recording: Recording) -> Recording:
        base = recording.base
        world = acceleration(recording, base.time)
        world[:, 2] -= without_mps2
        seats = product(base.orientation, np.tile(mounting, (len(base.time), 1)))
        sensed = turned(inverse(seats), world) / unit_mps2
        if gyroscope:
            # Of small turns, the vector part is half of the turn.
            half = product(inverse(seats[:-1]), seats[1:])[:, :3]
            rate = 2.0 * half / np.diff(base.time)[:, None]
            sensed = np.concatenate([sensed, np.concatenate([rate, rate[-1:]])], axis=1)
        sensed = sensed + np.random.default_rng(1).normal(0.0, noise_mps2, sensed.shape)
        imu = VectorRecording.sent(base.time, "/imu/data", "imu", sensed, frame)
        truth = recording.truth.but(accelerometer_mps2=G, forces_over_accelerometer=1.0)
        return replace(recording, beside=(*recording.beside, imu), truth=truth)

    return change


def reading(vectors: Callable[[Floats], Floats]) -> Disturbance:
    """Let the unit read something else."""

    def change(recording: Recording) -> Recording:
        (imu,) = recording.beside
        return replace(recording, beside=(replace(imu, vector=vectors(imu.vector)),))

    return change


def acceleration(recording: Recording, time: Floats) -> Floats:
    """(n, 3) m/s^2, the specific force of the robot in the world."""
    total = np.zeros((len(time), 3))
    for foot in recording.feet:
        for axis in range(3):
            total[:, axis] += np.interp(time, foot.time, foot.force[:, axis])
    return total / recording.robot.mass_kg


def pushed(size_mps2: tuple[float, float, float], period_s: float) -> Disturbance:
    """Let a robot accelerate to and fro as a sine, by forces of its feet.

    The base goes where that brings it; each foot bears its share of the load.
    """
    size, turn = np.array(size_mps2), 2.0 * np.pi / period_s

    def change(recording: Recording) -> Recording:
        mass, base = recording.robot.mass_kg, recording.base

        def push(_: int, foot: FootRecording) -> FootRecording:
            total = acceleration(recording, foot.time)[:, 2] * mass
            none = np.zeros_like(total)
            share = np.divide(foot.force[:, 2], total, out=none, where=total > 1e-6 * mass)
            extra = mass * np.outer(np.sin(turn * foot.time), size)
            return replace(foot, force=foot.force + share[:, None] * extra)

        way = np.outer(base.time / turn - np.sin(turn * base.time) / turn**2, size)
        speed = np.outer(1.0 - np.cos(turn * base.time), size) / turn
        moved = replace(base, position=base.position + way, velocity=base.velocity + speed)
        # Feet do not say where they are: they would have to go with the base.
        return replace(recording.each_foot(push), base=moved, kind="wrench")

    return change
