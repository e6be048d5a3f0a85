"""Checks of the base's accelerometer, and of what it says of the feet's forces."""

from collections.abc import Iterator, Mapping
from typing import Final

import numpy as np

from dogbot_logtool.core.imu import ForceComparison, Reading
from dogbot_logtool.core.loads import WEIGHT_TOLERANCE
from dogbot_logtool.core.settings import GRAVITY_MPS2
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.finding import Finding

_OVER: Final = (
    "{topic} reads {mean:.3g} over whole strides, where " + f"{GRAVITY_MPS2:g} m/s^2 are expected: "
)
_READS: Final[Mapping[Reading, str]] = {
    Reading.NOTHING: "all accelerations of {topic} are zero",
    Reading.IN_G: _OVER + "it reads in g",
    Reading.WITHOUT_GRAVITY: _OVER + "gravity is taken out of its accelerations",
    Reading.OTHER_SCALE: _OVER + "its scale is off by a factor of {scale:.3g}",
    Reading.UNCLEAR: (
        "{topic} does not follow gravity as the base's attitude has it: nothing is concluded from "
        "it"
    ),
}
"""What is said of an accelerometer that does not read g."""


def scale(stats: Stats) -> Iterator[Finding]:
    """Yield what the accelerometer reads instead of gravity."""
    imu = stats.imu
    if imu is not None and imu.mounting.reading in _READS:
        seat = imu.mounting
        values = {"topic": imu.topic, "mean": seat.mean_mps2, "scale": seat.scale}
        undecided = seat.reading in {Reading.NOTHING, Reading.UNCLEAR}
        text = _READS[seat.reading].format(**values)
        yield Finding("IMU_READS", text, imu.topic, cases=("undecided",) if undecided else ())


def mounting(stats: Stats) -> Iterator[Finding]:
    """Yield that the accelerometer is tilted, or turned about the vertical."""
    imu = stats.imu
    if imu is None:
        return
    seat = imu.mounting
    if seat.is_tilted:
        tilt, roll, pitch = np.degrees([seat.tilt_rad or 0.0, *seat.roll_pitch_rad])
        said = "the recorded transforms have it" if imu.mounting_recorded else "the base is"
        text = (
            f"{imu.topic} is turned by {tilt:.1f} degrees against how {said}, "
            f"{roll:+.1f} about the base's x and {pitch:+.1f} about its y axis (or the base's "
            "attitude is off by as much); it is levelled for all comparisons"
        )
        yield Finding("IMU_TURNED", text, "imu.tilt_rad")
    if imu.turned_rad is not None:
        text = (
            f"horizontal accelerations of {imu.topic} are those of the base's poses turned by "
            f"{np.degrees(imu.turned_rad):+.0f} degrees about the vertical: its mounting is "
            "turned, or the base's yaw"
        )
        yield Finding("IMU_TURNED", text, imu.topic)


def forces_turned(stats: Stats) -> Iterator[Finding]:
    """Yield that the horizontal forces are in another frame."""
    forces = stats.imu.forces if stats.imu else None
    if forces is not None and forces.turned_rad is not None:
        text = (
            "horizontal forces over the mass are the base's acceleration turned by "
            f"{np.degrees(forces.turned_rad):+.0f} degrees about the vertical: they are in "
            "another frame"
        )
        yield Finding("DIRECTION_UNKNOWN", text, "settings.wrench_frame", cases=("accelerometer",))


def forces_odd(stats: Stats) -> Iterator[Finding]:
    """Yield that vertical forces are not what the accelerometer says."""
    forces = stats.imu.forces if stats.imu else None
    if forces is not None and abs(forces.ratio - 1.0) > WEIGHT_TOLERANCE:
        yield _odd_forces(stats, forces)


def _odd_forces(stats: Stats, forces: ForceComparison) -> Finding:
    """Return which of mass, feet and frame is wrong, as far as it can be told."""
    where = "imu.forces.over_accelerometer"
    says = f"vertical forces over the mass are {forces.ratio:.2f} of what the accelerometer says"
    dead = [foot.name for foot in stats.feet if foot.is_dead]
    if dead and forces.ratio < 1.0:
        text = f"{says}, and {' and '.join(dead)} never touches: its load is missing"
        return Finding("IMPULSE_IS_NOT_WEIGHT", text, f"feet.{dead[0]}", cases=("accelerometer",))
    if forces.ratio < 1.0 and abs(forces.magnitude_ratio - 1.0) <= WEIGHT_TOLERANCE:
        text = f"{says}, but their magnitudes are {forces.magnitude_ratio:.2f} of it: they lean"
        return Finding("DIRECTION_UNKNOWN", text, "settings.wrench_frame", cases=("accelerometer",))
    if forces.odd_foot is not None:
        number, factor = forces.odd_foot
        foot = stats.feet[number].name
        text = (
            f"{says}: what is missing or too much comes and goes with the load on {foot}, whose "
            f"sensor reads {1.0 / factor:.2f} of its load, and the others theirs"
        )
        return Finding("FOOT_SCALE", text, f"feet.{foot}", feet=(foot,))
    if forces.is_common:
        mass = stats.settings.mass_kg or 0.0
        origin = "assumed for the guessed robot" if stats.settings.mass_is_assumed else "given"
        text = (
            f"{says}, whichever feet carry the robot: the mass {origin}, {mass:.4g} kg, should be "
            f"{mass * forces.ratio:.4g} kg, or all sensors are off alike"
        )
        return Finding("IMPULSE_IS_NOT_WEIGHT", text, "settings.mass_kg", cases=("accelerometer",))
    text = f"{says}; which of mass and sensors is wrong cannot be told"
    return Finding("IMPULSE_IS_NOT_WEIGHT", text, where, cases=("accelerometer",))
