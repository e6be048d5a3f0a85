"""What is checked of a walk, what each finding says, and what it voids."""

import ast
from collections.abc import Iterator
from fnmatch import fnmatchcase
from pathlib import Path
from string import Formatter
from typing import Any

import numpy as np
import pytest

from dogbot_logtool.core.checks.engine import void_columns
from dogbot_logtool.core.metrics import Stride, WalkMetrics
from dogbot_logtool.core.records import fields_of, metric_paths
from dogbot_logtool.finding import Finding, FindingKind, Severity, finding_kinds, found
from tests.paths import ROOT
from tests.truth import scenes
from tests.truth.outcome import outcome
from tests.truth.recording import Disturbance, disturbed
from tests.truth.scenes import then
from tests.truth.time_faults import late_clock
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


def test_a_failed_check_names_its_finding(folder: Path) -> None:
    found = checks(folder, late_clock(0.2)).values()
    (failed,) = [check for check in found if check["outcome"] == "failed"]
    assert failed["name"] == "all topics have one clock"
    assert "/odom" in failed["reason"]


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


CHECKS = ROOT / "dogbot_logtool" / "core" / "checks"


def calls() -> Iterator[tuple[str, ast.Call, set[str]]]:
    """Each call of `found`, where it stands, and the names of the values that it gives."""
    for file in sorted(CHECKS.glob("*.py")):
        tree = ast.parse(file.read_text(encoding="utf-8"))
        for function in (each for each in tree.body if isinstance(each, ast.FunctionDef)):
            words: set[str] = set()
            for node in sorted(ast.walk(function), key=lambda each: getattr(each, "lineno", 0)):
                if isinstance(node, ast.Assign | ast.AnnAssign) and isinstance(
                    node.value, ast.Dict
                ):
                    words = {key for each in node.value.keys if each for key in strings(each)}
                if getattr(getattr(node, "func", None), "id", "") in {"found", "_doubted"}:
                    assert isinstance(node, ast.Call)
                    gives = {each.arg for each in node.keywords if each.arg}
                    extra = words if len(gives) < len(node.keywords) else set()
                    if function.name != "_doubted":
                        yield f"{file.stem}:{node.lineno}", node, gives | extra


def strings(node: ast.AST) -> set[str]:
    constants = (each.value for each in ast.walk(node) if isinstance(each, ast.Constant))
    return {each for each in constants if isinstance(each, str)}


def test_a_check_tells_what_its_sentence_names() -> None:
    texts = {code: kind.texts for code, kind in finding_kinds().items()}
    for where, call, gives in calls():
        told = gives - {"say", "feet"}
        told |= {"foot"} if "feet" in gives else set()
        named = {
            (code, name): {field.split(".")[0] for _, field, *_ in Formatter().parse(text) if field}
            for code in strings(call) & texts.keys() or texts.keys()
            for name, text in texts[code].items()
        }
        assert any(fields <= told for fields in named.values()), (where, told, named)
        said = [each.value for each in call.keywords if each.arg == "say"]
        for key in named if said else ():
            assert key[1] not in strings(said[0]) or named[key] <= told, (where, key)


def test_attributes_that_sentences_name_are_those_of_records() -> None:
    core = ROOT / "dogbot_logtool" / "core"
    records = (
        node
        for file in core.rglob("*.py")
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8")))
        if isinstance(node, ast.ClassDef)
    )
    members = {name for record in records for each in record.body for name in names(each)}
    for code, kind in finding_kinds().items():
        for text in kind.texts.values():
            for _, field, *_ in Formatter().parse(text):
                assert {*(field or "").split(".")[1:]} <= members, (code, field)


def names(node: ast.stmt) -> list[str]:
    """Return the name of a field or a property."""
    if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
        return [node.target.id]
    return [node.name] if isinstance(node, ast.FunctionDef) else []


def test_numbers_have_their_nouns() -> None:
    texts = [found("SPIKES", foot="left", spikes=number).text for number in (1, 2)]
    assert [text.split(" in ")[0] for text in texts] == ["1 lone spike", "2 lone spikes"]
