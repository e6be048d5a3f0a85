"""Figures of the base's accelerometer against the feet's forces and the base's poses."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

from dogbot_logtool.report.figures.figure import Figure, Kind, Member, Scope

# Loaded for logs with an accelerometer.
if TYPE_CHECKING:
    from dogbot_logtool.core.imu.comparison import ImuComparison
    from dogbot_logtool.core.imu.forces import ForceComparison

_FORCES: "Final[Sequence[Figure[ForceComparison]]]" = (
    Figure(
        "over_accelerometer",
        Kind.NUMBER,
        lambda forces: forces.ratio,
        "mean sum of the feet's vertical forces over the mass, over the vertical specific force, "
        "levelled and in m/s^2: 1 in a sound recording; over windows inside of whole strides in "
        "which all feet, accelerometer and poses are known",
    ),
)
_IMU: "Final[Sequence[Figure[ImuComparison]]]" = (
    Figure("topic", Kind.TEXT, lambda imu: imu.sensed.topic, "topic of the accelerometer"),
    Figure(
        "known_s",
        Kind.AMOUNT,
        lambda imu: imu.known_s,
        "time with accelerometer and poses: all means are over a stride (0.5 s without strides) "
        "about 25 instants a second in it",
    ),
    Figure(
        "accelerometer_mps2",
        Kind.AMOUNT,
        lambda imu: imu.imu_mps2,
        "length of its mean specific force in the base's frame, as recorded: g, whatever the robot "
        "weighs",
    ),
    Figure(
        "tilt_rad",
        Kind.AMOUNT,
        lambda imu: imu.mounting.tilt_rad,
        "angle of its mean specific force against what attitude, gravity and poses expect",
        null="it reads no gravity, or does not follow it",
    ),
)
IMU: Final[Sequence[Member]] = (
    *_IMU,
    Scope(
        "forces",
        _FORCES,
        lambda imu: imu.forces,
        "the feet's forces against it",
        null="no strides (a robot may rest on its body), no mass, vertical forces are not known, "
        "what it reads is not known or of another "
        "scale, or less than 2 s in common",
    ),
)
"""Figures of an `ImuComparison`."""
