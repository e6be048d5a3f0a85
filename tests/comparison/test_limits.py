"""Limits files: what they may say, and how their faults are told."""

import math
from pathlib import Path

import pytest

from dogbot_logtool.comparison.limits import Deviation, Rule, load_limits, parse_limits
from dogbot_logtool.errors import CallError


def rule(lines: str) -> Rule:
    (only,) = parse_limits(f"[[rule]]\n{lines}", "limits.toml")
    return only


@pytest.mark.parametrize(
    ("lines", "low", "high", "demand"),
    [
        ("between = [0.70, 0.80]", 0.7, 0.8, "0.7 to 0.8"),
        ("at_most = 0.005", -math.inf, 0.005, "at most 0.005"),
        ("at_least = 2", 2.0, math.inf, "at least 2"),
        ("at_least = 2\nat_most = 3", 2.0, 3.0, "2 to 3"),
        ('equals = "trot"', -math.inf, math.inf, "equal to trot"),
        ("baseline = { by_percent = 5 }", -math.inf, math.inf, "within 5 % of the baseline"),
    ],
)
def test_a_range_of_a_metric(lines: str, low: float, high: float, demand: str) -> None:
    found = rule(f'figure = "feet.*.slip_m.max"\n{lines}')
    assert (found.subject, found.pattern) == ("figure", "feet.*.slip_m.max")
    assert (found.low, found.high, found.demand) == (low, high, demand)
    assert (found.null, found.level, found.where) == ("unknown", "fail", None)


def test_a_rule_may_say_more() -> None:
    more = 'where = "walk"\nnull = "pass"\nlevel = "warn"\nname = "calm"'
    found = rule(f'figure = "a"\nat_most = 1\n{more}')
    assert (found.where, found.null, found.level, found.name) == ("walk", "pass", "warn", "calm")


def test_nothing_may_be_found_or_happen_unless_a_rule_says_more() -> None:
    assert (rule('finding = "warning"').high, rule('event = "fall"').high) == (0.0, 0.0)
    assert rule('event = "slip"\nat_most = 3').high == 3.0
    assert rule('event = "touchdown"\nat_least = 8').high == math.inf


@pytest.mark.parametrize(
    ("deviation", "before", "margin"),
    [
        (Deviation(by=0.5), 2.0, 0.5),
        (Deviation(by_percent=10.0), -2.0, 0.2),
        (Deviation(by=0.5, by_percent=10.0), 2.0, 0.5),
    ],
)
def test_a_deviation_from_a_baseline(deviation: Deviation, before: float, margin: float) -> None:
    assert deviation.margin(before) == pytest.approx(margin)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "there is no [[rule]] in it"),
        ("rules = 1", "rules is not known; rules begin with [[rule]]"),
        ("[rule]\nfigure = 'a'", "in double brackets"),
        ("rule = [1]", "in double brackets"),
        ("[[rule]]\nat_most = 1", "line 1: rule 1: needs one of figure, finding and event"),
        ("[[rule]]\nfigure = 'a'\nevent = 'b'", "needs one of"),
        ("[[rule]]\nfigure = 'a'", "rule 1: needs one of between, at_least"),
        ("[[rule]]\nfigure = 3\nat_most = 1", "figure is 3; it must be a text"),
        ("[[rule]]\nfigure = 'a'\nat_most = 1\nwhere = ''", "where is ''; it must be a text"),
        ("[[rule]]\nfigure = 'a'\nat_mots = 1", "at_mots is not known"),
        ("[[rule]]\nfigure = 'a'\nat_most = 'b'", "at_most is 'b'; it must be a number"),
        ("[[rule]]\nfigure = 'a'\nat_most = nan", "it must be a finite number"),
        ("[[rule]]\nfigure = 'a'\nat_most = true", "it must be a number"),
        ("[[rule]]\nfigure = 'a'\nequals = [1]", "equals is [1]; it must be a number"),
        ("[[rule]]\nfigure = 'a'\nbetween = [2, 1]", "between is [2, 1]; it must be two numbers"),
        ("[[rule]]\nfigure = 'a'\nbetween = 2", "two numbers"),
        ("[[rule]]\nfigure = 'a'\nbetween = [1, 2]\nat_most = 1", "do not go together"),
        ("[[rule]]\nfigure = 'a'\nbaseline = { by = -1 }", "baseline.by is -1; it must be"),
        ("[[rule]]\nfigure = 'a'\nbaseline = 5", "baseline is 5; it must be like"),
        ("[[rule]]\nevent = 'slip'\nbetween = [1, 2]", "at_most and at_least only"),
        ("[[rule]]\nevent = 'slips'", "no event is called 'slips'; there are slip"),
        ("[[rule]]\nevent = 'x'", "there are fall, tipping"),
        ("[[rule]]\nfinding = 'FAL'", "no finding is called 'FAL'; there are FALL"),
        ("[[rule]]\nfinding = 'W_FALL'", "no finding is called 'W_FALL'; there are FALL"),
        ("[[rule]]\nfinding = 'W_*'", "docs/findings.md has all codes"),
        ("[[rule]]\nfigure = 'a'\nat_most = 1\nnull = 'ok'", "it must be unknown, fail or pass"),
        ("[[rule]]\nfigure = 'a'\nat_most = 1\nlevel = 1", "level is 1; it must be fail or warn"),
        ("[[rule]]\nevent = 'gap'\n\n[[rule]]\nevent = 1", "line 4: rule 2: event is 1"),
        ("not toml", "not valid TOML"),
    ],
)
def test_a_fault_is_told_with_rule_and_line(tmp_path: Path, text: str, says: str) -> None:
    (tmp_path / "limits.toml").write_text(text)
    with pytest.raises(CallError) as raised:
        load_limits(tmp_path / "limits.toml")
    assert says in str(raised.value)
    assert str(raised.value).startswith(str(tmp_path / "limits.toml"))
