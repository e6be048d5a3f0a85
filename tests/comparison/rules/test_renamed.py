"""Metrics that had another key before schema 3."""

import pytest

from dogbot_logtool.comparison.rules.limits import parse_limits
from dogbot_logtool.comparison.rules.renamed import RENAMED, new_name
from dogbot_logtool.core.metrics import WalkMetrics
from dogbot_logtool.core.records import metric_paths
from dogbot_logtool.errors import CallError

PATHS = {path for path, _, _ in metric_paths(WalkMetrics)}


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("gait.class", "gait.name"),
        ("legs.feet.*.clearance_m.median", "feet.*.clearance_m.median"),
        ("legs.feet.left.clearance_m.max", "feet.left.clearance_m.max"),
        ("gait.phase_left_hind.left.mean", "gait.phase.left.left_hind"),
        ("quality.topics.*.gaps.total_s", "quality.topics.*.gaps_total_s"),
        ("feet.*.slip_m.max", ""),
        ("gait.*", ""),
    ],
)
def test_a_key_of_before_has_its_new_name(old: str, new: str) -> None:
    assert new_name(old) == new


@pytest.mark.parametrize("new", sorted(set(RENAMED.values())))
def test_new_names_are_metrics_or_groups_of_them(new: str) -> None:
    assert any(f"{path}.".startswith(f"{new}.") for path in PATHS)


@pytest.mark.parametrize("old", sorted(RENAMED))
def test_old_names_are_no_metrics(old: str) -> None:
    assert old not in PATHS


def test_a_rule_on_a_key_of_before_is_refused_with_the_new_one() -> None:
    with pytest.raises(CallError, match=r"rule 1: gait\.class is now gait\.name"):
        parse_limits('[[rule]]\nfigure = "gait.class"\nequals = "trot"', "limits.toml")
