"""Logs of feet outside the usual; each right, or null with the cause named."""

from collections.abc import Iterator

from tests.truth import foot_faults as foot
from tests.truth import gaits
from tests.truth import pose_faults as pose
from tests.truth import sensor_faults as sensor
from tests.truth.judging import Case, Tolerance
from tests.truth.recorders import FORCE, recorder
from tests.truth.walking import Walk

TROT, WALK = Walk(), Walk(gait=gaits.WALK, period_s=1.0)
NO_FORCE = ("peak force", "braking", "load share", "impulse", "slip", "height", "froude", "verdict")


def flags() -> Iterator[Case]:
    """Contact without a force."""
    yield Case("flags", recorder(WALK, foot.as_flags), "NO_FORCE", skip=NO_FORCE)
    slow = Tolerance(event_s=0.1, duty=0.1, contact=0.1, phase=0.1, period=0.1)
    for rate in (10.0, 5.0):
        yield Case(
            f"flags, {rate:g} Hz", recorder(WALK, foot.as_flags, foot.sampled(rate)),
            "SAMPLED_SLOWLY|NO_FORCE", "SAMPLED_SLOWLY", slow, skip=NO_FORCE,
        )  # fmt: skip
    said = "FLAGS_INVERTED"
    for name, walk in (("walk", WALK), ("trot", TROT)):
        yield Case(
            f"inverted flags, {name}", recorder(walk, foot.as_flags, foot.inverted()), said, said,
            skip=NO_FORCE, classes=(None,),
        )  # fmt: skip
    yield Case(
        "inverted flags of one foot", recorder(WALK, foot.as_flags, foot.inverted("back_left")),
        said, said, skip=NO_FORCE,
    )  # fmt: skip


def others() -> Iterator[Case]:
    """Scuffs, filters, payloads, moving ground."""
    hind = "back_left", "back_right"
    yield Case(
        "hind feet scuff, bumpers", recorder(WALK, foot.scuffs(12.0, 0.03, *hind)),
        says="", skip=("contact fraction", "touchdowns", "lift-offs", "verdict"),
    )  # fmt: skip
    yield Case(
        "hind feet scuff, force sensors",
        recorder(WALK, FORCE, sensor.noise(0.5), foot.scuffs(12.0, 0.03, *hind)),
        skip=("contact fraction", "touchdowns", "lift-offs", "verdict"),
    )  # fmt: skip
    for cutoff in (5.0, 10.0):
        yield Case(
            f"forces filtered at {cutoff:g} Hz",
            recorder(WALK, FORCE, foot.filtered(cutoff), sensor.noise(0.2)),
            "FILTERED", "FILTERED", skip=("peak force", "braking"),
        )  # fmt: skip
    yield Case(
        "a payload put down", recorder(TROT, foot.payload(4.0, 0.75)), "PAYLOAD|WEIGHT", "PAYLOAD|WEIGHT",
        skip=("peak force", "impulse", "braking"),
    )  # fmt: skip
    tread = ("height", "froude", "slip", "margin", "verdict")
    yield Case(
        "treadmill, contact points",
        recorder(TROT, foot.treadmill),
        "TREADMILL",
        "TREADMILL",
        skip=tread,
    )
    yield Case(
        "treadmill, places in the base", recorder(TROT, pose.feet_in_base, foot.treadmill), "TREADMILL", "TREADMILL",
        skip=(*NO_FORCE, *tread),
    )  # fmt: skip
    yield Case(
        "one instrumented foot", recorder(TROT, lambda r: __import__("dataclasses").replace(r, unrecorded=r.robot.feet[1:]), sensor.wrong_mass(None)),
        "NO_MESSAGES|MASS", "", skip=("verdict",), classes=(None,),
    )  # fmt: skip
