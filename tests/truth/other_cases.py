"""Logs of robots that do not walk, or not only."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

from tests.truth import scenes
from tests.truth import sensor_faults as sensor
from tests.truth.judging import Case
from tests.truth.recording import Recording
from tests.truth.sequences import then
from tests.truth.walking import Walk
from tests.truth.walks import QUIET, SENSED, WALK

WHEELS = "without steps|wheel"
CARRIED = r"_CARRIED|_LIFTED|\bcarried|\blifted"


@dataclass(frozen=True, slots=True)
class Sequence:
    """One after another."""

    first: Walk
    then: scenes.Scene | Walk
    segments: tuple[str, ...] = ()

    def recorded(self, rate_hz: float) -> Recording:
        """Return the messages of perfect sensors."""
        recording = then(self.first.recorded(rate_hz), self.then.recorded(rate_hz))
        truth = replace(recording.truth, segments=self.segments)
        return replace(recording, truth=truth)


# fmt: off
def no_steps() -> Iterator[Case]:
    yield Case("standing", scenes.standing())
    yield Case("standing, force sensors", scenes.standing(), QUIET)
    yield Case("shifting weight", scenes.shifting_weight())
    yield Case("shifting weight, force sensors", scenes.shifting_weight(), QUIET)
    yield Case("crouching", scenes.crouching())
    yield Case("sitting down", scenes.sitting_down(), skip="verdict")
    yield Case("standing up", scenes.standing_up(), skip="verdict")
    yield Case("falling", scenes.falling(), (), "FALL", "", skip="class")
    yield Case("tipping", scenes.tipping(), (), r"\btip", "")
    yield Case("rolling on wheels", scenes.rolling(), (), WHEELS)
    yield Case("rolling on wheels, force sensors", scenes.rolling(), QUIET, WHEELS)
    for newtons in (-60.0, -20.0, 20.0):
        yield Case(f"rolling on wheels, offset {newtons:+g} N", scenes.rolling(),
                   (*QUIET, sensor.offset(newtons)), WHEELS)


def in_the_air() -> Iterator[Case]:
    for name, faults, more in (
        ("carried", (), ""),
        ("carried, force sensors", SENSED, "|WITHOUT_STEPS"),
        ("carried while the legs move", (*SENSED, sensor.inertia(6.0)), "|WITHOUT_STEPS"),
        ("carried while the legs move fast", (*SENSED, sensor.inertia(14.0)), "|WITHOUT_STEPS"),
    ):
        yield Case(name, scenes.carried(), faults, CARRIED + more, "", classes=("stand", None),
                   skip="path, speed")
    for name, faults in (("bumpers", ()), ("force sensors", SENSED)):
        yield Case(f"sitting, no foot loaded, {name}", scenes.sitting(), faults, classes=(None,),
                   skip="verdict")


def sequences() -> Iterator[Case]:
    # Where one log ends and the next begins, feet stand elsewhere at once.
    whole = "contact fraction, load share, impulse, margin, stride length"
    trot = Walk(seconds=12.0)
    for name, scene, says, skip in (
        ("a fall", scenes.falling(), "FALL", "lift-offs"),
        ("carried", scenes.carried(), CARRIED, ""),
        ("sitting down", scenes.sitting_down(), "", "verdict"),
        ("crouching", scenes.crouching(), "", ""),
    ):
        yield Case(f"walk, then {name}", Sequence(trot, scene), (), says, "",
                   skip=f"{whole}, {skip}")
    walk = replace(WALK, seconds=9.0)
    yield Case("a trot, then a walk", Sequence(trot, walk, ("trot", "walk")),
               skip=f"{whole}, duty factor, peak force, braking")
    yield Case("a trot, then standing", Sequence(trot, scenes.standing(), ("trot", "stand")),
               skip=f"{whole}, verdict")
# fmt: on
