"""Checks of the base's accelerometer, and of what it says of the feet's forces."""

from collections.abc import Iterator

import numpy as np

from dogbot_logtool.core.checks.loads import origin_of_mass
from dogbot_logtool.core.imu import ForceComparison, Reading
from dogbot_logtool.core.loads import WEIGHT_TOLERANCE
from dogbot_logtool.core.settings import GRAVITY_MPS2
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.finding import Finding, found


def mounting(walk: Walk) -> Iterator[Finding]:
    """Yield what the accelerometer reads instead of gravity, and how it is turned."""
    imu = walk.imu
    if imu is None:
        return
    seat, topic = imu.mounting, imu.topic
    if seat.reading is not Reading.SOUND:
        cases = ("undecided",) if seat.reading in {Reading.NOTHING, Reading.UNCLEAR} else ()
        yield found(
            "IMU_READS",
            *cases,
            say=seat.reading,
            topic=topic,
            mean=seat.mean_mps2,
            scale=seat.scale,
            expected=GRAVITY_MPS2,
        )
    if seat.is_tilted:
        tilt, roll, pitch = np.degrees([seat.tilt_rad or 0.0, *seat.roll_pitch_rad]).tolist()
        said = "the recorded transforms have it" if imu.mounting_recorded else "the base is"
        yield found(
            "IMU_TURNED",
            where="imu.tilt_rad",
            say="tilted",
            topic=topic,
            said=said,
            tilt=tilt,
            roll=roll,
            pitch=pitch,
        )
    if imu.turned_rad is not None:
        yield found("IMU_TURNED", topic=topic, degrees=np.degrees(imu.turned_rad))


def forces(walk: Walk) -> Iterator[Finding]:
    """Yield that sensors' forces are not what the accelerometer and the poses say."""
    found_forces = walk.imu.forces if walk.imu else None
    if found_forces is None or walk.settings.contact_from:
        return
    if abs(found_forces.ratio - 1.0) > WEIGHT_TOLERANCE:
        yield _odd_forces(walk, found_forces)
    if found_forces.turned_rad is not None:
        where, degrees = "settings.wrench_frame", np.degrees(found_forces.turned_rad)
        yield found(
            "DIRECTION_UNKNOWN", "accelerometer", where=where, say="turned", degrees=degrees
        )


def _odd_forces(walk: Walk, forces: ForceComparison) -> Finding:
    """Return which of mass, feet and frame is wrong, as far as it can be told."""
    case, code = "accelerometer", "IMPULSE_IS_NOT_WEIGHT"
    says = f"vertical forces over the mass are {forces.ratio:.2f} of what the accelerometer says"
    dead = [foot.name for foot in walk.feet if foot.is_dead]
    if dead and forces.ratio < 1.0:
        feet = " and ".join(dead)
        return found(code, case, where=f"feet.{dead[0]}", say="missing", says=says, names=feet)
    if forces.ratio < 1.0 and abs(forces.magnitude_ratio - 1.0) <= WEIGHT_TOLERANCE:
        ratio = forces.magnitude_ratio
        return found(
            "DIRECTION_UNKNOWN", case, where="settings.wrench_frame", says=says, ratio=ratio
        )
    if forces.odd_foot is not None:
        number, factor = forces.odd_foot
        foot = walk.feet[number].name
        return found("FOOT_SCALE", feet=(foot,), says=says, share=1.0 / factor)
    if forces.is_common:
        where, mass, origin = (
            "settings.mass_kg",
            walk.settings.mass_kg or 0.0,
            origin_of_mass(walk),
        )
        right = mass * forces.ratio
        return found(
            code, case, where=where, say="mass", says=says, mass=mass, right=right, origin=origin
        )
    return found(code, case, where="imu.forces.over_accelerometer", says=says)
