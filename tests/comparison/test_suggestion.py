"""Limits that are suggested from good runs."""

import copy
from typing import Any, Final

import pytest

from dogbot_logtool.comparison.judge import Status, judge, worst
from dogbot_logtool.comparison.limits import parse_limits
from dogbot_logtool.comparison.suggestion import doubts, suggest_limits


def finding(code: str) -> dict[str, Any]:
    severity = "error" if code == "UNREADABLE" else "warning"
    return {"code": code, "severity": severity, "text": "", "where": ""}


def run(
    duty: float = 0.7, slip_m: float = 0.001, code: str = "", events: tuple[str, ...] = ()
) -> dict[str, Any]:
    """Return the figures of a run with two feet."""
    foot = {
        "duty_factor": {"median": duty},
        "stride_period_s": {"median": 1.1},
        "stride_length_m": {"median": 0.3},
        "peak_force_bw": {"median": 0.6},
        "slip_m": {"max": slip_m},
        "contact_fraction": duty,
        "contact_travel_m": {"median": 0.002},
    }
    return {
        "events": [{"type": event, "onset_s": 1.0} for event in events],
        "base": {"duration_s": 9.0},
        "findings": [finding(code)] if code else [],
        "feet": {"left": foot, "right": copy.deepcopy(foot)},
        "gait": {"name": "trot", "class_distance": 0.01},
        "forces": {
            "load_share": {"feet": {"left": 0.5, "right": 0.5}},
            "vertical_impulse_over_weight": 1.0,
        },
        "stability": {"static_margin_m": {"median": 0.1, "min": 0.05}},
    }


GOOD: Final = (run(0.700), run(0.703), run(0.698))
NAMES: Final = ("a.bag", "b.bag", "c.bag")


def verdict(log: dict[str, Any]) -> Status:
    rules = parse_limits(suggest_limits(GOOD, NAMES), "suggested")
    return worst(judge(log, rules, None))


@pytest.mark.parametrize("log", GOOD)
def test_the_good_runs_pass(log: dict[str, Any]) -> None:
    assert verdict(log) is Status.GOOD


@pytest.mark.parametrize(
    "bad",
    [
        run(0.63),
        run(slip_m=0.01),
        run(code="DEAD"),
        run(code="UNREADABLE"),
        run(events=("slip",)),
        run(events=("touchdown", "stumble")),
    ],
)
def test_a_bad_run_fails(bad: dict[str, Any]) -> None:
    assert verdict(bad) is Status.FAIL


def test_another_gait_fails() -> None:
    other = run()
    other["gait"]["name"] = "walk"
    assert verdict(other) is Status.FAIL


def test_feet_that_are_alike_share_a_rule() -> None:
    text = suggest_limits(GOOD, NAMES)
    assert 'figure = "feet.*.duty_factor.median"' in text
    assert "feet.left" not in text


def test_feet_that_differ_have_a_rule_each() -> None:
    log = run()
    log["feet"]["left"]["duty_factor"]["median"] = 0.9
    text = suggest_limits([log], ["a.bag"])

    assert 'figure = "feet.left.duty_factor.median"\nbetween = [0.855, 0.945]' in text
    assert 'figure = "feet.right.duty_factor.median"\nbetween = [0.665, 0.735]' in text


def test_runs_that_differ_get_half_as_much_room_again() -> None:
    text = suggest_limits([run(0.6), run(0.8)], NAMES[:2])
    assert 'figure = "feet.*.duty_factor.median"\nbetween = [0.5, 0.9]' in text


def test_what_a_run_does_not_have_gets_no_rule() -> None:
    log = run()
    log["stability"] = None
    assert "stability" not in suggest_limits([log, run()], ["a.bag", "b.bag"])


def test_a_warning_that_a_good_run_has_is_no_failure() -> None:
    log = run(code="DEAD")
    rules = parse_limits(suggest_limits([log], ["a.bag"]), "suggested")
    assert worst(judge(log, rules, None)) is Status.GOOD


def test_no_more_events_than_the_good_runs_have() -> None:
    shaky = run(events=("slip", "touchdown", "slip"))
    rules = parse_limits(suggest_limits([run(), shaky], ["a.bag", "b.bag"]), "suggested")
    assert worst(judge(shaky, rules, None)) is Status.GOOD
    assert worst(judge(run(events=("slip",) * 3), rules, None)) is Status.WARN


def test_slips_that_cannot_be_told_get_no_rule_and_are_unknown_where_there_is_one() -> None:
    blind = run()
    for foot in blind["feet"].values():
        foot["contact_travel_m"] = None
    assert 'event = "slip"' not in suggest_limits([blind], ["a.bag"])
    assert verdict(blind) is Status.UNKNOWN


def test_runs_that_are_no_good_examples_are_named() -> None:
    walk = {**run(0.8), "gait": {"name": "walk", "class_distance": 0.01}}
    found = doubts([GOOD[0], run(code="FALL"), walk], NAMES)
    assert found[0] == "b.bag has FALL: is it a good run?"
    assert "(trot, walk)" in found[1]
    assert f"# {found[0]}\n" in suggest_limits([GOOD[0], run(code="FALL")], NAMES[:2])
    assert doubts(GOOD, NAMES) == []
