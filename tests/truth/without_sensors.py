"""Logs of robots without foot sensors: joint states, an inertial unit and a robot description."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from tests.truth import physics
from tests.truth.parts import Part
from tests.truth.physics import Physics
from tests.truth.recording import inverse, turned
from tests.truth.robots import GRAVITY_MPS2


def resized(walk: Physics, size: float) -> Physics:
    """Return what a robot of the same kind does whose lengths are so many times as large."""
    pace = float(np.sqrt(size))

    def part(of: Part) -> Part:
        x, y, z = (size * each for each in of.at)
        sizes = tuple(size * each for each in of.size)
        heavy, centre_m = of.kg * size**3, of.centre_m * size
        return replace(of, at=(x, y, z), size=sizes, kg=heavy, centre_m=centre_m)

    return replace(
        walk,
        mass_kg=walk.mass_kg * size**3,
        time=walk.time * pace,
        base=walk.base * size,
        base_velocity=walk.base_velocity * np.repeat([1.0 / pace, pace], 3),
        velocity=walk.velocity / pace,
        torque=walk.torque * size**4,
        foot=walk.foot * size,
        foot_velocity=walk.foot_velocity * pace,
        calf=walk.calf * np.repeat([size, 1.0], (3, 4)),
        force=walk.force * size**3,
        point=walk.point * size,
        parts=tuple(map(part, walk.parts)),
    )


def write_log(
    path: Path,
    walk: Physics,
    *,
    with_imu: bool = True,
    imu_frame: str = "base_link",
    gyro: float = 1.0,
    every: int = 5,
) -> Path:
    """Write what a robot without foot sensors and odometry records.

    Args:
        path: of the log.
        walk: what it did.
        with_imu: whether there is an inertial unit.
        imu_frame: that of the base, or one that is turned by 90 degrees about its x axis.
        gyro: what a gyroscope reads for a turn rate of 1 rad/s.
        every: rows of the walk, 500 a second, between messages.
    """
    back = inverse(walk.attitude)
    moved = np.gradient(walk.base_velocity[:, 3:], walk.time, axis=0)
    moved[:, 2] += GRAVITY_MPS2
    read = [turned(back, moved), gyro * turned(back, walk.base_velocity[:, :3])]
    if imu_frame != "base_link":
        read = [each[:, [0, 2, 1]] * [1.0, 1.0, -1.0] for each in read]
    imu = (imu_frame, np.concatenate(read, axis=1)) if with_imu else None
    return physics.write_log(
        path,
        walk,
        by_transforms=False,
        every=every,
        with_feet=False,
        with_poses=False,
        imu=imu,
    )
