"""What is checked of a walk, what each finding says, and what it voids."""

from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from dogbot_logtool.core.checks.engine import void_columns
from dogbot_logtool.core.metrics import Stride, WalkMetrics
from dogbot_logtool.core.records import fields_of, metric_paths
from dogbot_logtool.finding import Finding, FindingKind, Severity, finding_kinds, found
from tests.truth import scenes
from tests.truth.outcome import outcome
from tests.truth.recording import Disturbance, disturbed
from tests.truth.scenes import then
from tests.truth.walking import Walk


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


PATHS = [
    *(path for path, *_ in metric_paths(WalkMetrics)),
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
            assert any(fnmatchcase(path, own) for path in PATHS), (kind.code, pattern)


@pytest.mark.parametrize(
    ("code", "case", "voids"),
    [
        ("CLOCK_OFFSET", "feet", {"gait.*", "stability.*"}),
        ("DEAD", "", {"feet.{foot}.*", "gait.support*", "stability.*", "forces.load_share.*"}),
        ("CONTACT_UNKNOWN", "", {"feet.{foot}.*", "gait.*", "stability.*", "forces.*"}),
        ("SATURATED", "", {"feet.{foot}.peak_*"}),
        ("WORLDS_DIFFER", "", {"base.height_m", "base.froude"}),
        ("WORLDS_DIFFER", "aside", {"stability.*"}),
        ("WORLDS_DIFFER", "drifts", {"base.climb_m", "stability.energy_margin_m"}),
        ("UP_AXIS", "", {"base.*", "stability.*"}),
        ("SIDES_SWAPPED", "one_pair", {"gait.name", "gait.sequence"}),
        ("COMMAND_AXES", "unknown", {"commands.forward.*", "commands.lateral.*"}),
        ("EFFORT_SIGN", "", {"legs.positive_work_j"}),
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
