"""Logs of feet outside the usual; each right, or null with the cause named."""

from collections.abc import Iterator
from typing import Final

from tests.truth import foot_faults as foot
from tests.truth import gaits
from tests.truth import pose_faults as pose
from tests.truth import sensor_faults as sensor
from tests.truth import time_faults as time
from tests.truth.judging import Case, Tolerance
from tests.truth.recorders import FORCE, recorder
from tests.truth.robots import biped
from tests.truth.walking import Walk

TROT: Final = Walk()
WALK: Final = Walk(gait=gaits.WALK, period_s=1.0)
NO_FORCE: Final = (
    "peak force", "braking", "load share", "impulse", "slip", "height", "froude", "verdict",
    "margin",
)  # fmt: skip


def some() -> Iterator[Case]:
    """Some of the robot's feet have sensors: their own metrics are right, those of all are not."""
    walk = Walk(gait=gaits.WALK, period_s=1.1, shares=(0.3, 0.28, 0.22, 0.2))
    others, fore = {"front_left", "front_right", "back_right"}, {"back_left", "back_right"}
    of_all = "no other foot"
    for name, sensors in (
        ("bumpers", ()),
        ("force sensors", (FORCE, sensor.noise(0.5))),
        ("silent in swing", (time.silent_in_swing,)),
    ):
        for of, gait in (("trot", TROT), ("walk", walk)):
            yield Case(f"one foot, {of}, {name}", recorder(gait, *sensors, foot.without(*others)),
                       of_all, of_all)  # fmt: skip
    two = FORCE, sensor.noise(0.5), foot.without(*fore)
    yield Case("fore feet, force sensors", recorder(walk, *two), of_all, of_all)
    one = foot.without(*others)
    yield Case("one foot, mass not given", recorder(walk, one, sensor.wrong_mass(None)),
               f"{of_all}|mass", of_all)  # fmt: skip


def several() -> Iterator[Case]:
    """Each foot has several sensors, told by names or by frames, or by the links of collisions."""
    two = Walk(gait=gaits.BIPED_WALK, robot=biped(), period_s=1.1, speed_mps=0.8)
    four = Walk(gait=gaits.WALK, period_s=1.0)
    toe_heel = foot.several("/duo/{foot}_foot_heel", "/duo/{foot}_foot_toe")
    cells = foot.several(*(f"/duo/{{foot}}_foot/cell_{n}/force" for n in range(1, 5)))
    quad = foot.several("/quad/{foot}/heel", "/quad/{foot}/toe", reach_m=0.03)
    corners = foot.several("/duo/{foot}_back", "/duo/{foot}_front", share_frames=True)
    noisy = FORCE, sensor.noise(0.5)
    for name, walk, split, *sensors in (
        ("toe and heel, bumpers", two, toe_heel),
        ("toe and heel, force sensors", two, toe_heel, *noisy),
        ("toe and heel, silent in swing", two, toe_heel, time.silent_in_swing),
        ("four cells, bumpers", two, cells),
        ("four cells, force sensors", two, cells, *noisy),
        ("toe and heel of four feet, bumpers", four, quad),
        ("front and back of each sole, one link, bumpers", two, corners),
        ("front and back of each sole, one frame, force sensors", two, corners, *noisy),
    ):
        yield Case(name, recorder(walk, *sensors, split), skip=("margin", "slip", "verdict"))


def filters() -> Iterator[Case]:
    """Forces that went through a low-pass filter: contact is that of the forces before it."""
    said = "FORCE_FILTERED"
    two = Walk(gait=gaits.BIPED_WALK, robot=biped(), period_s=1.1, speed_mps=0.8)
    slow = Walk(gait=gaits.WALK, period_s=1.3, speed_mps=0.3, seconds=12.0)
    flat = Walk(ramp=0.15, traction=0.0)
    rough = Tolerance(event_s=0.04, duty=0.05, contact=0.05)
    for name, walk, hertz, newtons in (
        ("5 Hz, trot", TROT, 5.0, 0.5),
        ("2 Hz, trot", TROT, 2.0, 0.5),
        ("5 Hz, walk", slow, 5.0, 0.5),
        ("4 Hz, two feet", two, 4.0, 2.0),
        ("3 Hz, flat forces", flat, 3.0, 1.0),
        ("8 Hz, no noise", WALK, 8.0, 0.0),
    ):
        yield Case(
            f"filtered at {name}",
            recorder(walk, FORCE, foot.filtered(hertz), sensor.noise(newtons)), "", said, rough,
            skip=("verdict", "peak force"),
        )  # fmt: skip
    yield Case(
        "filtered at 5 Hz, offset -30 N",
        recorder(TROT, FORCE, foot.filtered(5.0), sensor.noise(0.5), sensor.offset(-30.0)),
        "offset", said, rough, skip=("verdict", "peak force"),
    )  # fmt: skip


def flags() -> Iterator[Case]:
    """Contact without a force."""
    coarse = Tolerance(event_s=0.1, duty=0.1, contact=0.1, phase=0.1, period=0.1)
    hop = Walk(gait=gaits.PRONK, speed_mps=2.0, period_s=0.5)
    for name, walk in (("walk", WALK), ("trot", TROT), ("pronk", hop)):
        yield Case(f"flags, {name}", recorder(walk, foot.as_flags), skip=NO_FORCE)
    slow = "SAMPLED_SLOWLY"
    for rate, walk in ((10.0, TROT), (5.0, WALK)):
        yield Case(
            f"flags, {rate:g} Hz", recorder(walk, foot.as_flags, foot.sampled(rate)), slow, slow,
            coarse, skip=(*NO_FORCE, "touchdowns", "lift-offs"),
        )  # fmt: skip
    said = "FLAGS_INVERTED"
    for name, walk, only in (
        ("walk", WALK, ()),
        ("trot", TROT, ()),
        ("walk, one foot", WALK, ("back_left",)),
    ):
        inverted = foot.as_flags, foot.inverted(*only)
        yield Case(
            f"inverted flags, {name}", recorder(walk, *inverted), said, said, skip=NO_FORCE
        )  # fmt: skip
    yield Case(
        "inverted flags, walk, places in the base",
        recorder(WALK, pose.feet_in_base, foot.inverted()), said, said, skip=NO_FORCE,
    )  # fmt: skip


def others() -> Iterator[Case]:
    """Scuffs, filters, payloads, moving ground."""
    hind = "back_left", "back_right"
    rough = Tolerance(duty=0.05, contact=0.05)
    for name, sensors in (("bumpers", ()), ("force sensors", (FORCE, sensor.noise(0.5)))):
        scuff = foot.scuffs(12.0, 0.03, *hind)
        for of, walk in (("walk", WALK), ("trot", TROT)):
            yield Case(
                f"hind feet scuff, {of}, {name}", recorder(walk, *sensors, scuff), "", "", rough,
                skip=("verdict", "support"),
            )  # fmt: skip
    yield Case(
        "a payload put down", recorder(TROT, foot.payload(4.0, 0.75)), "PAYLOAD|WEIGHT", "PAYLOAD",
        skip=("peak force", "impulse", "braking"),
    )  # fmt: skip
    yield Case(
        "a payload put on, force sensors",
        recorder(WALK, FORCE, sensor.noise(0.5), foot.payload(3.0, 1.3), sensor.wrong_mass(None)),
        "PAYLOAD|MASS", "PAYLOAD", rough, skip=("peak force", "impulse", "braking"),
    )  # fmt: skip
    said, tread = "TREADMILL", ("height", "froude", "slip", "margin", "verdict")
    for name, walk in (("trot", TROT), ("walk", WALK)):
        yield Case(
            f"treadmill, {name}, contact points", recorder(walk, foot.treadmill), "", said,
            skip=tread,
        )  # fmt: skip
        yield Case(
            f"treadmill, {name}, places in the base",
            recorder(walk, pose.feet_in_base, foot.treadmill), "", said, skip=(*NO_FORCE, *tread),
        )  # fmt: skip
