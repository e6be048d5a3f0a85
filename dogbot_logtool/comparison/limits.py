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
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any, Final, Literal, get_args

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
    pattern = _text(table[subject], f"{where}: {subject}")
    given = {key: value for key, value in table.items() if key != subject}
    if strange := sorted(given.keys() - _DEMANDS.keys() - _OTHERS.keys()):
        known = ", ".join((*_DEMANDS, *_OTHERS))
        raise CallError(f"{where}: {strange[0]} is not known; there may be {known}")
    demands = [name for name in _DEMANDS if name in given]
    if subject == "figure" and not demands:
        raise CallError(f"{where}: needs one of {', '.join(_DEMANDS)}")
    if len(demands) > 1 and demands != ["at_least", "at_most"]:
        raise CallError(f"{where}: {demands[0]} and {demands[1]} do not go together")
    fields: dict[str, Any] = {}
    if subject != "figure":
        if set(demands) - {"at_most", "at_least"}:
            raise CallError(f"{where}: of a {subject}'s number there is at_most and at_least only")
        _refuse_unknown(subject, pattern, where)
        # That something was found or happened is what such a rule is against.
        fields["high"] = math.inf if "at_least" in demands else 0.0
    for key, value in given.items():
        of = f"{where}: {key}"
        fields |= _DEMANDS[key](value, of) if key in demands else {key: _OTHERS[key](value, of)}
    return Rule(subject, pattern, **fields)


def _refuse_unknown(subject: Subject, pattern: str, where: str) -> None:
    """Refuse a finding or an event that no log can have: the rule would always be kept."""
    severities = [each.word for each in Severity]
    known = list(EventType) if subject == "event" else [*severities, *finding_kinds()]
    if not any(fnmatchcase(name, pattern) for name in known):
        close = get_close_matches(pattern, known, 3) or (known if subject == "event" else [])
        near = f"; there are {', '.join(close)}" if close else "; docs/findings.md has all codes"
        raise CallError(f"{where}: no {subject} is called {pattern!r}{near}")


def _between(value: Any, where: str) -> dict[str, Any]:  # noqa: ANN401 - any TOML value
    match value:
        case [first, last]:
            low, high = toml_number(first, where), toml_number(last, where)
            if low <= high:
                return {"low": low, "high": high}
            raise CallError(f"{where} has its higher number first")
    raise CallError(f"{where} must be two numbers such as [0.70, 0.80]")


def _within(value: Any, where: str) -> dict[str, Any]:  # noqa: ANN401 - any TOML value
    match value:
        case {"of": middle, "by": by, **others} if not others:
            of, margin = toml_number(middle, f"{where}.of"), abs(toml_number(by, f"{where}.by"))
            return {"low": of - margin, "high": of + margin}
    raise CallError(f"{where} must be like {{ of = 1.0, by = 0.05 }}")


def _equals(value: Any, where: str) -> dict[str, Any]:  # noqa: ANN401 - any TOML value
    return {"equals": value if isinstance(value, str | bool) else toml_number(value, where)}


def _baseline(value: Any, where: str) -> dict[str, Any]:  # noqa: ANN401 - any TOML value
    if not isinstance(value, dict) or not value or value.keys() - {"by", "by_percent"}:
        raise CallError(f"{where} must be like {{ by = 0.01 }} or {{ by_percent = 5 }}")
    numbers = {key: toml_number(each, f"{where}.{key}", 0.0) for key, each in value.items()}
    return {"baseline": Deviation(**numbers)}


def _text(value: Any, where: str) -> str:  # noqa: ANN401 - any TOML value
    if not isinstance(value, str) or not value:
        raise CallError(f"{where} is {shortened(value)}; it must be a text")
    return value


def _one_of(choices: tuple[str, ...]) -> Callable[[Any, str], str]:
    def checked(value: Any, where: str) -> str:  # noqa: ANN401 - any TOML value
        if value not in choices:
            raise CallError(f"{where} is {shortened(value)}; it must be {', '.join(choices)}")
        return str(value)

    return checked


_DEMANDS: Final[Mapping[str, Callable[[Any, str], dict[str, Any]]]] = {
    "between": _between,
    "within": _within,
    "at_least": lambda value, where: {"low": toml_number(value, where)},
    "at_most": lambda value, where: {"high": toml_number(value, where)},
    "equals": _equals,
    "baseline": _baseline,
}
"""What a rule may demand, and the fields of the rule that it sets."""
_OTHERS: Final[Mapping[str, Callable[[Any, str], str]]] = {
    "where": _text,
    "null": _one_of(get_args(Null)),
    "level": _one_of(get_args(Level)),
    "name": _text,
}
