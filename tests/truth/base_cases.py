"""Logs of worlds that differ, and of other axes."""

from collections.abc import Iterator
from dataclasses import replace
from math import radians

from tests.truth import gaits
from tests.truth import pose_faults as pose
from tests.truth.foot_faults import without
from tests.truth.judging import Case
from tests.truth.recording import Disturbance
from tests.truth.robots import biped
from tests.truth.walking import Walk
from tests.truth.walks import FORCE, LONG, NO_MASS, TROT, WALK

WORLDS = r"WORLD|worlds|drift|far from"
JUMPED = "path, speed, stride length"


# fmt: off
def worlds() -> Iterator[Case]:
    drift = pose.drifting(0.02)
    bound = Walk(gait=gaits.BOUND, period_s=0.86, seconds=11.7, heading_rad=radians(-90.0))
    slope = Walk(slope_rad=radians(20.0), heading_rad=radians(37.0), seconds=12.0)
    two = Walk(gait=gaits.BIPED_WALK, robot=biped(57.0), slope_rad=radians(14))
    rows: tuple[tuple[str, Walk, tuple[Disturbance, ...], str, str], ...] = (
        ("drifts by 8 %", LONG, (pose.drifting(0.08),), WORLDS, ""),
        ("drifts by 2 %, 4 s", replace(TROT, seconds=4.0), (drift,), WORLDS, ""),
        ("drifts by 2 %, 8 s", TROT, (drift,), WORLDS, ""),
        ("underrates the way by 15 %", bound, (pose.drifting(0.15),), "WORLDS_DIFFER|drifts", ""),
        ("begins at z = 0", TROT, (pose.from_zero(),), "", "verdict"),
        ("begins at z = 0, force sensors", TROT, (FORCE, pose.from_zero()), "", "verdict"),
        ("begins at z = 0, slope of 14 degrees, two feet", two, (pose.from_zero(),), "",
         "verdict"),
        ("with 2 mm of noise", TROT, (pose.pose_noise(0.002),), "", ""),
        ("jumps by 1 m", TROT, (pose.jump(4.0, (1.0, 0.5, 0.0)),), "jump", JUMPED),
        ("jumps by 1 m, slope of 20 degrees", slope, (pose.jump(6.0, (1.0, 0.5, 0.0)),), "jump",
         f"{JUMPED}, froude"),
    )
    # Lengths of feet with points of their own stay.
    yield Case("odometry displaced by 5 m", TROT, (pose.jump(0.0, (3.0, 4.0, 0.0)),), WORLDS,
               known="stride length, braking")
    yield Case("odometry displaced by 5 m and turned by 45 degrees", TROT,
               (pose.relocalised(0.0, radians(45.0), (3.0, 4.0, 0.0)),), WORLDS)
    yield Case("odometry displaced by 2 m, points of the hind feet only", TROT,
               (pose.jump(0.0, (1.2, 1.6, 0.0)), without("front_left", "front_right"), NO_MASS),
               "WORLDS_DIFFER", f"{WORLDS}|NO_MESSAGES")
    for name, walk, faults, says, skip in rows:
        yield Case(f"odometry {name}", walk, faults, says, skip=skip)
    yield Case("contact points drift by 8 %", LONG, (pose.points_drifting(0.08),), WORLDS)
    yield Case("the body leans 4 cm to the side from 3 s on", TROT,
               (pose.leaning(3.0, (0.0, 0.04, 0.0)),), skip="margin")


def axes() -> Iterator[Case]:
    for name, body in (("", False), (" and of its body", True)):
        yield Case(f"motion capture, y up of the world{name}", Walk(heading_rad=radians(90.0)),
                   (pose.y_up(body=body), FORCE), "UP_AXIS")
    yield Case("all in a world with z down and y to the right", WALK, (pose.z_down, NO_MASS),
               "SIDES_SWAPPED", "SIDES_SWAPPED|IMPULSE")
    yield Case("topics of the fore feet swapped", WALK,
               (pose.swapped("front_left", "front_right"),), "SIDES_SWAPPED",
               skip="sequence, touchdowns, lift-offs, phase")
    for speed in (0.02, -0.02):
        yield Case(f"odometry drifts by {speed:+g} m/s in z", Walk(seconds=12.0),
                   (pose.rising(speed),), "WORLDS_DIFFER the base (rises|sinks)")
    yield Case("odometry counts z anew from mid-log on", Walk(seconds=12.0),
               (pose.jump(6.0, (0.0, 0.0, -0.45)),), "POSE_JUMP", "", known="height")
# fmt: on
