"""What rules come to on figures, findings and events."""

from typing import Any, Final

import pytest

from dogbot_logtool.comparison.judge import Judgement, Status, figures_in, judge, worst
from dogbot_logtool.comparison.limits import parse_limits

LOG: Final[dict[str, Any]] = {
    "schema_version": 2,
    "findings": [
        {"code": "W_SLIP", "severity": "warning", "text": "left slips", "where": "feet.left"},
        {"code": "MASS_UNKNOWN", "severity": "note", "text": "no mass", "where": "forces.ratio"},
    ],
    "feet": {
        "left": {"duty_factor": {"median": 0.71, "max": 0.9}, "slip_m": {"max": 0.02}},
        "right": {"duty_factor": None, "slip_m": {"max": 0.001}},
    },
    "forces": {"ratio": None},
    "gait": {
        "name": "trot",
        "running": False,
        "segments": [
            {"start_s": 0.0, "end_s": 4.0, "gait": {"name": "walk", "duty_factor": 0.8}},
            {"start_s": 4.0, "end_s": 9.0, "gait": {"name": "trot", "duty_factor": 0.6}},
        ],
    },
    "events": [
        {"onset_s": 3.25, "type": "slip", "foot": "left"},
        {"onset_s": 7.5, "type": "slip", "foot": "left"},
    ],
}


def judged(lines: str, baseline: dict[str, Any] | None = None) -> list[Judgement]:
    return judge(LOG, parse_limits(f"[[rule]]\n{lines}", "limits.toml"), baseline)


def statuses(lines: str, baseline: dict[str, Any] | None = None) -> dict[str, Status]:
    return {found.figure: found.status for found in judged(lines, baseline)}


def test_each_figure_that_fits_is_judged() -> None:
    assert statuses('figure = "feet.*.slip_m.max"\nat_most = 0.005') == {
        "feet.left.slip_m.max": Status.FAIL,
        "feet.right.slip_m.max": Status.GOOD,
    }


def test_a_null_says_why_and_its_reason_is_no_figure() -> None:
    log = {
        "feet": {"left": {"slip_m": None}},
        "null_because": {"feet.left.slip_m": "no contact points"},
    }
    (found,) = judge(log, parse_limits('[[rule]]\nfigure = "*slip_m*"\nat_most = 1', ""), None)
    assert (found.figure, found.status) == ("feet.left.slip_m", Status.UNKNOWN)
    assert found.look == "no contact points"


@pytest.mark.parametrize(
    ("value", "status"),
    [(0.7, Status.FAIL), (0.71, Status.GOOD), (0.9, Status.GOOD), (0.9001, Status.FAIL)],
)
def test_both_ends_of_a_range_are_good(value: float, status: Status) -> None:
    log = {"a": value}
    (found,) = judge(log, parse_limits('[[rule]]\nfigure="a"\nbetween=[0.71, 0.9]', ""), None)
    assert found.status is status


def test_a_figure_below_a_null_is_unknown() -> None:
    assert statuses('figure = "feet.*.duty_factor.median"\nbetween = [0.7, 0.8]') == {
        "feet.left.duty_factor.median": Status.GOOD,
        "feet.right.duty_factor.median": Status.UNKNOWN,
    }


@pytest.mark.parametrize(
    ("null", "status"),
    [("unknown", Status.UNKNOWN), ("fail", Status.FAIL), ("pass", Status.GOOD)],
)
def test_a_rule_says_what_a_null_means(null: str, status: Status) -> None:
    (found,) = judged(f'figure = "forces.ratio"\nat_most = 1\nnull = "{null}"')

    assert (found.status, found.value, found.look) == (status, None, "no mass")


def test_a_figure_that_no_log_has_is_unknown() -> None:
    (found,) = judged('figure = "feet.left.slip_m.maxi"\nat_most = 1')
    assert (found.status, found.look) == (
        Status.UNKNOWN,
        (
            "no figure of this log is called so; near it are feet.left.slip_m.max, "
            "feet.right.slip_m.max"
        ),
    )


def test_a_level_of_warn() -> None:
    assert statuses('figure = "feet.left.slip_m.max"\nat_most = 0.005\nlevel = "warn"') == {
        "feet.left.slip_m.max": Status.WARN
    }


def test_findings_that_concern_a_bad_figure_say_where_to_look() -> None:
    (found,) = judged('figure = "feet.left.slip_m.max"\nat_most = 0.005')
    assert found.look == "left slips"


def test_texts_and_flags_are_equal_or_not() -> None:
    assert statuses('figure = "gait.name"\nequals = "trot"') == {"gait.name": Status.GOOD}
    assert statuses('figure = "gait.name"\nequals = "walk"') == {"gait.name": Status.FAIL}
    assert statuses('figure = "gait.running"\nequals = false') == {"gait.running": Status.GOOD}


@pytest.mark.parametrize(
    ("rule", "look"),
    [
        ('"gait.name"\nat_most = 1', "no number"),
        ('"gait.name"\nequals = 1', "no number"),
        ('"feet.left.slip_m.max"\nequals = "0.01"', "a number, which the rule's value is not"),
    ],
)
def test_a_text_and_a_number_are_unknown_whatever_null_is(rule: str, look: str) -> None:
    (found,) = judged(f'figure = {rule}\nnull = "pass"\nlevel = "warn"')
    assert (found.status, found.look) == (Status.UNKNOWN, look)
    assert found.value is not None


def test_segments_of_one_class_only() -> None:
    (found,) = judged('figure = "gait.duty_factor"\nwhere = "walk"\nbetween = [0.7, 0.9]')

    assert (found.status, found.value) == (Status.GOOD, 0.8)
    assert found.figure == "segment 1 (0.0 to 4.0 s): gait.duty_factor"


def test_no_segment_of_a_class_is_unknown() -> None:
    (found,) = judged('figure = "gait.duty_factor"\nwhere = "pace"\nat_most = 1')
    assert (found.status, found.look) == (Status.UNKNOWN, "no segment is a pace")


def test_findings_are_counted_by_code() -> None:
    (found,) = judged('finding = "warning"')
    assert (found.status, found.value, found.look) == (Status.FAIL, 1, "left slips")
    assert judged('finding = "error"')[0].status is Status.GOOD
    assert judged('finding = "warning"\nat_most = 1')[0].status is Status.GOOD


def test_events_are_counted_and_their_times_told() -> None:
    (found,) = judged('event = "slip"\nat_most = 1')
    assert (found.status, found.value, found.look) == (Status.FAIL, 2, "at 3.25 s, 7.50 s")
    assert judged('event = "fall"')[0].status is Status.GOOD


def test_a_log_without_a_table_of_events_is_unknown() -> None:
    (found,) = judge({}, parse_limits('[[rule]]\nevent = "fall"', ""), None)
    assert found.status is Status.UNKNOWN


def test_a_baseline_gives_the_range() -> None:
    lines = 'figure = "feet.left.duty_factor.median"\nbaseline = { by_percent = 10 }'
    near = {"feet": {"left": {"duty_factor": {"median": 0.75}}}}
    far = {"feet": {"left": {"duty_factor": {"median": 0.80}}}}

    assert judged(lines, near)[0].status is Status.GOOD
    assert judged(lines, far)[0].status is Status.FAIL
    assert judged(lines, far)[0].demand == "within 10 % of the baseline, 0.8"
    assert judged(lines, {})[0].status is Status.UNKNOWN


def test_a_baseline_of_a_text_must_be_the_same() -> None:
    lines = 'figure = "gait.name"\nbaseline = { by = 0 }'
    assert judged(lines, {"gait": {"name": "trot"}})[0].status is Status.GOOD
    assert judged(lines, {"gait": {"name": "walk"}})[0].status is Status.FAIL


def test_the_worst_is_what_a_log_comes_to() -> None:
    rules = parse_limits(
        '[[rule]]\nfigure="gait.name"\nequals="trot"\n[[rule]]\nfigure="forces.ratio"\nat_most=1',
        "",
    )
    assert worst(judge(LOG, rules, None)) is Status.UNKNOWN
    assert worst([]) is Status.GOOD


def test_a_star_stands_for_dots_too() -> None:
    assert {path for path, _ in figures_in(LOG, "feet*max")} == {
        "feet.left.duty_factor.max",
        "feet.left.slip_m.max",
        "feet.right.slip_m.max",
    }
