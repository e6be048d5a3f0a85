"""Logs as laboratories record them: other axes, some feet only, several kinds of sensors."""

from collections.abc import Iterator
from dataclasses import replace
from math import radians

from tests.truth import gaits
from tests.truth import sensor_faults as sensor
from tests.truth import world_faults as world
from tests.truth.judging import Case
from tests.truth.recorders import FORCE, recorder
from tests.truth.recording import Disturbance, Recording
from tests.truth.robots import hexapod
from tests.truth.walking import Walk

UNKNOWN_MASS = sensor.wrong_mass(None)


def some_feet() -> Iterator[Case]:
    """Feet of which not all are recorded, or not in one type of messages."""
    yield Case(
        "force sensors on the fore feet, bumpers on the hind feet",
        recorder(Walk(), _fore_feet_feel_forces),
        skip=("slip", "margin"),
    )
    wave = Walk(gait=gaits.WAVE, robot=hexapod(), period_s=2.0, speed_mps=0.05, seconds=16.0)
    for name, walk, feet in (
        ("no topic of one foot", Walk(), ("back_right",)),
        ("no topics of the fore feet", Walk(), ("front_left", "front_right")),
        ("six feet, no topic of a middle one", wave, ("middle_left",)),
    ):
        missing = "FOOT_MISSING|NO_MESSAGES"
        yield Case(name, recorder(walk, _without(*feet), UNKNOWN_MASS), missing, missing)


def flat_tops() -> Iterator[Case]:
    """Forces of a simulator without noise: flat, but not cut off."""
    for name, walk in (
        ("trot", Walk(ramp=0.15, traction=0.0)),
        ("slow walk", Walk(gait=gaits.WALK, period_s=1.2, ramp=0.08, traction=0.0)),
    ):
        yield Case(f"flat forces without noise, {name}", recorder(walk))


def moving_levels() -> Iterator[Case]:
    """Sensors of which the level without load moves in the course of the log."""
    walk = Walk(seconds=20.0)
    noise = sensor.noise(1.0)
    for newtons in (-25.0, 40.0):
        yield Case(
            f"force sensors re-zeroed in mid-log, {newtons:+g} N before",
            recorder(walk, FORCE, noise, sensor.rezeroed(10.03, newtons)),
            "", "without load moves",
        )  # fmt: skip
    yield Case(
        "one force sensor re-zeroed in mid-log, 30 N before",
        recorder(walk, FORCE, noise, sensor.rezeroed(10.03, 30.0, "back_left")),
        "", "without load moves",
    )  # fmt: skip
    yield Case(
        "force sensors warm up by 40 N",
        recorder(replace(walk, seconds=40.0), FORCE, noise, sensor.warming(40.0, 20.0)),
        "", "without load moves",
    )  # fmt: skip


def transforms() -> Iterator[Case]:
    """Transforms that are not those of the legs."""
    # Legs that lean forward on average: their links' forces seem to push the robot on.
    lean = Walk(link_swing_rad=0.3, link_lean_rad=0.2)
    yield Case(
        "link forces, /tf of legs that never move",
        recorder(lean, FORCE, sensor.in_link_frame, sensor.stiff_legs, UNKNOWN_MASS),
        "DIRECTION_UNKNOWN", "DIRECTION_UNKNOWN",
    )  # fmt: skip


def axes() -> Iterator[Case]:
    """Poses whose z axis is not up."""
    walk = Walk(heading_rad=radians(90.0))
    for name, body in (("", False), (" and of its body", True)):
        yield Case(
            f"motion capture, y up of the world{name}",
            recorder(walk, world.y_up(body=body), FORCE), "UP_AXIS", "UP_AXIS",
        )  # fmt: skip


def sides() -> Iterator[Case]:
    """Left and right the other way round."""
    walk = Walk(gait=gaits.WALK, period_s=1.0)
    said = "SIDES_SWAPPED"
    yield Case(
        "all in a world with z down and y to the right",
        recorder(walk, world.z_down, UNKNOWN_MASS), f"{said}|IMPULSE", said,
    )  # fmt: skip
    yield Case(
        "topics of the fore feet swapped",
        recorder(walk, world.swapped("front_left", "front_right")), said, said,
        skip=("sequence", "touchdowns", "lift-offs", "phase"),
    )  # fmt: skip


def drifting_height() -> Iterator[Case]:
    """State estimators of which z drifts, beside contact points in the true world."""
    for speed in (0.02, -0.02):
        yield Case(
            f"odometry drifts by {speed:+g} m/s in z",
            recorder(Walk(seconds=12.0), world.rising(speed)), "HEIGHT_DRIFTS", "HEIGHT_DRIFTS",
        )  # fmt: skip
    yield Case(
        "odometry counts z anew from mid-log on",
        recorder(Walk(seconds=12.0), world.reset_height(6.0)), "", "POSE_JUMP",
    )  # fmt: skip


def _fore_feet_feel_forces(recording: Recording) -> Recording:
    return replace(recording, kinds=("wrench", "wrench", "contacts", "contacts"))


def _without(*feet: str) -> Disturbance:
    return lambda recording: replace(recording, unrecorded=feet)
