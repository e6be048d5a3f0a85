"""Logs of robots that do not walk, or not only."""

from collections.abc import Callable, Iterator
from dataclasses import replace

from tests.truth import gaits, scenes
from tests.truth import sensor_faults as sensor
from tests.truth.judging import Case
from tests.truth.recorders import FORCE, RATE_HZ
from tests.truth.recording import Disturbance, Recording, disturbed
from tests.truth.sequences import then
from tests.truth.walking import Walk


def no_steps() -> Iterator[Case]:
    wheels = "without steps|wheel"
    yield _scene("standing", scenes.standing())
    yield _scene("standing, force sensors", scenes.standing(), FORCE, sensor.noise(0.5))
    yield _scene("shifting weight", scenes.shifting_weight())
    yield _scene(
        "shifting weight, force sensors", scenes.shifting_weight(), FORCE, sensor.noise(0.5)
    )
    yield _scene("crouching", scenes.crouching())
    yield _scene("sitting down", scenes.sitting_down(), skip=("verdict",))
    yield _scene("standing up", scenes.standing_up(), skip=("verdict",))
    yield _scene(
        "carried",
        scenes.carried(),
        says=r"_CARRIED|_LIFTED|\bcarried|\blifted",
        classes=("stand", None),
        skip=("path", "speed"),
    )
    yield _scene("falling", scenes.falling(), says="FALL", skip=("class",))
    yield _scene("tipping", scenes.tipping(), says=r"\btip")
    yield _scene("rolling on wheels", scenes.rolling(), says=wheels, cause=wheels)
    yield _scene(
        "rolling on wheels, force sensors", scenes.rolling(), FORCE, sensor.noise(0.5),
        says=wheels, cause=wheels,
    )  # fmt: skip


def _scene(name: str, scene: scenes.Scene, *more: Disturbance, **judged: object) -> Case:
    return Case(name, lambda: disturbed(scene.recorded(RATE_HZ), *more), **judged)  # type: ignore[arg-type]


def sequences() -> Iterator[Case]:
    def walk_then(scene: scenes.Scene) -> Callable[[], Recording]:
        return lambda: then(Walk(seconds=12.0).recorded(RATE_HZ), scene.recorded(RATE_HZ))

    def after(first: Walk, *others: scenes.Scene | Walk, segments: tuple[str, ...]) -> Recording:
        recording = first.recorded(RATE_HZ)
        for each in others:
            recording = then(recording, each.recorded(RATE_HZ))
        return replace(recording, truth=replace(recording.truth, segments=segments))

    # Where one log ends and the next begins, feet stand elsewhere at once.
    whole = ("contact fraction", "load share", "impulse", "margin", "stride length")
    yield Case(
        "walk, then a fall", walk_then(scenes.falling()), says="FALL", skip=(*whole, "lift-offs")
    )
    yield Case(
        "walk, then carried",
        walk_then(scenes.carried()),
        says=r"_CARRIED|_LIFTED|\bcarried|\blifted",
        skip=whole,
    )
    yield Case(
        "walk, then sitting down", walk_then(scenes.sitting_down()), skip=(*whole, "verdict")
    )
    yield Case("walk, then crouching", walk_then(scenes.crouching()), skip=whole)
    trot, walk = Walk(seconds=12.0), Walk(gait=gaits.WALK, seconds=9.0, period_s=1.0)
    yield Case(
        "a trot, then a walk",
        lambda: after(trot, walk, segments=("trot", "walk")),
        skip=(*whole, "duty factor", "peak force", "braking"),
    )
    yield Case(
        "a trot, then standing",
        lambda: after(trot, scenes.standing(), segments=("trot", "stand")),
        skip=(*whole, "verdict"),
    )
