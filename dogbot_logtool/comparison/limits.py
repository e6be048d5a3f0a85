"""Limits: rules on the metrics, findings and events of a log, from a TOML file.

    [[rule]]
    figure = "feet.*.duty_factor.median"
    where = "walk"
    between = [0.70, 0.80]

A rule names a metric, a finding's code or a type of event, by a pattern (a glob whose ``*`` also
stands for dots), and says what is demanded of it.
"""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any, Final, Literal, get_args

from dogbot_logtool.comparison.renamed import new_name
from dogbot_logtool.core.events.event import EventType
from dogbot_logtool.errors import CallError
from dogbot_logtool.finding import Severity, finding_kinds
from dogbot_logtool.io.toml_table import parse_toml, read_toml, shortened, toml_number

Subject = Literal["figure", "finding", "event"]
"""Subject of a rule; a figure is a metric."""
Null = Literal["unknown", "fail", "pass"]
"""Verdict on a metric that is not known."""
Level = Literal["fail", "warn"]
"""Consequence of a broken rule."""
Value = float | str | bool
"""A value that a metric may have to be equal to."""

_RULE: Final = re.compile(r"^[ \t]*\[\[[ \t]*rule[ \t]*\]\]", re.MULTILINE)
_DEMANDS: Final = ("between", "within", "at_least", "at_most", "equals", "baseline")
_OTHERS: Final = ("where", "null", "level", "name")
_EXAMPLES: Final = {
    "between": "two numbers such as [0.70, 0.80]",
    "within": "like { of = 1.0, by = 0.05 }",
    "baseline": "like { by = 0.01 } or { by_percent = 5 }",
}
_SEVERITIES: Final = tuple(each.word for each in Severity)


@dataclass(frozen=True, slots=True)
class Deviation:
    """How far a metric may be from the baseline's; either will do."""

    by: float = 0.0
    """In the metric's own unit."""
    by_percent: float = 0.0
    """Percentage of the baseline's value."""

    def __str__(self) -> str:
        parts = [f"{self.by:g}"] if self.by else []
        parts += [f"{self.by_percent:g} %"] if self.by_percent else []
        return " or ".join(parts) or "0"

    def around(self, value: float) -> tuple[float, float]:
        """Return the lowest and the highest value that is near enough."""
        margin = max(self.by, abs(value) * self.by_percent / 100.0)
        return value - margin, value + margin


@dataclass(frozen=True, slots=True)
class Rule:
    """A demand on metrics, findings or events."""

    subject: Subject
    pattern: str
    low: float = -math.inf
    high: float = math.inf
    equals: Value | None = None
    baseline: Deviation | None = None
    where: str | None = None
    """Glob of the gait classes of the segments that are looked at; None: the log as a whole."""
    null: Null = "unknown"
    level: Level = "fail"
    name: str = ""
    """Its name for people."""

    @property
    def demand(self) -> str:
        """The demand in words."""
        if self.baseline is not None:
            return f"within {self.baseline} of the baseline"
        if self.equals is not None:
            return f"equal to {self.equals}"
        if self.low == -math.inf:
            return f"at most {self.high:g}"
        if self.high == math.inf:
            return f"at least {self.low:g}"
        return f"{self.low:g} to {self.high:g}"


def load_limits(path: Path) -> tuple[Rule, ...]:
    """Read a limits file.

    Raises:
        CallError: it is not a limits file; the sentence names rule and line.
    """
    return parse_limits(read_toml(path, "a limits file"), str(path))


def parse_limits(text: str, source: str) -> tuple[Rule, ...]:
    """Check the rules of a limits file.

    Args:
        text: the TOML.
        source: what to call it in errors.

    Raises:
        CallError: naming the rule and the line.
    """
    document = parse_toml(text, source)
    tables = document.pop("rule", [])
    if document:
        raise CallError(f"{source}: {next(iter(document))} is not known; rules begin with [[rule]]")
    if not isinstance(tables, list) or not all(isinstance(table, dict) for table in tables):
        raise CallError(f"{source}: a rule begins with [[rule]], in double brackets")
    if not tables:
        raise CallError(f"{source}: there is no [[rule]] in it")
    lines = [text.count("\n", 0, found.start()) + 1 for found in _RULE.finditer(text)]
    rules = []
    for number, table in enumerate(tables, 1):
        line = f", line {lines[number - 1]}" if len(lines) == len(tables) else ""
        rules.append(_rule(table, f"{source}{line}: rule {number}"))
    return tuple(rules)


def _rule(table: Mapping[str, Any], where: str) -> Rule:
    subjects = [subject for subject in get_args(Subject) if subject in table]
    if len(subjects) != 1:
        raise CallError(f"{where}: needs one of figure, finding and event")
    subject = subjects[0]
    if strange := sorted(set(table) - {subject, *_DEMANDS, *_OTHERS}):
        known = ", ".join((*_DEMANDS, *_OTHERS))
        raise CallError(f"{where}: {strange[0]} is not known; there may be {known}")
    demands = [name for name in _DEMANDS if name in table]
    if subject != "figure" and set(demands) - {"at_most", "at_least"}:
        raise CallError(f"{where}: of a {subject}'s number there is at_most and at_least only")
    if subject == "figure" and not demands:
        raise CallError(f"{where}: needs one of {', '.join(_DEMANDS)}")
    if len(demands) > 1 and demands != ["at_least", "at_most"]:
        raise CallError(f"{where}: {demands[0]} and {demands[1]} do not go together")
    for key in {subject, "where", "name"} & set(table):
        if not isinstance(table[key], str) or not table[key]:
            raise CallError(f"{where}: {key} is {shortened(table[key])}; it must be a text")
    for key, choices in (("null", get_args(Null)), ("level", get_args(Level))):
        if table.get(key, choices[0]) not in choices:
            words = ", ".join(choices)
            raise CallError(f"{where}: {key} is {shortened(table[key])}; it must be {words}")
    _check_name(subject, table[subject], where)
    low, high = _range(table, subject, where)
    others = {key: table[key] for key in _OTHERS if key in table}
    equals, baseline = _equals(table, where), _deviation(table, where)
    return Rule(subject, table[subject], low, high, equals, baseline, **others)


def _check_name(subject: Subject, pattern: str, where: str) -> None:
    """Refuse a metric of before, and a finding or event that no log can have.

    A rule about the latter would always be kept.
    """
    if subject == "figure":
        if new := new_name(pattern):
            raise CallError(f"{where}: {pattern} is now {new}; docs/metrics.md has all metrics")
        return
    known = list(EventType) if subject == "event" else [*_SEVERITIES, *finding_kinds()]
    if any(fnmatchcase(name, pattern) for name in known):
        return
    if subject == "finding" and (now := _new_codes(pattern)):
        raise CallError(
            f"{where}: {pattern} is now {', '.join(now)}; codes have no prefix any more, and "
            "docs/findings.md has all"
        )
    close = get_close_matches(pattern, known, 3) or (known if subject == "event" else [])
    near = f"; there are {', '.join(close)}" if close else "; docs/findings.md has all codes"
    raise CallError(f"{where}: no {subject} is called {pattern!r}{near}")


def _new_codes(pattern: str) -> list[str]:
    """Return the codes that stand for a code or a pattern of before, such as ``DEAD``."""
    letter, _, name = pattern.partition("_")
    if letter not in {"E", "N", "W"}:
        return []
    if name == "*":
        return [each for each in _SEVERITIES if each.startswith(letter.lower())]
    return [
        code
        for code, kind in finding_kinds().items()
        if any(fnmatchcase(each, name) for each in (code, *kind.was))
    ]


def _range(table: Mapping[str, Any], subject: Subject, where: str) -> tuple[float, float]:
    """Return the lowest and the highest value that is good."""
    match table:
        case {"between": [first, last]}:
            low, high = (toml_number(each, f"{where}: between") for each in (first, last))
            if low > high:
                raise CallError(f"{where}: between has its higher number first")
            return low, high
        case {"within": {"of": middle, "by": by, **others}} if not others:
            of = toml_number(middle, f"{where}: within.of")
            margin = abs(toml_number(by, f"{where}: within.by"))
            return of - margin, of + margin
        case {"between": _} | {"within": _}:
            key = "between" if "between" in table else "within"
            raise CallError(f"{where}: {key} must be {_EXAMPLES[key]}")
    # That something was found or happened is what such a rule is against.
    most = 0.0 if subject != "figure" and "at_least" not in table else math.inf
    ends = {"at_least": -math.inf, "at_most": most}
    ends |= {key: toml_number(table[key], f"{where}: {key}") for key in ends if key in table}
    return ends["at_least"], ends["at_most"]


def _deviation(table: Mapping[str, Any], where: str) -> Deviation | None:
    if "baseline" not in table:
        return None
    inner = table["baseline"]
    if not isinstance(inner, dict) or not inner or set(inner) - {"by", "by_percent"}:
        raise CallError(f"{where}: baseline must be {_EXAMPLES['baseline']}")
    where = f"{where}: baseline"
    return Deviation(**{key: toml_number(each, f"{where}.{key}", 0) for key, each in inner.items()})


def _equals(table: Mapping[str, Any], where: str) -> Value | None:
    value: Value | None = table.get("equals")
    if value is None or isinstance(value, str | bool):
        return value
    return toml_number(value, f"{where}: equals")
