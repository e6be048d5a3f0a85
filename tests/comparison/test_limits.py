"""Limits files: what they may say, what their rules come to, and how they are suggested."""

import copy
import re
from collections.abc import Sequence
from typing import Any, Final

import pytest

from dogbot_logtool.comparison.judge import Judgement, Status, figures_in, judge, worst
from dogbot_logtool.comparison.limits import parse_limits
from dogbot_logtool.comparison.suggestion import doubts, suggest_limits
from dogbot_logtool.errors import CallError
from dogbot_logtool.report.documents import stats_json
from tests.measured import measured
from tests.paths import TROT


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "there is no [[rule]] in it"),
        ("rules = 1", "rules is not known; rules begin with [[rule]]"),
        ("[rule]\nfigure = 'a'", "in double brackets"),
        ("[[rule]]\nat_most = 1", "line 1: rule 1: needs one of figure, finding and event"),
        ("[[rule]]\nfigure = 'a'\nevent = 'b'", "needs one of"),
        ("[[rule]]\nfigure = 'a'", "rule 1: needs one of between, at_least"),
        ("[[rule]]\nfigure = 3\nat_most = 1", "figure is 3; it must be a text"),
        ("[[rule]]\nfigure = 'a'\nat_mots = 1", "at_mots is not known"),
        ("[[rule]]\nfigure = 'a'\nat_most = nan", "it must be a finite number"),
        ("[[rule]]\nfigure = 'a'\nbetween = [2, 1]", "between is [2, 1]; it must be two numbers"),
        ("[[rule]]\nfigure = 'a'\nbetween = [1, 2]\nat_most = 1", "do not go together"),
        ("[[rule]]\nfigure = 'a'\nbaseline = { by = -1 }", "baseline.by is -1; it must be"),
        ("[[rule]]\nfigure = 'a'\nbaseline = 5", "baseline is 5; it must be like"),
        ("[[rule]]\nevent = 'slip'\nbetween = [1, 2]", "at_most and at_least only"),
        ("[[rule]]\nevent = 'slips'", "no event is called 'slips'; there are slip"),
        ("[[rule]]\nfinding = 'W_*'", "docs/findings.md has all codes"),
        ("[[rule]]\nfigure = 'a'\nat_most = 1\nnull = 'ok'", "it must be unknown, fail or pass"),
        ("[[rule]]\nevent = 'gap'\n\n[[rule]]\nevent = 1", "line 4: rule 2: event is 1"),
        ("not toml", "not valid TOML"),
    ],
)
def test_a_fault_is_told_with_rule_and_line(text: str, says: str) -> None:
    with pytest.raises(CallError, match=f"^limits.toml.*{re.escape(says)}"):
        parse_limits(text, "limits.toml")


# --- What rules come to ---------------------------------------------------------------------------

LOG: Final[dict[str, Any]] = {
    "findings": [
        {"code": "SLIP", "severity": "warning", "text": "left slips", "where": "feet.left"},
        {"code": "MASS_UNKNOWN", "severity": "note", "text": "no mass", "where": "forces.ratio"},
    ],
    "feet": {
        "left": {"duty_factor": {"median": 0.71, "max": 0.9}, "slip_m": {"max": 0.02}},
        "right": {"duty_factor": None, "slip_m": {"max": 0.001}},
    },
    "forces": {"ratio": None},
    "legs": {"work_j": None},
    "null_because": {"legs.work_j": "no efforts"},
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
SLIP, RATIO, NAME = "feet.left.slip_m.max", "forces.ratio", "gait.name"
TEXT = "a number, which the rule's value is not"
NEAR = "no metric of this log is called so; near it are feet.left.slip_m.max, feet.right.slip_m.max"
RULES: Final = [
    # Rule, path, verdict, value, demand, where to look.
    (f'figure = "{SLIP}"\nat_most = 0.005', SLIP, "FAIL", 0.02, "at most 0.005", "left slips"),
    (f'figure = "{SLIP}"\nat_most = 0.005\nlevel = "warn"',
     SLIP, "WARN", 0.02, "at most 0.005", "left slips"),
    (f'figure = "{SLIP}"\nat_least = 0.02', SLIP, "GOOD", 0.02, "at least 0.02", ""),
    (f'figure = "{SLIP}"\nbetween = [0.01, 0.02]', SLIP, "GOOD", 0.02, "0.01 to 0.02", ""),
    (f'figure = "{SLIP}i"\nat_most = 1', f"{SLIP}i", "UNKNOWN", None, "at most 1", NEAR),
    (f'figure = "{SLIP}"\nequals = "0.01"\nnull = "pass"',
     SLIP, "UNKNOWN", 0.02, "equal to 0.01", TEXT),
    ('figure = "forces.ratio"\nat_most = 1', RATIO, "UNKNOWN", None, "at most 1", "no mass"),
    ('figure = "forces.ratio"\nat_most = 1\nnull = "fail"',
     RATIO, "FAIL", None, "at most 1", "no mass"),
    ('figure = "forces.ratio"\nat_most = 1\nnull = "pass"',
     RATIO, "GOOD", None, "at most 1", "no mass"),
    ('figure = "*work_j*"\nat_most = 1',
     "legs.work_j", "UNKNOWN", None, "at most 1", "no efforts"),
    ('figure = "gait.name"\nequals = "walk"', NAME, "FAIL", "trot", "equal to walk", ""),
    ('figure = "gait.name"\nat_most = 1\nnull = "pass"',
     NAME, "UNKNOWN", "trot", "at most 1", "no number"),
    ('figure = "gait.running"\nequals = false',
     "gait.running", "GOOD", False, "equal to False", ""),
    ('figure = "gait.duty_factor"\nwhere = "walk"\nbetween = [0.7, 0.9]',
     "segment 1 (0.0 to 4.0 s): gait.duty_factor", "GOOD", 0.8, "0.7 to 0.9", ""),
    ('figure = "gait.duty_factor"\nwhere = "pace"\nat_most = 1',
     "gait.duty_factor", "UNKNOWN", None, "at most 1", "no segment is a pace"),
    ('finding = "warning"', "warning", "FAIL", 1, "at most 0", "left slips"),
    ('finding = "warning"\nat_most = 1', "warning", "GOOD", 1, "at most 1", "left slips"),
    ('event = "slip"\nat_most = 1', "slip", "FAIL", 2, "at most 1", "at 3.25 s, 7.50 s"),
    ('event = "fall"', "fall", "GOOD", 0, "at most 0", ""),
]  # fmt: skip


def judged(lines: str, log: Any = LOG, baseline: dict[str, Any] | None = None) -> list[Judgement]:
    return judge(log, parse_limits(f"[[rule]]\n{lines}", "limits.toml"), baseline)


@pytest.mark.parametrize(("rule", "path", "status", "value", "demand", "look"), RULES)
def test_a_rule_has_a_verdict_and_says_where_to_look(
    rule: str, path: str, status: str, value: object, demand: str, look: str
) -> None:
    (found,) = judged(rule)
    told = found.figure, found.status, found.value, found.demand, found.look
    assert told == (path, status, value, demand, look)


def test_each_metric_that_fits_is_judged_and_below_a_null_it_is_unknown() -> None:
    found = judged('figure = "feet.*.duty_factor.median"\nbetween = [0.7, 0.8]')
    assert {each.figure: each.status for each in found} == {
        "feet.left.duty_factor.median": Status.GOOD,
        "feet.right.duty_factor.median": Status.UNKNOWN,
    }
    assert {path for path, _ in figures_in(LOG, "feet*max")} == {
        "feet.left.duty_factor.max",
        "feet.left.slip_m.max",
        "feet.right.slip_m.max",
    }


def test_a_log_without_a_table_of_events_is_unknown() -> None:
    (found,) = judged('event = "fall"', {})
    assert found.status is Status.UNKNOWN


@pytest.mark.parametrize(
    ("rule", "run", "status", "says"),
    [
        ('"*left.duty*median"\nbaseline = { by_percent = 10 }', 0.75, "GOOD", "baseline, 0.75"),
        ('"*left.duty*median"\nbaseline = { by_percent = 10 }', 0.8, "FAIL", "baseline, 0.8"),
        ('"*left.duty*median"\nbaseline = { by = 0.1 }', 0.8, "GOOD", "baseline, 0.8"),
        ('"*left.duty*median"\nbaseline = { by_percent = 10 }', None, "UNKNOWN", ""),
        ('"forces.ratio"\nbaseline = { by = 1 }', None, "UNKNOWN", "no mass"),
        ('"gait.name"\nbaseline = { by = 0 }', "trot", "GOOD", ""),
        ('"gait.name"\nbaseline = { by = 0 }', "walk", "FAIL", ""),
    ],
)
def test_a_baseline_gives_the_range(
    rule: str, run: float | str | None, status: str, says: str
) -> None:
    baseline = {"feet": {"left": {"duty_factor": {"median": run}}}, "gait": {"name": run}}
    (found,) = judged(f"figure = {rule}", baseline=baseline)
    assert found.status == status
    assert says in found.demand + found.look


# --- Suggested ------------------------------------------------------------------------------------


def run(duty: float = 0.7, slip_m: float = 0.001, code: str = "", *events: str) -> dict[str, Any]:
    """Return the figures of the trot, with some that are given."""
    severity = "error" if code == "UNREADABLE" else "warning"
    finding = {"code": code, "severity": severity, "text": "", "where": ""}
    log = copy.deepcopy(stats_json(measured(TROT)))
    log["findings"] = [finding] if code else []
    log["events"] = [{"type": event, "onset_s": 1.0} for event in events]
    for foot in log["feet"].values():
        foot["duty_factor"]["median"], foot["slip_m"]["max"] = duty, slip_m
    return log


WALKING: Final = {**run(), "gait": {**run()["gait"], "name": "walk"}}
GOOD: Final = (run(0.700), run(0.703), run(0.698))
NAMES: Final = ("a.bag", "b.bag", "c.bag")


def verdict(log: dict[str, Any], *good: dict[str, Any]) -> Status:
    """Judge a run by the limits that good ones suggest."""
    rules = parse_limits(suggest_limits(good, NAMES[: len(good)]), "suggested")
    return worst(judge(log, rules, None))


DOUBTED, SHAKY = run(0.7, 0.001, "DEAD"), run(0.7, 0.001, "", "slip", "touchdown", "slip")

LAME = run()
LAME["feet"]["front_right"]["duty_factor"] = None


@pytest.mark.parametrize(
    ("log", "good", "status"),
    [
        *((each, GOOD, "GOOD") for each in GOOD),
        (run(0.63), GOOD, "FAIL"),
        (run(0.7, 0.01), GOOD, "FAIL"),
        (DOUBTED, GOOD, "FAIL"),
        (run(0.7, 0.001, "UNREADABLE"), GOOD, "FAIL"),
        (run(0.7, 0.001, "", "touchdown", "stumble"), GOOD, "FAIL"),
        (WALKING, GOOD, "FAIL"),
        # A warning or an event that a good run has is no failure.
        (DOUBTED, (DOUBTED,), "GOOD"),
        (SHAKY, (run(), SHAKY), "GOOD"),
        (run(0.7, 0.001, "", *["slip"] * 3), (run(), SHAKY), "WARN"),
        # Nor is what of one foot is not known.
        (LAME, (LAME,), "GOOD"),
    ],
)
def test_the_good_runs_pass_and_others_fail(
    log: dict[str, Any], good: Sequence[dict[str, Any]], status: str
) -> None:
    assert verdict(log, *good) == status


def test_feet_that_are_alike_share_a_rule_with_half_as_much_room_again() -> None:
    text = suggest_limits([run(0.6), run(0.8)], NAMES[:2])
    assert 'figure = "feet.*.duty_factor.median"\nbetween = [0.5, 0.9]' in text
    assert "feet.front_left.duty" not in text


def test_feet_that_differ_have_a_rule_each() -> None:
    log = run()
    log["feet"]["front_left"]["duty_factor"]["median"] = 0.9
    text = suggest_limits([log], ["a.bag"])
    assert 'figure = "feet.front_left.duty_factor.median"\nbetween = [0.855, 0.945]' in text
    assert 'figure = "feet.front_right.duty_factor.median"\nbetween = [0.665, 0.735]' in text


def test_what_a_run_does_not_tell_gets_no_rule_and_is_unknown_where_there_is_one() -> None:
    blind = run()
    blind["stability"] = None
    for foot in blind["feet"].values():
        foot["contact_travel_m"] = None
    text = suggest_limits([blind, run()], NAMES[:2])
    assert "stability" not in text
    assert 'event = "slip"' not in text
    assert verdict(blind, *GOOD) is Status.UNKNOWN


def test_runs_that_are_no_good_examples_are_named() -> None:
    fallen = run(0.7, 0.001, "FALL")
    found = doubts([GOOD[0], fallen, WALKING], NAMES)
    assert found[0] == "b.bag has FALL: is it a good run?"
    assert "(trot, walk)" in found[1]
    assert f"# {found[0]}\n" in suggest_limits([GOOD[0], fallen], NAMES[:2])
    assert doubts(GOOD, NAMES) == []
