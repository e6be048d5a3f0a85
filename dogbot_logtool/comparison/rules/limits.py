"""Limits: rules on the figures, findings and events of a log, from a TOML file.

    [[rule]]
    figure = "feet.*.duty_factor.median"
    where = "walk"
    between = [0.70, 0.80]

A rule names a figure, a finding's code or a type of event, by a pattern (a glob whose ``*`` also
stands for dots), and says what is demanded of it.
"""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from enum import StrEnum
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any, Final, TypeVar

from dogbot_logtool.comparison.rules.renamed import new_name
from dogbot_logtool.core.events.event import EventType
from dogbot_logtool.errors import CallError
from dogbot_logtool.finding import Severity, finding_kinds
from dogbot_logtool.io.toml_table import parse_toml, read_toml, shortened

Choice = TypeVar("Choice", bound=StrEnum)

_RULE: Final = re.compile(r"^[ \t]*\[\[[ \t]*rule[ \t]*\]\]", re.MULTILINE)
_DEMANDS: Final = ("between", "within", "at_least", "at_most", "equals", "baseline")
_OTHERS: Final = ("where", "null", "level", "name")


_SEVERITIES: Final = tuple(each.word for each in Severity)


class Subject(StrEnum):
    """Subject of a rule."""

    FIGURE = "figure"
    FINDING = "finding"
    EVENT = "event"


class Null(StrEnum):
    """Verdict on a figure that is not known."""

    UNKNOWN = "unknown"
    FAIL = "fail"
    PASS = "pass"  # noqa: S105 - no password


class Level(StrEnum):
    """Consequence of a broken rule."""

    FAIL = "fail"
    WARN = "warn"


@dataclass(frozen=True, slots=True)
class Deviation:
    """How far a figure may be from the baseline's; either will do."""

    by: float = 0.0
    """In the figure's own unit."""
    by_percent: float = 0.0
    """Percentage of the baseline's value."""

    def around(self, value: float) -> tuple[float, float]:
        """Return the lowest and the highest value that is near enough."""
        margin = max(self.by, abs(value) * self.by_percent / 100.0)
        return value - margin, value + margin


@dataclass(frozen=True, slots=True)
class Rule:
    """A demand on figures, findings or events."""

    subject: Subject
    pattern: str
    low: float = -math.inf
    high: float = math.inf
    equals: str | float | bool | None = None
    baseline: Deviation | None = None
    where: str | None = None
    """Glob of the gait classes of the segments that are looked at; None: the log as a whole."""
    null: Null = Null.UNKNOWN
    level: Level = Level.FAIL
    name: str = ""
    """Its name for people."""

    @property
    def demand(self) -> str:
        """The demand in words."""
        if self.baseline is not None:
            return f"within {_margin(self.baseline)} of the baseline"
        if self.equals is not None:
            return f"equal to {self.equals}"
        if self.low == -math.inf:
            return f"at most {self.high:g}"
        if self.high == math.inf:
            return f"at least {self.low:g}"
        return f"{self.low:g} to {self.high:g}"


def _margin(deviation: Deviation) -> str:
    parts = [f"{deviation.by:g}"] if deviation.by else []
    parts += [f"{deviation.by_percent:g} %"] if deviation.by_percent else []
    return " or ".join(parts) or "0"


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
    subjects = [subject for subject in Subject if subject in table]
    if len(subjects) != 1:
        raise CallError(f"{where}: needs one of figure, finding and event")
    subject = subjects[0]
    if strange := sorted(set(table) - {subject, *_DEMANDS, *_OTHERS}):
        known = ", ".join((*_DEMANDS, *_OTHERS))
        raise CallError(f"{where}: {strange[0]} is not known; there may be {known}")
    pattern = _text(table, subject, where)
    _check_name(subject, pattern, where)
    demands = [name for name in _DEMANDS if name in table]
    if subject is not Subject.FIGURE and set(demands) - {"at_most", "at_least"}:
        raise CallError(f"{where}: of a {subject}'s number there is at_most and at_least only")
    if subject is Subject.FIGURE and not demands:
        raise CallError(f"{where}: needs one of {', '.join(_DEMANDS)}")
    if len(demands) > 1 and demands != ["at_least", "at_most"]:
        raise CallError(f"{where}: {demands[0]} and {demands[1]} do not go together")
    low, high = _range(table, subject, where)
    return Rule(
        subject,
        pattern,
        low,
        high,
        equals=_equals(table, where),
        baseline=_deviation(table, where),
        where=_text(table, "where", where) if "where" in table else None,
        null=_choice(Null, table, "null", where) or Null.UNKNOWN,
        level=_choice(Level, table, "level", where) or Level.FAIL,
        name=_text(table, "name", where) if "name" in table else "",
    )


def _check_name(subject: Subject, pattern: str, where: str) -> None:
    """Refuse a metric of before, and a finding or event that no log can have.

    A rule about the latter would always be kept.
    """
    if subject is Subject.FIGURE:
        if new := new_name(pattern):
            raise CallError(f"{where}: {pattern} is now {new}; docs/metrics.md has all metrics")
        return
    known = list(EventType) if subject is Subject.EVENT else [*_SEVERITIES, *finding_kinds()]
    if any(fnmatchcase(name, pattern) for name in known):
        return
    if subject is Subject.FINDING and (now := _new_codes(pattern)):
        raise CallError(
            f"{where}: {pattern} is now {', '.join(now)}; codes have no prefix any more, and "
            "docs/findings.md has all"
        )
    close = get_close_matches(pattern, known, 3) or (known if subject is Subject.EVENT else [])
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
    if "between" in table:
        ends = table["between"]
        if not isinstance(ends, list) or len(ends) != 2:
            raise CallError(f"{where}: between must be two numbers such as [0.70, 0.80]")
        low, high = (_number(end, f"{where}: between") for end in ends)
        if low > high:
            raise CallError(f"{where}: between has its higher number first")
        return low, high
    if "within" in table:
        inner = table["within"]
        if not isinstance(inner, dict) or set(inner) != {"of", "by"}:
            raise CallError(f"{where}: within must be like {{ of = 1.0, by = 0.05 }}")
        of, by = (_number(inner[key], f"{where}: within.{key}") for key in ("of", "by"))
        return of - abs(by), of + abs(by)
    low = _number(table["at_least"], f"{where}: at_least") if "at_least" in table else -math.inf
    # That something was found or happened is what such a rule is against.
    most = 0.0 if subject is not Subject.FIGURE and "at_least" not in table else math.inf
    high = _number(table["at_most"], f"{where}: at_most") if "at_most" in table else most
    return low, high


def _deviation(table: Mapping[str, Any], where: str) -> Deviation | None:
    if "baseline" not in table:
        return None
    inner = table["baseline"]
    if not isinstance(inner, dict) or not inner or set(inner) - {"by", "by_percent"}:
        raise CallError(f"{where}: baseline must be like {{ by = 0.01 }} or {{ by_percent = 5 }}")
    values = {key: _number(value, f"{where}: baseline.{key}") for key, value in inner.items()}
    if min(values.values()) < 0.0:
        raise CallError(f"{where}: baseline takes numbers from 0 on")
    return Deviation(**values)


def _equals(table: Mapping[str, Any], where: str) -> str | float | bool | None:
    value = table.get("equals")
    if value is None or isinstance(value, str | bool):
        return value
    return _number(value, f"{where}: equals")


def _number(value: object, where: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) < 1e300:
        raise CallError(f"{where} is {shortened(value)}; it must be a number")
    return float(value)


def _text(table: Mapping[str, Any], key: str, where: str) -> str:
    value = table[key]
    if not isinstance(value, str) or not value:
        raise CallError(f"{where}: {key} is {shortened(value)}; it must be a text")
    return value


def _choice(kind: type[Choice], table: Mapping[str, Any], key: str, where: str) -> Choice | None:
    value = table.get(key)
    if value is None:
        return None
    try:
        return kind(value)
    except ValueError as error:
        words = ", ".join(kind)
        raise CallError(f"{where}: {key} is {shortened(value)}; it must be {words}") from error
