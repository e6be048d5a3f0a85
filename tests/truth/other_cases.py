"""Logs of robots that do not walk, or not only."""

from collections.abc import Iterator
from dataclasses import replace

from tests.truth import pose_faults as pose
from tests.truth import scenes
from tests.truth import sensor_faults as sensor
from tests.truth.judging import Case, Event
from tests.truth.scenes import OneAfterAnother
from tests.truth.walking import Walk
from tests.truth.walks import QUIET, SENSED, WALK

WHEELS = "without steps|wheel"
CARRIED = r"_CARRIED|_LIFTED|\bcarried|\blifted"


def changes(onset_s: float, code: str, within_s: float = 0.8) -> Event:
    """Let the gait change: from one class > to another."""
    return Event("gait_change", onset_s, within_s, code=code)


# fmt: off
def no_steps() -> Iterator[Case]:
    yield Case("standing", scenes.standing())
    yield Case("standing, force sensors", scenes.standing(), QUIET)
    yield Case("standing, noisy poses", scenes.standing(), (pose.pose_noise(0.002),), events=())
    yield Case("shifting weight", scenes.shifting_weight())
    yield Case("shifting weight, force sensors", scenes.shifting_weight(), QUIET)
    yield Case("crouching", scenes.crouching())
    yield Case("sitting down", scenes.sitting_down(), skip="verdict")
    yield Case("standing up", scenes.standing_up(), skip="verdict")
    yield Case("falling", scenes.falling(), (), "FALL", "", skip="class")
    yield Case("tipping", scenes.tipping(), (), r"\btip", "",
               events=(Event("tipping", 7.0, 1.0, code="FALL", value=(0.35, 0.01)),))
    yield Case("rolling on wheels", scenes.rolling(), (), WHEELS)
    yield Case("rolling on wheels, force sensors", scenes.rolling(), QUIET, WHEELS)
    for newtons in (-60.0, -20.0, 20.0):
        yield Case(f"rolling on wheels, offset {newtons:+g} N", scenes.rolling(),
                   (*QUIET, sensor.offset(newtons)), WHEELS)


def in_the_air() -> Iterator[Case]:
    lifted = Event("carried", 2.0, 0.06, duration_s=4.0, value=(0.55, 0.05))
    for name, faults, more in (
        ("carried", (), ""),
        ("carried, force sensors", SENSED, "|WITHOUT_STEPS"),
        ("carried while the legs move", (*SENSED, sensor.inertia(6.0)), "|WITHOUT_STEPS"),
        ("carried while the legs move fast", (*SENSED, sensor.inertia(14.0)), "|WITHOUT_STEPS"),
    ):
        yield Case(name, scenes.carried(), faults, CARRIED + more, "", classes=("stand", None),
                   skip="path, speed", events=None if faults else (lifted,))
    for name, faults in (("bumpers", ()), ("force sensors", SENSED)):
        yield Case(f"sitting, no foot loaded, {name}", scenes.sitting(), faults, classes=(None,),
                   skip="verdict")


def sequences() -> Iterator[Case]:
    # Where one log ends and the next begins, feet stand elsewhere at once.
    whole = "contact fraction, load share, impulse, margin, stride length"
    trot, walk = Walk(seconds=12.0), replace(WALK, seconds=9.0)
    stops = changes(12.0, "trot>stand", 0.1)
    lifted = Event("carried", 14.0, 0.06, duration_s=4.0, value=(0.55, 0.05))
    for name, scene, says, skip, also in (
        ("a fall", scenes.falling(), "FALL", "lift-offs", ()),
        ("carried", scenes.carried(), CARRIED, "", (lifted,)),
        ("sitting down", scenes.sitting_down(), "", "verdict", ()),
        ("crouching", scenes.crouching(), "", "", ()),
    ):
        yield Case(f"walk, then {name}", OneAfterAnother((trot, scene)), (), says, "",
                   skip=f"{whole}, {skip}", events=(stops, *also))
    for name, first, second, classes, skip, event in (
        ("a trot, then a walk", trot, walk, ("trot", "walk"), "duty factor, peak force, braking",
         changes(12.0, "trot>walk")),
        ("a trot, then standing", trot, scenes.standing(), ("trot", "stand"), "verdict", stops),
    ):
        yield Case(name, OneAfterAnother((first, second), classes), skip=f"{whole}, {skip}",
                   events=(event,))

# fmt: on
