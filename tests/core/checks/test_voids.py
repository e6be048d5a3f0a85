"""What each finding voids, against the metrics that there are."""

from fnmatch import fnmatchcase

import numpy as np
import pytest

from dogbot_logtool.core.checks.engine import void_columns
from dogbot_logtool.core.metrics import Stride, WalkMetrics
from dogbot_logtool.core.records import fields_of, metric_paths
from dogbot_logtool.finding import Finding, FindingKind, finding_kinds

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


def test_findings_are_few() -> None:
    assert len(finding_kinds()) <= 90


def test_the_feet_are_filled_in() -> None:
    finding = Finding("SATURATED", "", feet=("left", "right"))
    assert finding.voids[:2] == ("feet.left.peak_*", "feet.right.peak_*")


def test_cases_add_to_what_is_voided() -> None:
    finding = Finding("STUCK", "", cases=("never_lifts",), feet=("left",))
    assert finding.voids[-1] == "feet.left.*"
    assert "forces.load_share.*" in finding.voids


@pytest.mark.parametrize(
    ("code", "case", "voids"),
    [
        ("CLOCK_OFFSET", "feet", {"gait.*", "stability.*"}),
        ("DEAD", "", {"feet.{foot}.*", "gait.support*", "stability.*", "forces.load_share.*"}),
        ("CONTACT_UNKNOWN", "", {"feet.{foot}.*", "gait.*", "stability.*", "forces.*"}),
        ("SATURATED", "", {"feet.{foot}.peak_*"}),
        ("WORLDS_DIFFER", "", {"base.height_m", "base.froude"}),
        ("WORLDS_DIFFER", "aside", {"stability.*"}),
        ("HEIGHT_DRIFTS", "", {"base.height_m", "base.climb_m", "base.froude"}),
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
    masks = ("GAPS", "CLOCK_SET", "ALL_FEET_SILENT", "LIFTED", "FALL", "POSE_JUMP")
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
