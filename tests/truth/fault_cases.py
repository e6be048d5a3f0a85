"""Logs of walks that something is wrong with: sensors, frames, worlds, clocks, messages."""

from collections.abc import Iterator
from math import radians
from typing import Final

from tests.truth import gaits
from tests.truth import sensor_faults as sensor
from tests.truth import time_faults as time
from tests.truth import world_faults as world
from tests.truth.judging import Case, Tolerance
from tests.truth.recorders import FORCE, recorder
from tests.truth.robots import biped, quadruped
from tests.truth.walking import Walk

OFFSETS_N: Final = (-65.0, -40.0, -20.0, -5.0, 5.0, 10.0, 20.0)


def sensors() -> Iterator[Case]:
    for newtons in OFFSETS_N:
        said = "offset|unloaded" if abs(newtons) > 0.02 * quadruped().weight_n else ""
        noisy = (FORCE, sensor.noise(1.0), sensor.offset(newtons))
        yield Case(f"offset {newtons:+g} N", recorder(Walk(), *noisy), "offset|unloaded", said)
        if newtons in {-65.0, 20.0}:
            walk = Walk(gait=gaits.BIPED_WALK, robot=biped(80.0), period_s=1.2)
            yield Case(
                f"offset {newtons:+g} N, biped of 80 kg",
                recorder(walk, *noisy),
                "offset|unloaded",
                "offset|unloaded" if newtons == -65.0 else "",
            )
    sideways = sensor.offset((10.0, -15.0, -40.0))
    yield Case(
        "offset (10, -15, -40) N, noise 2 N",
        recorder(Walk(), FORCE, sensor.noise(2.0), sideways),
        "offset|unloaded", "offset|unloaded",
    )  # fmt: skip
    yield Case(
        "offset of one foot, -30 N",
        recorder(Walk(), FORCE, sensor.noise(1.0), sensor.offset(-30.0, "back_left")),
        "offset|unloaded", "offset|unloaded",
    )  # fmt: skip
    yield Case(
        "drift 20 N a minute",
        recorder(
            Walk(seconds=40.0), FORCE, sensor.noise(1.0), sensor.offset(-20.0), sensor.drift(20.0),
            rate_hz=100.0,
        ),
        "offset|drift|unloaded", "offset|drift",
    )  # fmt: skip
    for mass, seed in ((20.0, 0), (20.0, 1), (80.0, 2)):
        yield Case(
            f"noise 5 N, {mass:g} kg, seed {seed}",
            recorder(Walk(robot=quadruped(mass)), FORCE, sensor.noise(5.0, seed)),
            tolerance=Tolerance(event_s=0.04, duty=0.05, contact=0.05, force=0.1),
            skip=("verdict", "braking"),
        )
    yield Case(
        "noise 5 N, 0.5 kg",
        recorder(Walk(robot=quadruped(0.5)), FORCE, sensor.noise(5.0)),
        "noise|threshold|modes|unloaded",
        "noise|threshold|modes|unloaded",
    )
    for newtons in (300.0, 2000.0):
        yield Case(
            f"spikes of {newtons:g} N",
            recorder(Walk(), FORCE, sensor.noise(1.0), sensor.spikes(newtons, 1.0)),
            "spike", "spike",
        )  # fmt: skip
    yield Case("quantised to 4 N", recorder(Walk(), FORCE, sensor.quantised(4.0)))
    yield Case(
        "quantised to 0.25 N, 0.5 kg",
        recorder(Walk(robot=quadruped(0.5)), FORCE, sensor.quantised(0.25)),
        tolerance=Tolerance(force=0.12, impulse=0.06, event_s=0.04, duty=0.05),
    )  # fmt: skip
    yield Case(
        "one sensor stuck at 60 N",
        recorder(Walk(), FORCE, sensor.noise(0.5), sensor.stuck(60.0, "front_right")),
        "stuck|constant", "stuck|constant",
    )  # fmt: skip
    limit = "saturat|highest value"
    for name, walk in (
        ("sensors saturate at 80 N", Walk(traction=0.0)),
        ("one axis of the sensors saturates at 80 N", Walk()),
    ):
        yield Case(
            name,
            recorder(walk, FORCE, sensor.saturated(80.0)),
            limit,
            limit,
            skip=("peak force", "impulse", "braking"),
        )


def slopes() -> Iterator[Case]:
    for degrees in (-25, -10, 10, 20, 25):
        walk = Walk(slope_rad=radians(degrees))
        name = f"slope {degrees:+d} degrees"
        # Along the slope at constant speed; the speed forward is its horizontal part.
        yield Case(f"{name}, world forces", recorder(walk))
        yield Case(f"{name}, link forces, /tf", recorder(walk, sensor.in_link_frame))
    steep, flat = Walk(slope_rad=radians(20)), Walk()
    frame = "WRENCH_FRAME|TRANSFORMS_MISSING|IMPULSE_IS_NOT"
    no_tf = sensor.in_link_frame, sensor.without_tf
    yield Case("flat, link forces, no /tf", recorder(flat, *no_tf), frame, frame)
    yield Case("slope +20 degrees, link forces, no /tf", recorder(steep, *no_tf), frame, frame)
    yield Case("flat, link forces, /tf", recorder(flat, sensor.in_link_frame))
    yield Case(
        "flat, link forces of force sensors, /tf, offset -30 N",
        recorder(flat, FORCE, sensor.in_link_frame, sensor.noise(1.0), sensor.offset(-30.0)),
        f"offset|unloaded|{frame}", "offset|unloaded",
    )  # fmt: skip
    gallop = Walk(gait=gaits.ROTARY_GALLOP, period_s=0.5, speed_mps=2.0, traction=0.3)
    yield Case("gallop, world forces, strong traction", recorder(gallop))


def worlds() -> Iterator[Case]:
    worlds = r"WORLD|worlds|drift|far from"
    yield Case(
        "odometry displaced by 5 m",
        recorder(Walk(), world.displaced((3.0, 4.0, 0.0))), worlds, worlds,
    )  # fmt: skip
    yield Case(
        "odometry drifts by 8 %", recorder(Walk(seconds=16.0), world.drifting(0.08)), worlds, worlds
    )
    for seconds in (4.0, 8.0):
        yield Case(
            f"odometry drifts by 2 %, {seconds:g} s",
            recorder(Walk(seconds=seconds), world.drifting(0.02)), worlds, worlds,
        )  # fmt: skip
    yield Case(
        "the body leans 4 cm to the side from 3 s on",
        recorder(Walk(), world.leaning(3.0, (0.0, 0.04, 0.0))), skip=("margin",),
    )  # fmt: skip
    yield Case(
        "odometry begins at z = 0", recorder(Walk(), world.base_from_zero), skip=("verdict",)
    )
    yield Case(
        "odometry begins at z = 0, force sensors",
        recorder(Walk(), FORCE, world.base_from_zero),
        skip=("verdict",),
    )
    yield Case("odometry with 2 mm of noise", recorder(Walk(), world.pose_noise(0.002)))
    yield Case(
        "odometry jumps by 1 m",
        recorder(Walk(), world.jump(4.0, (1.0, 0.5, 0.0))), "jump", "jump",
        skip=("path", "speed", "stride length"),
    )  # fmt: skip


def clocks() -> Iterator[Case]:
    clock = r"CLOCK|clocks? of|clocks differ|time are mixed"
    for seconds in (0.1, 0.2, 0.3, -0.2):
        yield Case(
            f"clock of the feet {seconds:+g} s off",
            recorder(Walk(), time.late_clock(seconds)), clock, clock, shifted=True,
        )  # fmt: skip
    # Only steps that are not evenly spaced tell a delay from one that is half a stride longer.
    uneven = gaits.Gait("walk", (0.0, 0.5, 0.72, 0.22), 0.75, "lateral")
    walk = Walk(gait=uneven, period_s=1.0, seconds=20.0, shares=(0.29, 0.27, 0.23, 0.21))
    for late in (0.0, 0.1, 0.2, 0.3, -0.2):
        yield Case(
            f"the base heaves, odometry restamped by {late:+g} s",
            recorder(walk, world.driven, world.restamped(late)),
            clock if late else "", clock if late else "", shifted=late < 0.0,
            skip=("height", "peak force", "braking"),
        )  # fmt: skip
    yield Case(
        "feet on simulation time, odometry on the wall's",
        recorder(Walk(), time.late_clock(-1.69e9)), clock, clock, shifted=True,
    )  # fmt: skip
    yield Case("no stamps at all", recorder(Walk(), time.no_stamps), "stamp", "stamp")
    yield Case(
        "simulation at 0.4 of real time",
        recorder(Walk(), time.slow_simulation(2.5)),
        skip=("verdict",),
    )
    yield Case(
        "messages 50 ms late, 30 ms of jitter",
        recorder(Walk(), time.late_delivery(0.05, 0.03)),
        skip=("verdict",),
    )
    yield Case(
        "logged in bursts of 0.1 s", recorder(Walk(), time.in_bursts(0.1)), skip=("verdict",)
    )
    for message in (0, 500):
        yield Case(
            f"stamp of message {message} is zero",
            recorder(Walk(), time.zero_stamp(message, "front_right")),
            "stamp|clock", "stamp|clock",
        )  # fmt: skip
    yield Case(
        "two messages swapped",
        recorder(Walk(), time.swapped_messages(500, "front_right")),
        "stamp|clock|back", "stamp|clock|back",
    )  # fmt: skip
    yield Case(
        "simulation reset",
        recorder(Walk(), time.reset(4.0)),
        "reset",
        "reset",
        skip=("speed", "path"),
    )


def losses() -> Iterator[Case]:
    for percent in (2, 5, 15):
        yield Case(
            f"silent in swing, {percent} % lost",
            recorder(Walk(), time.silent_in_swing, time.lost(percent / 100.0)),
            r"lost|GAPS|SILEN", skip=("verdict",),
        )  # fmt: skip
    yield Case("silent in swing", recorder(Walk(), time.silent_in_swing))
    yield Case(
        "15 % lost", recorder(Walk(), time.lost(0.15)), r"lost|GAPS|SILEN", skip=("verdict",)
    )
    hung = time.silent_between(3.0, 5.0)
    one = time.silent_between(3.0, 5.0, "back_left")
    silence = r"GAPS|SILEN|drop-?out|all feet"
    for name, faults in (
        ("all feet silent for 2 s", (hung,)),
        ("silent in swing, all feet silent for 2 s", (time.silent_in_swing, hung)),
        ("one foot silent for 2 s", (one,)),
    ):
        yield Case(name, recorder(Walk(), *faults), silence, silence, silence_s=(3.0, 5.1))


def masses() -> Iterator[Case]:
    for kind, more in (("bumpers", ()), ("force sensors", (FORCE, sensor.noise(1.0)))):
        yield Case(
            f"mass not given, {kind}",
            recorder(Walk(), *more, sensor.wrong_mass(None)),
            "mass",
            "mass",
        )
        # Of force sensors only the magnitude is known, which says less of the weight.
        seen = kind == "bumpers"
        for percent in (10, -30, 40):
            yield Case(
                f"mass {percent:+d} % wrong, {kind}",
                recorder(Walk(), *more, sensor.wrong_mass(20.0 * (1.0 + percent / 100.0))),
                "mass|weight",
                "IMPULSE_IS_NOT_WEIGHT" if seen or abs(percent) > 25 else "",
                skip=("impulse",),
            )  # fmt: skip


def scales() -> Iterator[Case]:
    """Sensors in other units, or one that is calibrated wrongly."""
    said = "IMPULSE_IS_NOT_WEIGHT"
    noisy = FORCE, sensor.noise(1.0)
    for unit, factor in (("pounds", 0.2248), ("counts", 37.0)):
        scale = sensor.scaled(factor)
        yield Case(f"bumpers read {unit}", recorder(Walk(), scale), said, said)
        yield Case(f"force sensors read {unit}", recorder(Walk(), *noisy, scale), said, said)
    for factor in (0.5, 2.0):
        odd = sensor.scaled(factor, "front_left")
        name = f"one foot reads {factor:g} times its force"
        yield Case(
            f"{name}, bumpers", recorder(Walk(), odd), said, said, skip=("peak force",)
        )  # fmt: skip
        yield Case(f"{name}, force sensors", recorder(Walk(), *noisy, odd), said, said)
