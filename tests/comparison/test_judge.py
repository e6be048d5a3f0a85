"""What rules come to on metrics, findings and events."""

from typing import Any, Final

import pytest

from dogbot_logtool.comparison.judge import Judgement, Status, figures_in, judge, worst
from dogbot_logtool.comparison.limits import parse_limits

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
    # Rule, path, verdict, value, where to look.
    (f'figure = "{SLIP}"\nat_most = 0.005', SLIP, "FAIL", 0.02, "left slips"),
    (f'figure = "{SLIP}"\nat_most = 0.005\nlevel = "warn"', SLIP, "WARN", 0.02, "left slips"),
    (f'figure = "{SLIP}"\nbetween = [0.02, 0.03]', SLIP, "GOOD", 0.02, ""),
    (f'figure = "{SLIP}"\nbetween = [0.01, 0.02]', SLIP, "GOOD", 0.02, ""),
    (f'figure = "{SLIP}"\nbetween = [0.0201, 1.0]', SLIP, "FAIL", 0.02, "left slips"),
    (f'figure = "{SLIP}i"\nat_most = 1', f"{SLIP}i", "UNKNOWN", None, NEAR),
    (f'figure = "{SLIP}"\nequals = "0.01"\nnull = "pass"', SLIP, "UNKNOWN", 0.02, TEXT),
    ('figure = "forces.ratio"\nat_most = 1', RATIO, "UNKNOWN", None, "no mass"),
    ('figure = "forces.ratio"\nat_most = 1\nnull = "fail"', RATIO, "FAIL", None, "no mass"),
    ('figure = "forces.ratio"\nat_most = 1\nnull = "pass"', RATIO, "GOOD", None, "no mass"),
    ('figure = "*work_j*"\nat_most = 1', "legs.work_j", "UNKNOWN", None, "no efforts"),
    ('figure = "gait.name"\nequals = "trot"', NAME, "GOOD", "trot", ""),
    ('figure = "gait.name"\nequals = "walk"', NAME, "FAIL", "trot", ""),
    ('figure = "gait.name"\nat_most = 1\nnull = "pass"', NAME, "UNKNOWN", "trot", "no number"),
    ('figure = "gait.name"\nequals = 1\nlevel = "warn"', NAME, "UNKNOWN", "trot", "no number"),
    ('figure = "gait.running"\nequals = false', "gait.running", "GOOD", False, ""),
    ('figure = "gait.duty_factor"\nwhere = "walk"\nbetween = [0.7, 0.9]',
     "segment 1 (0.0 to 4.0 s): gait.duty_factor", "GOOD", 0.8, ""),
    ('figure = "gait.duty_factor"\nwhere = "pace"\nat_most = 1',
     "gait.duty_factor", "UNKNOWN", None, "no segment is a pace"),
    ('finding = "warning"', "warning", "FAIL", 1, "left slips"),
    ('finding = "warning"\nat_most = 1', "warning", "GOOD", 1, "left slips"),
    ('finding = "error"', "error", "GOOD", 0, ""),
    ('event = "slip"\nat_most = 1', "slip", "FAIL", 2, "at 3.25 s, 7.50 s"),
    ('event = "fall"', "fall", "GOOD", 0, ""),
]  # fmt: skip


def judged(lines: str, log: Any = LOG, baseline: dict[str, Any] | None = None) -> list[Judgement]:
    return judge(log, parse_limits(f"[[rule]]\n{lines}", "limits.toml"), baseline)


@pytest.mark.parametrize(("rule", "path", "status", "value", "look"), RULES)
def test_a_rule_has_a_verdict_and_says_where_to_look(
    rule: str, path: str, status: str, value: object, look: str
) -> None:
    (found,) = judged(rule)
    assert (found.figure, found.status, found.value, found.look) == (path, status, value, look)


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
    ("lines", "baseline", "status"),
    [
        ("baseline = { by_percent = 10 }", 0.75, Status.GOOD),
        ("baseline = { by_percent = 10 }", 0.80, Status.FAIL),
        ("baseline = { by = 0.1 }", 0.80, Status.GOOD),
        ("baseline = { by_percent = 10 }", None, Status.UNKNOWN),
    ],
)
def test_a_baseline_gives_the_range(lines: str, baseline: float | None, status: Status) -> None:
    run = {"feet": {"left": {"duty_factor": {"median": baseline}}}}
    (found,) = judged(f'figure = "feet.left.duty_factor.median"\n{lines}', baseline=run)
    assert found.status is status
    assert baseline is None or found.demand.endswith(f" of the baseline, {baseline:.4g}")


def test_a_metric_that_neither_run_has_says_why_this_one_lacks_it() -> None:
    (found,) = judged('figure = "forces.ratio"\nbaseline = { by = 1 }', baseline={})
    assert found.look == "no mass"


def test_a_baseline_of_a_text_must_be_the_same() -> None:
    lines = 'figure = "gait.name"\nbaseline = { by = 0 }'
    statuses = [judged(lines, baseline={"gait": {"name": each}}) for each in ("trot", "walk")]
    assert [each.status for (each,) in statuses] == [Status.GOOD, Status.FAIL]


def test_the_worst_is_what_a_log_comes_to() -> None:
    rules = 'figure="gait.name"\nequals="trot"\n[[rule]]\nfigure="forces.ratio"\nat_most=1'
    assert worst(judged(rules)) is Status.UNKNOWN
    assert worst([]) is Status.GOOD
