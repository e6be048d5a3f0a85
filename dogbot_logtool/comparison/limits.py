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
from typing import Any, Final, Literal, NamedTuple, TypeGuard, get_args

from dogbot_logtool.core.events import EventType
from dogbot_logtool.errors import CallError
from dogbot_logtool.finding import Severity, finding_kinds
from dogbot_logtool.io.toml_table import (
    NOT_NEGATIVE,
    NUMBER,
    checked,
    parse_toml,
    read_text,
    shortened,
)

Subject = Literal["figure", "finding", "event"]
"""Subject of a rule; a figure is a metric."""
Value = float | str | bool | None
"""A metric in JSON."""

_RULE: Final = re.compile(r"^[ \t]*\[\[[ \t]*rule[ \t]*\]\]", re.MULTILINE)


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

    def margin(self, before: float) -> float:
        """Return how far a metric may be from the baseline's."""
        return max(self.by, abs(before) * self.by_percent / 100.0)


class Rule(NamedTuple):
    """A demand on metrics, findings or events."""

    subject: Subject
    pattern: str
    low: float = -math.inf
    high: float = math.inf
    equals: Value = None
    baseline: Deviation | None = None
    where: str | None = None
    """Glob of the gait classes of the segments that are looked at; None: the log as a whole."""
    null: str = "unknown"
    """Verdict on a metric that is not known: or ``fail`` or ``pass``."""
    level: str = "fail"
    """Consequence where it is broken: or ``warn``."""
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

    def kept_by(self, value: Value, before: Value) -> bool | None:
        """Tell whether a value keeps the rule; None where the two cannot be compared.

        Args:
            value: the metric's.
            before: that of the baseline; None where the rule needs none.
        """
        equals = self.equals if self.baseline is None else before
        if equals is None:
            return self.low <= value <= self.high if is_number(value) else None
        if is_number(value) and is_number(equals):
            return abs(value - equals) <= (self.baseline.margin(equals) if self.baseline else 0.0)
        return None if is_number(value) or is_number(equals) else value == equals


def is_number(value: Value) -> TypeGuard[float]:
    """Tell whether a metric is a number."""
    return isinstance(value, int | float) and not isinstance(value, bool)


def load_limits(path: Path) -> tuple[Rule, ...]:
    """Read a limits file.

    Raises:
        CallError: it is not a limits file; the sentence names rule and line.
    """
    return parse_limits(read_text(path, "a limits file"), str(path))


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
    if strange := sorted(table.keys() - {*_KEYS}):
        raise CallError(f"{where}: {strange[0]} is not known; there may be {', '.join(_KEYS)}")
    given = {key: _value(key, value, f"{where}: {key}") for key, value in table.items()}
    subjects = [subject for subject in get_args(Subject) if subject in given]
    if len(subjects) != 1:
        raise CallError(f"{where}: needs one of figure, finding and event")
    subject = subjects[0]
    pattern = given.pop(subject)
    demands = [name for name in _DEMANDS if name in given]
    if len(demands) > 1 and demands != ["at_least", "at_most"]:
        raise CallError(f"{where}: {demands[0]} and {demands[1]} do not go together")
    # That something was found or happened is what a rule without a number is against.
    low, high = given.pop("at_least", -math.inf), given.pop("at_most", math.inf)
    if subject == "figure":
        if not demands:
            raise CallError(f"{where}: needs one of {', '.join(_DEMANDS)}")
    elif set(demands) - {"at_most", "at_least"}:
        raise CallError(f"{where}: of a {subject}'s number there is at_most and at_least only")
    else:
        _refuse_unknown(subject, pattern, where)
        high = high if demands else 0.0
    low, high = given.pop("between", (low, high))
    return Rule(subject, pattern, low, high, **given)


def _refuse_unknown(subject: Subject, pattern: str, where: str) -> None:
    """Refuse a finding or an event that no log can have: the rule would always be kept."""
    severities = [each.word for each in Severity]
    known = list(EventType) if subject == "event" else [*severities, *finding_kinds()]
    if not any(fnmatchcase(name, pattern) for name in known):
        close = get_close_matches(pattern, known, 3) or (known if subject == "event" else [])
        near = f"; there are {', '.join(close)}" if close else "; docs/findings.md has all codes"
        raise CallError(f"{where}: no {subject} is called {pattern!r}{near}")


def _value(key: str, value: Any, where: str) -> Any:  # noqa: ANN401 - any TOML value
    """Check the value of a rule's key."""
    match key, value:
        case ("null", "unknown" | "fail" | "pass") | ("level", "fail" | "warn"):
            return value
        case "equals", str() | bool():
            return value
        case (("figure" | "finding" | "event" | "where" | "name"), str()) if value:
            return value
        case (("at_least" | "at_most" | "equals"), _):
            return checked(value, NUMBER, where)
        case "between", [low, high] if checked(low, NUMBER, where) <= checked(high, NUMBER, where):
            return low, high
        case "baseline", dict() if value and not value.keys() - {"by", "by_percent"}:
            return Deviation(
                **{n: checked(each, NOT_NEGATIVE, f"{where}.{n}") for n, each in value.items()}
            )
    raise CallError(f"{where} is {shortened(value)}; it must be {_WANTED.get(key, 'a text')}")


_DEMANDS: Final = ("between", "at_least", "at_most", "equals", "baseline")
_KEYS: Final = (*get_args(Subject), *_DEMANDS, "where", "null", "level", "name")
_WANTED: Final = {
    "between": "two numbers such as [0.70, 0.80], the lower one first",
    "baseline": "like { by = 0.01 } or { by_percent = 5 }",
    "null": "unknown, fail or pass",
    "level": "fail or warn",
}
