"""Poses of the base, and the transforms made of them."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import (
    Flags,
    Floats,
    Ints,
    all_finite,
    concatenated,
    header_time,
    picked,
)
from dogbot_logtool.dataclass import dataclass

LARGEST_LAG_NS: Final = 100_000_000
"""ns: stamps further behind log time are of another clock."""


@dataclass(frozen=True, slots=True)
class Odometry:
    """Messages that give the pose of the robot's base, in the order of the log."""

    log_time: Ints
    """(n,) ns, when each was recorded."""
    stamp: Ints
    """(n,) ns, header stamp as recorded; 0 where the source never set one."""
    position: Floats
    """(n, 3) m, base origin in the world frame."""
    orientation: Floats
    """(n, 4) quaternion x, y, z, w, base in the world frame, as recorded (any norm)."""
    linear_velocity: Floats
    """(n, 3) m/s. World or body frame: sources differ, so never trust it blindly."""
    angular_velocity: Floats
    """(n, 3) rad/s, same caution."""

    @property
    def time(self) -> Ints:
        """(n,) ns, header stamp, or log time where the stamp is zero."""
        return header_time(self.stamp, self.log_time)

    def pick(self, rows: Flags | Ints) -> "Odometry":
        """Return the chosen rows (a mask or row numbers)."""
        return picked(self, rows)


def no_odometry() -> Odometry:
    """Return none."""
    times: Ints = np.empty(0, np.int64)
    vectors, quaternions = np.empty((0, 3)), np.empty((0, 4))
    return Odometry(times, times, vectors, quaternions, vectors, vectors)


def concatenate_odometry(parts: Sequence[Odometry]) -> Odometry:
    """Join messages of several senders, in the order of their log times."""
    if len(parts) == 1:
        return parts[0]
    if not parts:
        return no_odometry()
    joined = concatenated(parts)
    return joined.pick(np.argsort(joined.log_time, kind="stable"))


@dataclass(frozen=True, slots=True)
class Transforms:
    """Poses of one frame in its parent frame."""

    log_time: Ints
    """(n,) ns."""
    stamp: Ints
    """(n,) ns, the time at which the pose holds."""
    translation: Floats
    """(n, 3) m, in the parent frame."""
    rotation: Floats
    """(n, 4) quaternion x, y, z, w."""


def usable_poses(odometry: Odometry) -> Flags:
    """Tell which poses can be a transform: all numbers finite and the quaternion not zero.

    Returns:
        (n,) bool.
    """
    finite = all_finite(odometry.position)
    finite &= all_finite(odometry.orientation)
    turned: Flags = (odometry.orientation != 0.0).any(axis=1)
    return finite & turned


def base_transforms(odometry: Odometry) -> Transforms:
    """Turn poses into transforms of the base in the world, verbatim: nothing is normalised."""
    return Transforms(odometry.log_time, odometry.time, odometry.position, odometry.orientation)


def from_opening(transforms: Transforms, opening: int) -> Transforms:
    """Return transforms of which the first also stands at the log's first time.

    Its stamp is that time, too, unless the clock of the stamps is another one: a stamp from the
    future of the others would hold for ever.

    Args:
        transforms: the first of a log.
        opening: ns, log time.
    """
    if not len(transforms.stamp):
        return transforms
    first = int(transforms.stamp[0])
    if int(transforms.log_time[0]) <= opening and first <= opening:
        return transforms
    stamp = opening if first > opening - LARGEST_LAG_NS else first
    return Transforms(
        log_time=np.concatenate([[opening], transforms.log_time]),
        stamp=np.concatenate([[stamp], transforms.stamp]),
        translation=np.concatenate([transforms.translation[:1], transforms.translation]),
        rotation=np.concatenate([transforms.rotation[:1], transforms.rotation]),
    )
