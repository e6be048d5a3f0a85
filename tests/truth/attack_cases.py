"""Logs as an attacker would choose them: several faults at once, on robots of other sizes."""

from collections.abc import Iterator
from dataclasses import replace
from math import radians

from tests.truth import gaits, scenes
from tests.truth import sensor_faults as sensor
from tests.truth import time_faults as time
from tests.truth import world_faults as world
from tests.truth.judging import Case, Tolerance
from tests.truth.recorders import FORCE, RATE_HZ, recorder
from tests.truth.recording import disturbed
from tests.truth.robots import biped, hexapod, quadruped
from tests.truth.walking import Walk

COARSE = Tolerance(
    event_s=0.08,
    duty=0.08,
    contact=0.06,
    force=0.15,
    impulse=0.06,
    phase=0.06,
    share=0.04,
    margin=0.035,
)
_OFFSET = "offset|unloaded"


def light_and_heavy() -> Iterator[Case]:
    light = Walk(robot=quadruped(0.5), seconds=12.0)
    for newtons, noise in ((1.0, 0.05), (-3.0, 0.1)):
        yield Case(
            f"0.5 kg, 20 Hz, offset {newtons:+g} N",
            recorder(light, FORCE, sensor.noise(noise), sensor.offset(newtons), rate_hz=20.0),
            _OFFSET, _OFFSET, COARSE,
        )  # fmt: skip
    walk = Walk(gait=gaits.BIPED_WALK, robot=biped(80.0), period_s=1.2, seconds=40.0)
    real = FORCE, sensor.noise(3.0), sensor.offset(-50.0)
    for name, faults in (
        ("drift 30 N a minute", (*real, sensor.drift(30.0))),
        ("drift -120 N a minute", (*real, sensor.drift(-120.0))),
        ("load lowers what the sensors read", (*real, sensor.inverted)),
        ("1 % lone zeros", (*real, sensor.lone_zeros(0.01))),
        ("5 % lone zeros", (*real, sensor.lone_zeros(0.05))),
    ):
        said = "lone zeros" if "zeros" in name else "offset"
        yield Case(
            f"biped of 80 kg, 50 Hz, offset -50 N, {name}",
            recorder(walk, *faults, rate_hz=50.0), f"{_OFFSET}|zeros", said, COARSE,
        )  # fmt: skip
    for newtons in (3000.0, -3000.0):
        yield Case(
            f"biped of 80 kg, 50 Hz, offset -50 N, spikes of {newtons:+g} N",
            recorder(walk, *real, sensor.spikes(newtons, 2.0), rate_hz=50.0),
            "spike|offset", "spike", COARSE,
        )  # fmt: skip


def hexapods() -> Iterator[Case]:
    wave = Walk(gait=gaits.WAVE, robot=hexapod(), period_s=2.0, speed_mps=0.05, seconds=24.0)
    noisy = FORCE, sensor.noise(0.1)
    yield Case("six feet, wave, force sensors", recorder(wave, *noisy), tolerance=COARSE)
    yield Case(
        "six feet, wave, offset -2 N",
        recorder(wave, *noisy, sensor.offset(-2.0)), "offset", "offset", COARSE,
    )  # fmt: skip
    tripod = Walk(gait=gaits.TRIPOD, robot=hexapod(), period_s=1.0, speed_mps=0.1)
    yield Case(
        "six feet, tripod, link forces, /tf",
        recorder(tripod, sensor.in_link_frame), tolerance=COARSE,
    )  # fmt: skip


def slopes_across() -> Iterator[Case]:
    for degrees in (10, 20):
        slope = Walk(slope_rad=radians(degrees))
        name = f"slope {degrees} degrees, heading"
        yield Case(f"{name} 90", recorder(replace(slope, heading_rad=radians(90.0))))
        yield Case(
            f"{name} 135, link forces, /tf",
            recorder(replace(slope, heading_rad=radians(135.0)), sensor.in_link_frame),
        )


def clocks_and_losses() -> Iterator[Case]:
    clock = r"CLOCK"
    for late in (0.15, -0.15):
        jitter = time.late_delivery(0.02, 0.03)
        yield Case(
            f"clock of the feet {late:+g} s off, jitter 30 ms",
            recorder(Walk(), time.late_clock(late), jitter), clock, clock, shifted=True,
        )  # fmt: skip
        yield Case(
            f"clock of the feet {late:+g} s off, 3 s",
            recorder(Walk(seconds=3.0), time.late_clock(late)), clock, clock, shifted=True,
        )  # fmt: skip
    slow = Walk(gait=gaits.symmetrical(0.8, 0.25), period_s=1.0)
    for percent in (5, 10, 15):
        lost, said = time.lost(percent / 100.0), r"lost|GAPS|SILEN"
        logs = (
            ("force sensors, 50 Hz", Walk(), (FORCE, sensor.noise(1.0), lost), 50.0),
            ("silent in swing, 50 Hz", Walk(), (time.silent_in_swing, lost), 50.0),
            ("silent in swing, duty 0.8", slow, (time.silent_in_swing, lost), 100.0),
        )
        for name, walk, faults, rate_hz in logs:
            yield Case(
                f"{percent} % lost, {name}",
                recorder(walk, *faults, rate_hz=rate_hz), said,
                tolerance=COARSE, skip=("verdict",),
            )  # fmt: skip


def swinging_legs() -> Iterator[Case]:
    """Sensors above the foot, that feel the inertia of the leg in swing."""
    tall = Walk(gait=gaits.BIPED_WALK, robot=biped(80.0), period_s=1.4)
    for newtons in (-65.0, -40.0, 20.0):
        for kilograms in (80.0, None):
            told = "" if kilograms else ", mass not given"
            yield Case(
                f"biped of 80 kg, wobble 100 N, offset {newtons:+g} N{told}",
                recorder(
                    tall, FORCE, sensor.wobble(100.0), sensor.noise(3.0), sensor.offset(newtons),
                    sensor.wrong_mass(kilograms),
                ),
                f"{_OFFSET}|mass", "mass" if not kilograms else _OFFSET if newtons < 0 else "",
                COARSE,
            )  # fmt: skip
    cases = (
        ("hexapod of 2 kg, wobble 8 %, offset -2 N", gaits.TETRAPOD, hexapod(), 1.6, -2.0),
        ("hexapod of 2 kg, wobble 9 %", gaits.TETRAPOD, hexapod(), 1.8, 0.0),
        ("pronk, 2 kg, wobble 11 %", gaits.PRONK, quadruped(2.0), 2.2, 0.0),
        ("bound, 6 kg, wobble 10 %, offset -16 N", gaits.BOUND, quadruped(6.0), 6.0, -16.0),
    )
    for name, gait, robot, wobble, newtons in cases:
        walk = Walk(gait=gait, robot=robot, period_s=0.6, speed_mps=0.2)
        faults = FORCE, sensor.wobble(wobble), sensor.noise(0.05), sensor.offset(newtons)
        unknown = f"{_OFFSET}|CONTACT_UNKNOWN"
        yield Case(name, recorder(walk, *faults), unknown, tolerance=COARSE, skip=("verdict",))
    stuck = Walk(gait=gaits.WAVE, robot=hexapod(3.3), period_s=0.7, speed_mps=0.05)
    yield Case(
        "hexapod of 3.3 kg, wobble 12 %, one sensor stuck",
        recorder(
            stuck, FORCE, sensor.wobble(3.9), sensor.noise(0.1), sensor.stuck(6.5, "middle_left")
        ),
        "CONTACT_UNKNOWN", "stuck|constant", COARSE,
    )  # fmt: skip
    counting = Walk(gait=gaits.WALK, robot=quadruped(2.2), period_s=0.9, speed_mps=0.2)
    yield Case(
        "2 kg, wobble 8 %, counted in steps of 0.5 N",
        recorder(
            counting, FORCE, sensor.wobble(1.7), sensor.noise(0.06), sensor.quantised(0.5),
            rate_hz=100.0,
        ),
        f"{_OFFSET}|CONTACT_UNKNOWN", tolerance=COARSE, skip=("verdict",),
    )  # fmt: skip


def contradictory() -> Iterator[Case]:
    """Offsets beside a second fault that hides which is which."""
    tall = Walk(gait=gaits.BIPED_WALK, robot=biped(80.0))
    yield Case(
        "saturated at 500 N, biped of 80 kg, 4 strides",
        recorder(replace(tall, seconds=3.2), FORCE, sensor.noise(2.0), sensor.saturated(500.0)),
        "SATURATED|IMPULSE", tolerance=COARSE, skip=("verdict", "peak force", "load share"),
    )  # fmt: skip
    yield Case(
        "offset -60 N, biped of 80 kg, mass -20 % wrong",
        recorder(
            tall, FORCE, sensor.noise(2.0), sensor.offset(-60.0), sensor.wrong_mass(64.0)
        ),
        "mass", "mass", COARSE, skip=("impulse",),
    )  # fmt: skip
    slope = Walk(gait=gaits.BIPED_WALK, robot=biped(57.0), slope_rad=radians(14))
    yield Case(
        "slope of 14 degrees, two feet, odometry begins at z = 0",
        recorder(slope, world.base_from_zero), skip=("verdict",),
    )  # fmt: skip
    for name, faults, rate_hz in (
        ("bumpers", (), 100.0),
        ("force sensors, 50 Hz", (FORCE, sensor.noise(0.05)), 50.0),
    ):
        yield Case(
            f"quick steps logged in bursts of 0.1 s, {name}",
            recorder(
                Walk(gait=gaits.WAVE, robot=hexapod(), period_s=0.6, speed_mps=0.1),
                *faults, time.in_bursts(0.1), rate_hz=rate_hz,
            ),
            "OFFSET_UNKNOWN", tolerance=COARSE, skip=("verdict",),
        )  # fmt: skip
    for newtons in (-60.0, -20.0, 20.0):
        wheels = "without steps|wheel"
        offset = FORCE, sensor.noise(0.5), sensor.offset(newtons)
        yield Case(
            f"rolling on wheels, offset {newtons:+g} N",
            lambda offset=offset: disturbed(scenes.rolling().recorded(RATE_HZ), *offset),  # type: ignore[misc]
            wheels, wheels,
        )  # fmt: skip


def in_the_air() -> Iterator[Case]:
    carried = scenes.carried()
    for name, faults in (
        ("carried, force sensors", (FORCE, sensor.noise(1.0))),
        ("carried while the legs move", (FORCE, sensor.noise(1.0), sensor.inertia(6.0))),
        ("carried while the legs move fast", (FORCE, sensor.noise(1.0), sensor.inertia(14.0))),
    ):
        yield Case(
            name,
            lambda faults=faults: disturbed(carried.recorded(RATE_HZ), *faults),  # type: ignore[misc]
            says=r"_CARRIED|_LIFTED|\bcarried|\blifted|WITHOUT_STEPS",
            classes=("stand", None),
            skip=("path", "speed"),
        )
    for name, more in (("bumpers", ()), ("force sensors", (FORCE, sensor.noise(1.0)))):
        yield Case(
            f"sitting, no foot loaded, {name}",
            lambda more=more: disturbed(scenes.sitting().recorded(RATE_HZ), *more),  # type: ignore[misc]
            classes=(None,),
            skip=("verdict",),
        )
