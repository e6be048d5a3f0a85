"""Checks of the base's accelerometer, and of what it says of the feet's forces."""

from collections.abc import Iterator

import numpy as np

from dogbot_logtool.core.imu.forces import ForceComparison
from dogbot_logtool.core.imu.mounting import Reading
from dogbot_logtool.core.load.load_figures import WEIGHT_TOLERANCE
from dogbot_logtool.core.load.loads import GRAVITY_MPS2
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.finding import Finding


def scale(stats: Stats) -> Iterator[Finding]:
    """Yield what the accelerometer reads instead of gravity."""
    if stats.imu is None:
        return
    topic, seat = stats.imu.sensed.topic, stats.imu.mounting
    over = (
        f"{topic} reads {seat.mean_mps2:.3g} over whole strides, where {GRAVITY_MPS2:g} m/s^2 "
        "are expected"
    )
    match seat.reading:
        case Reading.NOTHING:
            text = f"all accelerations of {topic} are zero"
            yield Finding("IMU_READS", text, topic, cases=("undecided",))
        case Reading.IN_G:
            yield Finding("IMU_READS", f"{over}: it reads in g", topic)
        case Reading.WITHOUT_GRAVITY:
            text = f"{over}: gravity is taken out of its accelerations"
            yield Finding("IMU_READS", text, topic)
        case Reading.OTHER_SCALE:
            text = f"{over}: its scale is off by a factor of {seat.scale:.3g}"
            yield Finding("IMU_READS", text, topic)
        case None:
            text = (
                f"{topic} does not follow gravity as the base's attitude has it: nothing is "
                "concluded from it"
            )
            yield Finding("IMU_READS", text, topic, cases=("undecided",))
        case Reading.SOUND:
            pass


def mounting(stats: Stats) -> Iterator[Finding]:
    """Yield that the accelerometer is tilted, or turned about the vertical."""
    imu = stats.imu
    if imu is None:
        return
    topic, seat = imu.sensed.topic, imu.mounting
    if seat.is_tilted and seat.tilt_rad is not None and seat.roll_pitch_rad is not None:
        roll, pitch = np.degrees(seat.roll_pitch_rad)
        said = "the recorded transforms have it" if imu.mounting_recorded else "the base is"
        text = (
            f"{topic} is turned by {np.degrees(seat.tilt_rad):.1f} degrees against how {said}, "
            f"{roll:+.1f} about the base's x and {pitch:+.1f} about its y axis (or the base's "
            "attitude is off by as much); it is levelled for all comparisons"
        )
        yield Finding("IMU_TURNED", text, "imu.tilt_rad")
    if imu.turn is not None and imu.turn.is_turned:
        angle = np.degrees(imu.turn.angle_rad)
        text = (
            f"horizontal accelerations of {topic} are those of the base's poses turned by "
            f"{angle:+.0f} degrees about the vertical: its mounting is turned, or the base's yaw"
        )
        yield Finding("IMU_TURNED", text, topic)


def forces_turned(stats: Stats) -> Iterator[Finding]:
    """Yield that the horizontal forces are in another frame."""
    forces = stats.imu.forces if stats.imu else None
    if forces is not None and forces.turn is not None and forces.turn.is_turned:
        angle = np.degrees(forces.turn.angle_rad)
        text = (
            "horizontal forces over the mass are the base's acceleration turned by "
            f"{angle:+.0f} degrees about the vertical: they are in another frame"
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
    scales = forces.scales
    if dead and forces.ratio < 1.0:
        text = f"{says}, and {' and '.join(dead)} never touches: its load is missing"
        return Finding("IMPULSE_IS_NOT_WEIGHT", text, f"feet.{dead[0]}", cases=("accelerometer",))
    if forces.ratio < 1.0 and abs(forces.magnitude_ratio - 1.0) <= WEIGHT_TOLERANCE:
        text = f"{says}, but their magnitudes are {forces.magnitude_ratio:.2f} of it: they lean"
        return Finding("DIRECTION_UNKNOWN", text, "settings.wrench_frame", cases=("accelerometer",))
    if scales is not None and scales.odd is not None:
        foot = stats.feet[scales.odd].name
        factor = scales.feet[scales.odd] or 1.0
        text = (
            f"{says}: what is missing or too much comes and goes with the load on {foot}, whose "
            f"sensor reads {1.0 / factor:.2f} of its load, and the others theirs"
        )
        return Finding("FOOT_SCALE", text, f"feet.{foot}", feet=(foot,))
    if scales is not None and scales.is_common:
        mass = stats.settings.mass_kg or 0.0
        origin = "assumed for the guessed robot" if stats.settings.mass_is_assumed else "given"
        text = (
            f"{says}, whichever feet carry the robot: the mass {origin}, {mass:.4g} kg, should be "
            f"{mass * forces.ratio:.4g} kg, or all sensors are off alike"
        )
        return Finding("IMPULSE_IS_NOT_WEIGHT", text, "settings.mass_kg", cases=("accelerometer",))
    text = f"{says}; which of mass and sensors is wrong cannot be told"
    return Finding("IMPULSE_IS_NOT_WEIGHT", text, where, cases=("accelerometer",))
