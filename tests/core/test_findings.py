"""The records of metrics, why some are null, what is checked, and what each finding voids."""

from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from dogbot_logtool.core.checks.engine import void_columns
from dogbot_logtool.core.metrics import NEEDS, Stride, WalkMetrics
from dogbot_logtool.core.records import fields_of, metric_paths, values
from dogbot_logtool.finding import Finding, FindingKind, Severity, finding_kinds, found
from tests.measured import measured, measurement_of
from tests.paths import TROT, TROUBLED
from tests.truth import scenes
from tests.truth.outcome import outcome
from tests.truth.recording import Disturbance, disturbed
from tests.truth.scenes import then
from tests.truth.walking import Walk

PATHS = list(metric_paths(WalkMetrics))


WORDS = {"%": "percent", "B": "bytes", "1e-6": "ppm", "N/min": "n_per_min"}


def suffix_of(unit: str) -> str:
    """The end of a name that tells a unit: m/s^2 is mps2."""
    return WORDS.get(unit) or unit.lower().replace("/s", "ps").translate({32: None, 94: None})


def test_a_metric_tells_its_definition_its_unit_and_what_it_needs() -> None:
    suffixes = {suffix_of(field.of.unit): field.of.unit for _, field, _ in PATHS if field.of.unit}
    for path, field, words in PATHS:
        key = path.removesuffix(".*").rsplit(".", 1)[-1]
        suffix = max((each for each in suffixes if key.endswith(f"_{each}")), key=len, default="")
        assert words, path
        assert set(field.of.needs) <= NEEDS.keys(), path
        assert not suffix or field.of.unit in {suffixes[suffix], "%"}, path


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


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("logs")


def checks(folder: Path, *faults: Disturbance, seconds: float = 16.0) -> dict[str, dict[str, Any]]:
    """What is checked of a walk, by name."""
    found = outcome(disturbed(Walk(seconds=seconds).recorded(), *faults), folder)
    return {check["name"]: check for check in found.json["quality"]["checks"]}


def test_a_sound_walk_passes_every_check_and_every_check_can_fail(folder: Path) -> None:
    found = {name: check["outcome"] for name, check in checks(folder).items()}
    failing = {name for kind in finding_kinds().values() for name in kind.fails or ()}
    cases = (case for kind in finding_kinds().values() for case in kind.cases.values())
    assert failing | {name for case in cases for name in case.fails or ()} == found.keys()
    for name in ("the legs move as the feet step", "nothing contradicts the accelerometer"):
        assert found.pop(name) == "does not apply"
    assert set(found.values()) == {"passed"}


def test_every_warning_about_metrics_says_which_checks_fail() -> None:
    of_pictures = {"Frames and transforms", "Arrows and support"}
    for code, kind in finding_kinds().items():
        is_about_metrics = kind.severity is Severity.WARNING and kind.subject not in of_pictures
        assert (kind.fails is not None) or not is_about_metrics, code


def test_the_weight_that_the_belly_of_a_robot_takes_is_no_load_taken_off(folder: Path) -> None:
    walk, sits = Walk(seconds=12.0).recorded(250.0), scenes.sitting_down().recorded(250.0)
    assert not outcome(then(walk, sits), folder).says("PAYLOAD")


NAMES = [
    *(path for path, *_ in PATHS),
    *(f"feet.front_left.{field.name}" for field in fields_of(Stride)),
]


def patterns(kind: FindingKind) -> dict[str, set[str]]:
    """What a finding voids, by its case; without a case as ''."""
    found = {case: set(each.voids) for case, each in kind.cases.items() if each.voids}
    return ({"": set(kind.voids)} if kind.voids else {}) | found


def test_every_pattern_voids_a_metric() -> None:
    for kind in finding_kinds().values():
        for pattern in set().union(*patterns(kind).values()):
            own = pattern.replace("{foot}", "*")
            assert any(fnmatchcase(path, own) for path in NAMES), (kind.code, pattern)


@pytest.mark.parametrize(
    ("code", "case", "voids"),
    [
        ("CLOCK_OFFSET", "feet", {"gait.*", "stability.*"}),
        ("DEAD", "", {"feet.{foot}.*", "gait.support*", "stability.*", "forces.load_share.*"}),
        ("CONTACT_UNKNOWN", "", {"feet.{foot}.*", "gait.*", "stability.*", "forces.*"}),
        ("SATURATED", "", {"feet.{foot}.peak_*"}),
        ("WORLDS_DIFFER", "", {"base.height_m", "base.froude"}),
        ("WORLDS_DIFFER", "aside", {"stability.*"}),
        ("COMMAND_AXES", "unknown", {"commands.forward.*", "commands.lateral.*"}),
        ("IMPULSE_IS_NOT_WEIGHT", "vertical", {"feet.*.*vertical*"}),
    ],
)
def test_what_the_design_says_is_voided(code: str, case: str, voids: set[str]) -> None:
    assert voids <= patterns(finding_kinds()[code])[case]


def test_masks_void_nothing() -> None:
    masks = ("GAPS", "CLOCK_SET", "LIFTED", "FALL", "POSE_JUMP")
    assert [code for code in masks if patterns(finding_kinds()[code])] == []


def test_columns_of_tables_are_voided_by_the_same_patterns() -> None:
    columns = {name: np.ones(2) for name in ("length_m", "peak_force_n")}
    found = [
        Finding("SATURATED", "", feet=("left",)),
        Finding("CLOCK_OFFSET", "", cases=("base",), feet=("left", "right")),
    ]
    left, right = (void_columns(columns, foot, found) for foot in ("left", "right"))
    assert all(np.isnan(each).all() for each in left.values())
    assert right["peak_force_n"].tolist() == [1.0, 1.0]
    assert np.isnan(right["length_m"]).all()


def test_numbers_have_their_nouns() -> None:
    texts = [found("SPIKES", foot="left", spikes=number).text for number in (1, 2)]
    assert [text.split(" in ")[0] for text in texts] == ["1 lone spike", "2 lone spikes"]
