"""Combinations of faults that were once measured wrongly; `random_cases` found them."""

from collections.abc import Iterator
from math import radians

from tests.truth import gaits
from tests.truth import sensor_faults as sensor
from tests.truth import time_faults as time
from tests.truth import world_faults as world
from tests.truth.attack_cases import COARSE
from tests.truth.judging import Case
from tests.truth.recorders import FORCE, recorder
from tests.truth.robots import biped, hexapod, quadruped
from tests.truth.walking import Walk

_WORLDS = r"WORLDS_DIFFER|drifts"


def stopped() -> Iterator[Case]:
    """Sensors that stop, or begin to speak, in the midst of a walk."""
    walk, foot = Walk(seconds=16.0), "front_left"
    noise = FORCE, sensor.noise(1.0)
    dead, frozen = sensor.dead_from(8.0, foot), sensor.frozen_from(8.25, foot)
    tall = Walk(gait=gaits.BIPED_WALK, robot=biped(80.0), period_s=1.1, seconds=16.0)
    of_tall = FORCE, sensor.dead_from(8.0, "left"), sensor.noise(3.0), sensor.offset(-40.0)
    kinds = (
        ("bumper dead", walk, (dead,)),
        ("bumper that is silent in swing dead", walk, (time.silent_in_swing, dead)),
        ("force sensor dead, zeros", walk, (*noise, dead)),
        ("force sensor dead, noise", walk, (FORCE, dead, sensor.noise(1.0))),
        ("force sensor frozen", walk, (*noise, frozen)),
        ("force sensor frozen, noise", walk, (FORCE, frozen, sensor.noise(1.0))),
        ("biped's force sensor dead, offset -40 N", tall, of_tall),
        ("topic ends", walk, (time.silent_between(8.0, 99.0, foot),)),
        ("force sensor's topic ends", walk, (*noise, time.silent_between(8.0, 99.0, foot))),
    )
    for name, of, faults in kinds:
        yield Case(
            f"{name} from mid-log on", recorder(of, *faults), "STOPPED|OFFSET", "STOPPED",
            silence_s=(7.2, 99.0), skip=("margin", "support"),
        )  # fmt: skip
    yield Case(
        "topic begins in mid-log", recorder(walk, time.silent_between(-1.0, 8.0, foot)),
        "STOPPED", "STOPPED", silence_s=(-1.0, 8.2), skip=("margin", "support"),
    )  # fmt: skip


def noisy() -> Iterator[Case]:
    """Forces that come and go where no foot steps, or stay where one does."""
    walk = Walk(seconds=20.0)
    for apart in (3, 4):
        yield Case(
            f"pairs of spikes, {apart} samples apart",
            recorder(walk, FORCE, sensor.noise(1.0), sensor.spike_pairs(300.0, 0.5, apart)),
            "CONTACT_UNKNOWN|spike", "spike", COARSE,
            skip=("peak force", "load share", "impulse", "lift-offs", "stride length"),
        )  # fmt: skip
    slow = Walk(robot=quadruped(40.0), period_s=1.12, seconds=20.0, hump=0.0)
    sticking = FORCE, sensor.hysteresis(0.08), sensor.noise(0.5), sensor.clipped
    yield Case(
        "8 % hysteresis, clipped at zero, 50 Hz, in bursts",
        recorder(slow, *sticking, time.in_bursts(0.1), rate_hz=50.0),
        "STOPPED", "STOPPED", COARSE, skip=("touchdowns",),
    )  # fmt: skip


def combined() -> Iterator[Case]:
    """Return each kind that was once measured wrongly."""
    quick = Walk(gait=gaits.WAVE, robot=hexapod(0.7), period_s=0.9, speed_mps=0.2, hump=0.0)
    yield Case(
        "six feet, wave of 0.9 s, force sensors",
        recorder(quick, FORCE, sensor.noise(0.03), rate_hz=200.0), tolerance=COARSE,
    )  # fmt: skip
    walk = Walk(gait=gaits.WALK, robot=quadruped(1.3), period_s=0.79, seconds=6.0, hump=0.0)
    yield Case(
        "logged in bursts of 0.1 s, silent in swing",
        recorder(walk, time.silent_in_swing, time.in_bursts(0.1), rate_hz=200.0),
        skip=("verdict",),
    )  # fmt: skip
    turned = Walk(gait=gaits.BOUND, period_s=0.86, seconds=11.7, heading_rad=radians(-90.0))
    yield Case(
        "odometry underrates the way by 15 %",
        recorder(turned, world.drifting(0.15)), _WORLDS, _WORLDS,
    )  # fmt: skip
    slope = Walk(slope_rad=radians(20.0), heading_rad=radians(37.0), seconds=12.0)
    yield Case(
        "slope of 20 degrees, odometry jumps by 1 m",
        recorder(slope, world.jump(6.0, (1.0, 0.5, 0.0))), "jump", "jump",
        skip=("path", "speed", "stride length", "froude"),
    )  # fmt: skip
    for newtons, said in ((0.0, "contact, not force"), (60.0, "STUCK")):
        yield Case(
            f"one bumper always reads {newtons:g} N",
            recorder(Walk(), sensor.stuck(newtons, "back_right")), said, said,
            skip=("margin", "verdict"),
        )  # fmt: skip
    yield Case(
        "one link's bumper always reads 60 N, /tf",
        recorder(Walk(), sensor.in_link_frame, sensor.stuck(60.0, "back_right")),
        "STUCK", "STUCK", skip=("margin",),
    )  # fmt: skip
    yield Case(
        "spikes of 800 N in link forces, /tf",
        recorder(Walk(seconds=16.0), sensor.in_link_frame, sensor.spikes(800.0, 4.0)),
        "spike", "spike", COARSE,
    )  # fmt: skip
