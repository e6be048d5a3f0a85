"""Logs of feet's sensors at fault: levels, noise, frames, masses, units, sensors that stop."""

from collections.abc import Iterator
from dataclasses import replace
from math import radians
from typing import Final

from tests.truth import gaits
from tests.truth import sensor_faults as sensor
from tests.truth import time_faults as time
from tests.truth.case import Case
from tests.truth.recording import FORCE, IN_CONTACT, changed, on
from tests.truth.robots import biped, hexapod, quadruped
from tests.truth.walking import Walk
from tests.truth.walks import (
    BIPED,
    COARSE,
    LIGHT,
    LONG,
    NO_MASS,
    QUIET,
    ROUGH,
    SENSED,
    TALL,
    TROT,
    WAVE,
)

OFFSETS_N: Final = (-65.0, -40.0, -20.0, -5.0, 5.0, 10.0, 20.0)
LEVEL: Final = "offset|unloaded"
MOVES: Final = "without load moves"


# fmt: off
def levels() -> Iterator[Case]:
    """Levels without load."""
    two = Walk(gait=gaits.BIPED_WALK, robot=biped(80.0), period_s=1.2)
    for newtons in OFFSETS_N:
        noisy = *SENSED, sensor.offset(newtons)
        yield Case(f"offset {newtons:+g} N", TROT, noisy,
                   LEVEL if abs(newtons) > 0.02 * quadruped().weight_n else "", LEVEL)
        if newtons in {-65.0, 20.0}:
            yield Case(f"offset {newtons:+g} N, biped of 80 kg", two, noisy,
                       LEVEL if newtons == -65.0 else "", LEVEL)
    yield Case("offset (10, -15, -40) N, noise 2 N", TROT,
               (FORCE, sensor.noise(2.0), sensor.offset((10.0, -15.0, -40.0))), LEVEL)
    yield Case("offset of one foot, -30 N", TROT,
               (*SENSED, on(sensor.offset(-30.0), "back_left")), LEVEL)
    yield Case("drift 20 N a minute", Walk(seconds=40.0),
               (*SENSED, sensor.offset(-20.0), sensor.drift(20.0)), "offset|drift",
               "offset|drift|unloaded", rate_hz=100.0)
    for newtons, only in ((-25.0, ()), (40.0, ()), (30.0, ("back_left",))):
        zeroed = on(sensor.rezeroed(10.03, newtons), *only)
        name = f"{'one force sensor' if only else 'force sensors'} re-zeroed in mid-log"
        yield Case(f"{name}, {newtons:+g} N before", Walk(seconds=20.0), (*SENSED, zeroed),
                   "CONTACT_UNKNOWN.*re-zeroed")
    yield Case("force sensors warm up by 40 N", Walk(seconds=40.0),
               (*SENSED, sensor.warming(40.0, 20.0)), MOVES, cause="")


def noises() -> Iterator[Case]:
    """Noise, spikes, limits."""
    for mass, seed in ((20.0, 0), (20.0, 1), (80.0, 2)):
        yield Case(f"noise 5 N, {mass:g} kg, seed {seed}", Walk(robot=quadruped(mass)),
                   (FORCE, sensor.noise(5.0, seed)), skip="size", tolerance=ROUGH)
    yield Case("noise 5 N, 0.5 kg", LIGHT, (FORCE, sensor.noise(5.0)),
               "noise|threshold|modes|unloaded")
    for newtons in (300.0, 2000.0):
        yield Case(f"spikes of {newtons:g} N", TROT, (*SENSED, sensor.spikes(newtons, 1.0)),
                   "spike")
    yield Case("quantised to 4 N", TROT, (FORCE, sensor.quantised(4.0)))
    yield Case("quantised to 0.25 N, 0.5 kg", LIGHT, (FORCE, sensor.quantised(0.25)))
    yield Case("one sensor stuck at 60 N", TROT,
               (*QUIET, on(sensor.stuck(60.0), "front_right")), "stuck|constant")
    for name, walk in (("sensors saturate", Walk(traction=0.0)),
                       ("one axis of the sensors saturates", TROT)):
        yield Case(f"{name} at 80 N", walk, (FORCE, sensor.saturated(80.0)),
                   "saturat|highest value", skip="size")
    for apart in (3, 4):
        yield Case(f"pairs of spikes, {apart} samples apart", Walk(seconds=20.0),
                   (*SENSED, sensor.spikes(300.0, 0.5, apart)), "spike",
                   "CONTACT_UNKNOWN|spike", COARSE, "size")
    slow = Walk(robot=quadruped(40.0), period_s=1.12, seconds=20.0, hump=0.0)
    sticking = FORCE, sensor.hysteresis(0.08), sensor.noise(0.5), sensor.clipped()
    yield Case("8 % hysteresis, clipped at zero, 50 Hz, in bursts", slow,
               (*sticking, time.in_bursts(0.1)), tolerance=COARSE, rate_hz=50.0)
    # Feet that begin in the air read zero there, and never again.
    six = Walk(gait=gaits.TRIPOD, robot=hexapod(8.0), period_s=1.4, speed_mps=0.05, seconds=12.0)
    yield Case("5 % hysteresis, six feet", six, (FORCE, sensor.hysteresis(0.05)), "SATURATED", "",
               skip="size", rate_hz=100.0)
    for name, walk in (("trot", Walk(ramp=0.15, traction=0.0)),
                       ("slow walk", Walk(gait=gaits.WALK, period_s=1.2, ramp=0.08, traction=0.0))):
        yield Case(f"flat forces without noise, {name}", walk)


def light_and_heavy() -> Iterator[Case]:
    """Light and heavy robots, several faults."""
    for newtons, noise in ((1.0, 0.05), (-3.0, 0.1)):
        yield Case(f"0.5 kg, 20 Hz, offset {newtons:+g} N", replace(LIGHT, seconds=12.0),
                   (FORCE, sensor.noise(noise), sensor.offset(newtons)), LEVEL, rate_hz=20.0)
    real = FORCE, sensor.noise(3.0), sensor.offset(-50.0)
    for name, fault, says in (
        ("drift 30 N a minute", sensor.drift(30.0), "offset"),
        ("drift -120 N a minute", sensor.drift(-120.0), "offset"),
        ("load lowers what the sensors read", sensor.scaled(-1.0), "offset"),
        ("1 % lone zeros", sensor.lone_zeros(0.01), "lone zeros"),
        ("5 % lone zeros", sensor.lone_zeros(0.05), "lone zeros"),
        ("spikes of +3000 N", sensor.spikes(3000.0, 2.0), "spike"),
        ("spikes of -3000 N", sensor.spikes(-3000.0, 2.0), "spike"),
    ):
        yield Case(f"biped of 80 kg, 50 Hz, offset -50 N, {name}", TALL, (*real, fault), says,
                   f"{LEVEL}|zeros|spike", COARSE, "size" if says == "spike" else "", rate_hz=50.0)


def hexapods() -> Iterator[Case]:
    """Hexapods."""
    noisy = FORCE, sensor.noise(0.1)
    yield Case("six feet, wave, force sensors", WAVE, noisy, tolerance=COARSE)
    yield Case("six feet, wave, offset -2 N", WAVE, (*noisy, sensor.offset(-2.0)), "offset", None,
               COARSE)
    tripod = Walk(gait=gaits.TRIPOD, robot=hexapod(), period_s=1.0, speed_mps=0.1)
    yield Case("six feet, tripod, link forces, /tf", tripod, (sensor.in_link_frame,))
    quick = Walk(gait=gaits.WAVE, robot=hexapod(0.7), period_s=0.9, speed_mps=0.2, hump=0.0)
    yield Case("six feet, wave of 0.9 s, force sensors", quick, (FORCE, sensor.noise(0.03)),
               tolerance=COARSE)


def slopes() -> Iterator[Case]:
    """Slopes and frames of the wrenches."""
    frame, link = "WRENCH_FRAME|TRANSFORMS_MISSING|IMPULSE_IS_NOT", sensor.in_link_frame
    for degrees in (-25, -10, 10, 20, 25):
        # Along the slope at constant speed; the speed forward is its horizontal part.
        walk, name = Walk(slope_rad=radians(degrees)), f"slope {degrees:+d} degrees"
        yield Case(f"{name}, world forces", walk)
        yield Case(f"{name}, link forces, /tf", walk, (link,))
    for degrees in (10, 20):
        walk, name = Walk(slope_rad=radians(degrees)), f"slope {degrees} degrees, heading"
        yield Case(f"{name} 90", replace(walk, heading_rad=radians(90.0)))
        yield Case(f"{name} 135, link forces, /tf", replace(walk, heading_rad=radians(135.0)),
                   (link,))
    no_tf = link, changed(has_tf=False)
    yield Case("flat, link forces, no /tf", TROT, no_tf, frame)
    yield Case("slope +20 degrees, link forces, no /tf", Walk(slope_rad=radians(20)), no_tf, frame)
    yield Case("flat, link forces, /tf", TROT, (link,))
    yield Case("flat, link forces of force sensors, /tf, offset -30 N", TROT,
               (FORCE, link, sensor.noise(1.0), sensor.offset(-30.0)), LEVEL, f"{LEVEL}|{frame}")
    gallop = Walk(gait=gaits.ROTARY_GALLOP, period_s=0.5, speed_mps=2.0, traction=0.3)
    yield Case("gallop, world forces, strong traction", gallop)
    yield Case("walk, world forces, strong traction, mass not given",
               Walk(gait=gaits.WALK, period_s=1.0, traction=0.6), (NO_MASS,), "DIRECTION_UNKNOWN",
               "DIRECTION_UNKNOWN|MASS")
    # Legs that lean forward on average: their links' forces seem to push the robot on.
    lean = Walk(link_swing_rad=0.3, link_lean_rad=0.2)
    yield Case("link forces, /tf of legs that never move", lean,
               (FORCE, link, sensor.stiff_legs(), NO_MASS), "DIRECTION_UNKNOWN")
    yield Case("one link's bumper always reads 60 N, /tf", TROT,
               (link, on(sensor.stuck(60.0), "back_right")), "STUCK")
    yield Case("spikes of 800 N in link forces, /tf", LONG, (link, sensor.spikes(800.0, 4.0)),
               "spike")


def masses_and_units() -> Iterator[Case]:
    """Masses and units."""
    weight = "IMPULSE_IS_NOT_WEIGHT"
    for kind, more in (("bumpers", ()), ("force sensors", SENSED)):
        yield Case(f"mass not given, {kind}", TROT, (*more, NO_MASS), "mass")
        for percent in (10, -30, 40):
            # Of force sensors only the magnitude is known, which says less of the weight.
            seen = kind == "bumpers" or abs(percent) > 25
            yield Case(f"mass {percent:+d} % wrong, {kind}", TROT,
                       (*more, sensor.user_gives(mass=20.0 * (1.0 + percent / 100.0))),
                       weight if seen else "", "mass|weight")
        for unit, factor in (("pounds", 0.2248), ("counts", 37.0)):
            yield Case(f"{kind} read {unit}", TROT, (*more, sensor.scaled(factor)), weight)
        for factor in (0.5, 2.0):
            yield Case(f"one foot reads {factor:g} times its force, {kind}", TROT,
                       (*more, on(sensor.scaled(factor), "front_left")), weight,
                       skip="size, peak force")
    yield Case("bumpers add up four physics steps", TROT, (sensor.scaled(4.0),), "physics steps",
               weight)


def swinging_legs() -> Iterator[Case]:
    """Swinging legs.

    Sensors above the foot, that feel the inertia of the leg in swing.
    """
    tall = replace(TALL, period_s=1.4, seconds=8.0)
    for newtons in (-65.0, -40.0, 20.0):
        for kilograms in (80.0, None):
            says = LEVEL if newtons < 0 else ""
            yield Case(
                f"biped of 80 kg, wobble 100 N, offset {newtons:+g} N"
                f"{'' if kilograms else ', mass not given'}", tall,
                (FORCE, sensor.wobble(100.0), sensor.noise(3.0), sensor.offset(newtons),
                 sensor.user_gives(mass=kilograms)),
                says if kilograms else "mass", f"{LEVEL}|mass")
    for name, gait, robot, wobble, newtons in (
        ("hexapod of 2 kg, wobble 8 %, offset -2 N", gaits.TETRAPOD, hexapod(), 1.6, -2.0),
        ("hexapod of 2 kg, wobble 9 %", gaits.TETRAPOD, hexapod(), 1.8, 0.0),
        ("pronk, 2 kg, wobble 11 %", gaits.PRONK, quadruped(2.0), 2.2, 0.0),
        ("bound, 6 kg, wobble 10 %, offset -16 N", gaits.BOUND, quadruped(6.0), 6.0, -16.0),
    ):
        yield Case(name, Walk(gait=gait, robot=robot, period_s=0.6, speed_mps=0.2),
                   (FORCE, sensor.wobble(wobble), sensor.noise(0.05), sensor.offset(newtons)),
                   cause=f"{LEVEL}|CONTACT_UNKNOWN")
    yield Case("hexapod of 2 kg, wobble 8 %, 6 % hysteresis",
               Walk(gait=gaits.TRIPOD, robot=hexapod(), period_s=0.8, speed_mps=0.1),
               (FORCE, sensor.hysteresis(0.06), sensor.wobble(1.6)), "CONTACT_UNKNOWN")
    yield Case("walk, 20 kg, wobble 40 %", Walk(gait=gaits.WALK, period_s=1.1),
               (FORCE, sensor.wobble(78.5), sensor.noise(0.4)), "CONTACT_UNKNOWN")
    yield Case("hexapod of 3.3 kg, wobble 12 %, one sensor stuck",
               Walk(gait=gaits.WAVE, robot=hexapod(3.3), period_s=0.7, speed_mps=0.05),
               (FORCE, sensor.wobble(3.9), sensor.noise(0.1),
                on(sensor.stuck(6.5), "middle_left")),
               "stuck|constant", "CONTACT_UNKNOWN")
    yield Case("2 kg, wobble 8 %, counted in steps of 0.5 N",
               Walk(gait=gaits.WALK, robot=quadruped(2.2), period_s=0.9, speed_mps=0.2),
               (FORCE, sensor.wobble(1.7), sensor.noise(0.06), sensor.quantised(0.5)),
               cause=f"{LEVEL}|CONTACT_UNKNOWN", rate_hz=100.0)


def contradictory() -> Iterator[Case]:
    """Faults that contradict.

    Levels beside a second fault that hides which is which.
    """
    tall = Walk(gait=gaits.BIPED_WALK, robot=biped(80.0))
    yield Case("saturated at 500 N, biped of 80 kg, 4 strides", replace(tall, seconds=3.2),
               (FORCE, sensor.noise(2.0), sensor.saturated(500.0)),
               cause="SATURATED|IMPULSE|look alike")
    flat = Walk(gait=gaits.WALK, period_s=1.1, hump=0.0, ramp=0.05, traction=0.0)
    yield Case("flat forces, wobble 15 %, offset -10 N", flat,
               (FORCE, sensor.wobble(29.4), sensor.noise(0.4), sensor.offset(-9.8)),
               "CONTACT_UNKNOWN.*of the weight")
    yield Case("offset -60 N, biped of 80 kg, mass -20 % wrong", tall,
               (FORCE, sensor.noise(2.0), sensor.offset(-60.0), sensor.user_gives(mass=64.0)),
               "mass")
    quick = Walk(gait=gaits.WAVE, robot=hexapod(), period_s=0.6, speed_mps=0.1)
    for name, faults, rate_hz in (("bumpers", (), 100.0),
                                  ("force sensors, 50 Hz", (FORCE, sensor.noise(0.05)), 50.0)):
        yield Case(f"quick steps logged in bursts of 0.1 s, {name}", quick,
                   (*faults, time.in_bursts(0.1)), cause="without load is not known|look alike",
                   tolerance=COARSE, rate_hz=rate_hz)
    for newtons, says in ((0.0, "contact, not force"), (60.0, "STUCK")):
        yield Case(f"one bumper always reads {newtons:g} N", TROT,
                   (on(sensor.stuck(newtons), "back_right"),), says)


def stopped() -> Iterator[Case]:
    """Sensors that stop.

    Sensors that stop, or begin to speak, in the midst of a walk.
    """
    foot, tall = "front_left", replace(BIPED, robot=biped(80.0), speed_mps=0.5, seconds=16.0)
    dead, frozen = on(sensor.dead_from(8.0), foot), on(sensor.frozen_from(8.25), foot)
    ends = on(time.silent_between(8.0, 99.0), foot)
    left = on(sensor.dead_from(8.0), "left")
    for name, walk, faults in (
        ("bumper dead from mid-log on", LONG, (dead,)),
        ("bumper that is silent in swing dead from mid-log on", LONG,
         (IN_CONTACT, dead)),
        ("force sensor dead, zeros from mid-log on", LONG, (*SENSED, dead)),
        ("force sensor dead, noise from mid-log on", LONG, (FORCE, dead, sensor.noise(1.0))),
        ("force sensor frozen from mid-log on", LONG, (*SENSED, frozen)),
        ("force sensor frozen, noise from mid-log on", LONG, (FORCE, frozen, sensor.noise(1.0))),
        ("biped's force sensor dead, offset -40 N from mid-log on", tall,
         (FORCE, left, sensor.noise(3.0), sensor.offset(-40.0))),
        ("topic ends from mid-log on", LONG, (ends,)),
        ("force sensor's topic ends from mid-log on", LONG, (*SENSED, ends)),
        ("topic begins in mid-log", LONG, (on(time.silent_between(-1.0, 8.0), foot),)),
    ):
        silent = (-1.0, 8.2) if "begins" in name else (7.2, 99.0)
        yield Case(name, walk, faults, "STOPPED", "STOPPED|OFFSET", silence_s=silent)
# fmt: on
