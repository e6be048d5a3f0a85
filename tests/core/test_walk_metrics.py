"""The records of metrics, what is made of them, and why some are null."""

from pathlib import Path

import pytest

from dogbot_logtool.core.metrics import NEEDS, WalkMetrics
from dogbot_logtool.core.records import metric_paths, values
from dogbot_logtool.finding import Finding
from tests.measured import measured, measurement_of
from tests.paths import TROT, TROUBLED
from tests.truth.outcome import outcome
from tests.truth.walking import Walk

SUFFIXES = {
    "_s": "s",
    "_m": "m",
    "_n": "N",
    "_ns": "N s",
    "_bw": "BW",
    "_kg": "kg",
    "_j": "J",
    "_hz": "Hz",
    "_mps": "m/s",
    "_mps2": "m/s^2",
    "_radps": "rad/s",
    "_rad": "rad",
    "_nps": "N/s",
    "_ppm": "1e-6",
    "_percent": "%",
    "_bytes": "B",
    "_n_per_min": "N/min",
}
PATHS = list(metric_paths(WalkMetrics))


def test_a_metric_tells_its_definition_its_unit_and_what_it_needs() -> None:
    for path, field, words in PATHS:
        key = path.removesuffix(".*").rsplit(".", 1)[-1]
        suffix = max((each for each in SUFFIXES if key.endswith(each)), key=len, default="")
        assert words, path
        assert set(field.of.needs) <= NEEDS.keys(), path
        assert not suffix or field.of.unit in {SUFFIXES[suffix], "%"}, path


def test_every_need_is_one_of_some_metric() -> None:
    assert {need for _, field, _ in PATHS for need in field.of.needs} == NEEDS.keys()


def test_the_whole_log_and_a_segment_have_the_same_metrics() -> None:
    paths = {path for path, _, _ in PATHS}
    in_segments = {each.removeprefix("gait.segments[].") for each in paths if "segments[]" in each}
    assert in_segments - {"start_s", "end_s"} <= paths


def nulls(walk: WalkMetrics) -> set[str]:
    """Paths of the metrics that are null though a log may have them."""
    found = [(path, field) for path, value, field in values(walk) if value is None]
    return {".".join(path) for path, field in found if field.of.needs}


def test_few_strides_are_little_confidence(tmp_path: Path) -> None:
    gait = outcome(Walk(seconds=3.0).recorded(), tmp_path).json["gait"]

    least = min(phase["consistency"] or 0.0 for phase in gait["phase"].values())
    fit = (1.0 - gait["class_distance"] / 0.2) * least
    assert gait["strides"] < 3
    assert gait["confidence"] == pytest.approx(fit * gait["strides"] / 3)


def test_a_finding_voids_metrics_of_the_log_and_of_its_segments() -> None:
    doubt = Finding("DEAD", "it is dead", "feet.front_left", feet=("front_left",))
    walk = measurement_of(measured(TROT).walk, findings=[doubt]).metrics

    for feet in (walk.feet, *(each.feet for each in walk.gait.segments)):
        assert feet["front_left"].stance_s is None
        assert feet["front_right"].stance_s is not None
    assert walk.null_because["feet.front_left.stance_s"] == "DEAD"
    assert next(each for each in walk.findings if each.code == "DEAD").voids == doubt.voids


@pytest.mark.parametrize("log", [TROT, TROUBLED], ids=lambda path: path.stem)
def test_every_null_has_a_reason(log: Path) -> None:
    walk = measured(log).metrics
    of_whole = {path for path in nulls(walk) if not path.startswith("gait.segments.")}

    assert of_whole == {p for p in walk.null_because if not p.startswith("gait.segments.")}
    for path in nulls(walk) - of_whole:
        below = path.split(".", 3)[3]
        assert path in walk.null_because or below in walk.null_because
