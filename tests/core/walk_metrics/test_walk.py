"""The records of a walk's metrics, and why some of them are null."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pytest

from dogbot_logtool.core.metrics import NEEDS, WalkMetrics
from dogbot_logtool.core.records import values
from dogbot_logtool.core.settings import WalkSettings
from dogbot_logtool.core.walk import Walk as MeasuredWalk
from dogbot_logtool.finding import Finding
from dogbot_logtool.options import MeasureOptions
from tests.analysed import analysed
from tests.measured import LogFacts, measured, measurement_of
from tests.oracles.straight_walk import Walk
from tests.paths import TROT, TROUBLED


def metrics(walk: MeasuredWalk, findings: Sequence[Finding] = ()) -> WalkMetrics:
    return measurement_of(walk, LogFacts(findings=findings)).metrics


def nulls(walk: WalkMetrics) -> set[str]:
    """Paths of the metrics that are null though a log may have them."""
    found = [(path, field) for path, value, field in values(walk) if value is None]
    return {".".join(path) for path, field in found if field.of.needs}


def test_what_decided_the_metrics_is_told() -> None:
    walk = Walk().measure()
    settings = metrics(replace(walk, settings=replace(walk.settings, robot="spot"))).settings

    assert (settings.robot, settings.robot_guessed) == ("spot", False)
    assert (settings.base_from, settings.contact_from, settings.clock) == (
        "pose",
        "sensor",
        "header",
    )
    assert metrics(analysed(WalkSettings(()))).settings.contact_from is None


@pytest.mark.parametrize("seconds", [3.0, 10.0])
def test_few_strides_are_little_confidence(seconds: float) -> None:
    gait = metrics(Walk(seconds=seconds).measure()).gait

    assert gait.name == "trot"
    assert gait.class_distance is not None
    assert gait.strides
    least = min(phase.consistency or 0.0 for phase in gait.phase.values())
    fit = (1.0 - gait.class_distance / 0.2) * least
    assert gait.confidence == pytest.approx(fit * min(1.0, gait.strides / 3))


def test_a_finding_voids_metrics_of_the_log_and_of_its_segments() -> None:
    doubt = Finding("DEAD", "it is dead", "feet.front_left", feet=("front_left",))
    walk = metrics(Walk().measure(), [doubt])

    for feet in (walk.feet, *(each.feet for each in walk.gait.segments)):
        assert feet["front_left"].stance_s is None
        assert feet["front_right"].stance_s is not None
    assert walk.null_because["feet.front_left.stance_s"] == "DEAD"
    assert next(each for each in walk.findings if each.code == "DEAD").voids == doubt.voids


@pytest.mark.parametrize("log", [TROT, TROUBLED], ids=lambda path: path.stem)
def test_every_null_has_a_reason(log: Path) -> None:
    walk = measured(log, MeasureOptions()).metrics
    of_whole = {path for path in nulls(walk) if not path.startswith("gait.segments.")}

    assert of_whole == {p for p in walk.null_because if not p.startswith("gait.segments.")}
    for path in nulls(walk) - of_whole:
        below = path.split(".", 3)[3]
        assert path in walk.null_because or below in walk.null_because


def test_reasons_are_what_the_log_lacks() -> None:
    because = metrics(Walk().measure()).null_because

    assert because["legs.absolute_work_j"] == NEEDS["joints"]
    assert because["feet.front_left.clearance_m"] == NEEDS["foot frame"]
    assert because["feet.front_left.planned"] == NEEDS["plan"]
    assert because["commands.topic"] == NEEDS["commands"]
    assert because["imu.tilt_rad"] == NEEDS["imu"]
    assert because["gait.double_support_fraction"] == NEEDS["two feet"]
    assert because["gait.sequence"] == "does not apply"


def test_of_a_log_without_feet_that_is_the_reason() -> None:
    because = metrics(analysed(WalkSettings(()))).null_because

    assert {because["gait.name"], because["forces.load_share.fore"]} == {NEEDS["feet"]}
    assert because["base.path_length_m"] == NEEDS["base"]
