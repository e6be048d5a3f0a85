"""Logs with an accelerometer: its scale, its mounting, and the forces that it is compared with."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Final

import numpy as np

from tests.truth import gaits
from tests.truth import sensor_faults as sensor
from tests.truth.case import Case
from tests.truth.geometry import Floats, about_axis, product
from tests.truth.recording import changed, on
from tests.truth.sensed import G, pushed, reading, with_imu
from tests.truth.walking import Walk

STEPS: Final = Walk(gait=gaits.WALK, seconds=12.0)
TROT: Final = Walk(seconds=12.0)
ABOUT_UP: Final = about_axis(2, np.array([np.pi / 2.0]))[0]
UPSIDE_DOWN: Final = product(about_axis(0, np.array([np.pi])), about_axis(2, np.array([0.8])))[0]
LEANS, ABOUT_X, ABOUT_Y = (
    about_axis(axis, np.radians([degrees]))[0]
    for axis, degrees in ((0, 29.0), (0, -20.0), (1, -20.0))
)
IN_WORLD: Final = sensor.user_gives(set={"wrench_frame": "world"})


def wandering(vector: Floats) -> Floats:
    """(n, 3) m/s^2 of a unit that knows little of gravity."""
    noise = np.random.default_rng(2).normal(0.0, 9.0, (12, 3))
    time = np.linspace(0.0, 12.0, len(vector))
    wanders = np.stack([np.interp(time, np.arange(12), column) for column in noise.T], axis=1)
    return np.asarray(wanders + np.array([0.0, 0.0, G]))


# fmt: off
def sound() -> Iterator[Case]:
    """Accelerometers."""
    ways = "speed, path, stride length, braking"
    to_and_fro, up_and_down = pushed((0.6, 0.3, 0.0), 5.0), pushed((0.0, 0.0, 0.8), 5.0)
    told = changed(statics=(("imu_link", (0.0, 0.0, 0.0, *UPSIDE_DOWN.tolist())),))
    noisy, hung = with_imu(noise_mps2=0.2), with_imu(mounting=UPSIDE_DOWN, frame="imu_link")
    for name, walk, faults, skip in (
        ("walk", STEPS, (noisy,), ""),
        ("trot", TROT, (noisy,), ""),
        ("pace", replace(TROT, gait=gaits.PACE), (noisy,), ""),
        ("uphill", replace(STEPS, slope_rad=0.1), (noisy,), ""),
        ("another heading", replace(STEPS, heading_rad=0.7), (noisy,), ""),
        ("pushed to and fro", STEPS, (to_and_fro, noisy, IN_WORLD), ways),
        ("pushed up and down", STEPS, (up_and_down, noisy, IN_WORLD), "climb"),
        ("mounting recorded", STEPS, (hung, told), ""),
        # Gravity alone cannot tell.
        ("turned about the vertical at constant speed", STEPS, (with_imu(mounting=ABOUT_UP),), ""),
    ):
        yield Case(f"accelerometer: {name}", walk, faults, skip=skip)


def odd() -> Iterator[Case]:
    """Accelerometers at fault."""
    imu = with_imu()
    weight, whose = "IMPULSE_IS_NOT_WEIGHT", "load on front_right, whose sensor reads"
    for name, walk, faults, says in (
        ("dead foot", STEPS, (imu, on(sensor.dead_from(0.0), "back_right")), weight),
        # Both feet of a diagonal press at once: which of them is wrong cannot be told.
        ("a foot of a trot reads half", TROT, (imu, on(sensor.scaled(0.5), "front_left")), weight),
        ("a foot reads half", STEPS, (imu, on(sensor.scaled(0.5), "front_right")), whose),
        ("a foot reads 1.5 times", STEPS, (imu, on(sensor.scaled(1.5), "front_right")), whose),
        ("mass 20 % wrong", STEPS, (imu, sensor.user_gives(mass=24.0)), "carry 20 kg, .* is 24 kg"),
        ("forces lean", STEPS, (imu, sensor.leaning(LEANS), IN_WORLD), weight),
        ("in g", STEPS, (with_imu(unit_mps2=G),), "IMU_READS .* reads in g"),
        ("without gravity", STEPS, (with_imu(without_mps2=G),), "IMU_READS .* is taken out"),
        ("scale 0.8", STEPS, (with_imu(unit_mps2=1.25),), "IMU_READS .* a factor of 0.8"),
        ("scale 2", STEPS, (with_imu(unit_mps2=0.5),), "IMU_READS .* a factor of 2"),
        ("zeros", STEPS, (imu, reading(np.zeros_like)), "IMU_READS all .* are zero"),
        ("unclear", STEPS, (imu, reading(wandering)), "IMU_READS .* nothing is concluded"),
        ("upside down", STEPS, (with_imu(mounting=UPSIDE_DOWN),), "IMU_TURNED"),
        ("tilted about x", STEPS, (with_imu(mounting=ABOUT_X),), "IMU_TURNED .* by 20.0 degrees"),
        ("tilted about y", STEPS, (with_imu(mounting=ABOUT_Y),), "IMU_TURNED .* by 20.0 degrees"),
    ):
        yield Case(f"accelerometer: {name}", walk, faults, says,
                   skip="forces over it, peak force, size")
# fmt: on
