"""Judge the metrics, findings and events of a log by rules.

The words are those of log reviewers for flight logs: GOOD, WARN, FAIL, and UNKNOWN where a figure
is not known.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from enum import StrEnum
from fnmatch import fnmatchcase
from typing import Any, Final, TypeGuard

from dogbot_logtool.comparison.limits import Rule
from dogbot_logtool.core.events.event import EventType
from dogbot_logtool.core.records import METRICS, MetricPath

Json = Mapping[str, Any]
Value = float | str | bool | None
"""A figure in JSON."""


_CONTACT: Final = METRICS.feet["*"].contact_fraction
_BASE: Final = METRICS.base.duration_s
NEEDED: Final[Mapping[str, MetricPath]] = {
    EventType.SLIP: METRICS.feet["*"].contact_travel_m.median,
    EventType.STUMBLE: _CONTACT,
    EventType.EARLY_CONTACT: _CONTACT,
    EventType.FALL: _BASE,
    EventType.TIPPING: _BASE,
    EventType.CARRIED: _BASE,
    EventType.POSE_JUMP: _BASE,
    EventType.MARGIN_BELOW_ZERO: METRICS.stability.static_margin_m.median,
}
"""Figures by type of event: where all are null, that there was no such event is not known."""


DAMAGE: Final = Rule("finding", "LOST", high=0, level="warn", name="the log is not damaged")
"""A rule that every log is judged by, beside those of the limits."""


class Status(StrEnum):
    """Verdict of a rule; the worst comes first."""

    FAIL = "FAIL"
    UNKNOWN = "UNKNOWN"
    WARN = "WARN"
    GOOD = "GOOD"


@dataclass(frozen=True, slots=True)
class Judgement:
    """The result of a rule for one figure, or for the count of findings or events."""

    status: Status
    rule: Rule
    figure: str
    """Path of the figure; of findings and events the pattern."""
    value: Value
    demand: str
    """The demand in words, with the baseline's value put in."""
    look: str
    """Findings that concern it, or a time to look at; empty where nothing is known."""


def judge(document: Json, rules: Sequence[Rule], baseline: Json | None) -> list[Judgement]:
    """Judge a log.

    Args:
        document: its ``stats --json``.
        rules: what is demanded.
        baseline: ``stats --json`` of the run that it is held against, where a rule does so.

    Returns:
        Judgements in the order of the rules, and of the figures within one; before them, for a
        damaged log only, a warning that says how.
    """
    damage = _of_findings(document, DAMAGE)
    found = [found for rule in rules for found in _judged(document, rule, baseline)]
    return found if damage.status is Status.GOOD else [damage, *found]


def worst(judgements: Sequence[Judgement]) -> Status:
    """Return what a log comes to."""
    return min((found.status for found in judgements), key=list(Status).index, default=Status.GOOD)


def _judged(document: Json, rule: Rule, baseline: Json | None) -> Iterator[Judgement]:
    match rule.subject:
        case "finding":
            yield _of_findings(document, rule)
        case "event":
            yield _of_events(document, rule)
        case "figure":
            yield from _of_figures(document, rule, baseline)


def _of_findings(document: Json, rule: Rule) -> Judgement:
    found = [
        each
        for each in document.get("findings", ())
        if each["severity"] == rule.pattern or fnmatchcase(each["code"], rule.pattern)
    ]
    return _counted(rule, len(found), "; ".join(each["text"] for each in found[:3]))


def _of_events(document: Json, rule: Rule) -> Judgement:
    events = document.get("events")
    if events is None:
        return _unknown(rule, rule.pattern, "no events in it")
    found = [each for each in events if fnmatchcase(each["type"], rule.pattern)]
    if not found and not can_tell(document, rule.pattern):
        return _unknown(rule, rule.pattern, f"the log cannot tell: {NEEDED[rule.pattern]} is null")
    times = ", ".join(f"{each['onset_s']:.2f} s" for each in found[:3])
    return _counted(rule, len(found), f"at {times}" if times else "")


def can_tell(document: Json, event: str) -> bool:
    """Tell whether a log has what events of a type are found by."""
    values = [value for _, value in figures_in(document, str(NEEDED.get(event, "")))]
    return not values or any(value is not None for value in values)


def _counted(rule: Rule, count: int, look: str) -> Judgement:
    good = rule.low <= count <= rule.high
    status = Status.GOOD if good else _broken(rule)
    return Judgement(status, rule, rule.pattern, count, rule.demand, look)


def _of_figures(document: Json, rule: Rule, baseline: Json | None) -> Iterator[Judgement]:
    """Yield a judgement for each metric that the pattern fits."""
    parts = list(_parts(document, rule.where))
    if not parts:
        yield _unknown(rule, rule.pattern, f"no segment is a {rule.where}")
        return
    # Of several segments, the baseline's first one counts.
    others = reversed(list(_parts(baseline or {}, rule.where)))
    before = dict(each for _, part in others for each in figures_in(part, rule.pattern))
    found = [(prefix, *each) for prefix, part in parts for each in figures_in(part, rule.pattern)]
    for prefix, path, value in found:
        yield _of_figure(document, rule, prefix + path, value, before.get(path))
    if not found:
        yield _unknown(rule, rule.pattern, _no_such_figure(rule.pattern, [p for _, p in parts]))


def _of_figure(document: Json, rule: Rule, path: str, value: Value, before: Value) -> Judgement:
    if value is None:
        return _unknown(rule, path, _reason(document, path))
    low, high, equals, demand = rule.low, rule.high, rule.equals, rule.demand
    if rule.baseline is not None:
        if before is None:
            return _unknown(rule, path, "the baseline does not have it")
        equals, demand = before, f"{demand}, {value_text(before)}"
    if _is_number(equals):
        low, high = rule.baseline.around(equals) if rule.baseline else (equals, equals)
        equals = None
    if _is_number(value) and equals is None:
        good = low <= value <= high
    elif _is_number(value) or equals is None:
        look = "no number" if equals is None else "a number, which the rule's value is not"
        return Judgement(Status.UNKNOWN, rule, path, value, demand, look)
    else:
        good = value == equals
    status = Status.GOOD if good else _broken(rule)
    return Judgement(status, rule, path, value, demand, "" if good else _reason(document, path))


def _broken(rule: Rule) -> Status:
    return Status.WARN if rule.level == "warn" else Status.FAIL


def _unknown(rule: Rule, path: str, why: str) -> Judgement:
    status = {"unknown": Status.UNKNOWN, "pass": Status.GOOD, "fail": Status.FAIL}[rule.null]
    return Judgement(status, rule, path, None, rule.demand, why)


def _parts(document: Json, where: str | None) -> Iterator[tuple[str, Json]]:
    """Yield what a rule looks at, with what its paths begin with: the log, or segments of it."""
    if where is None:
        yield "", document
        return
    for number, segment in enumerate(document.get("gait", {}).get("segments", ())):
        if fnmatchcase(str(segment["gait"]["name"]), where):
            time = f" ({segment['start_s']:.1f} to {segment['end_s']:.1f} s)"
            yield f"segment {number + 1}{time}: ", segment


def figures_in(document: Json, pattern: str, path: str = "") -> Iterator[tuple[str, Value]]:
    """Yield the figures that a pattern fits, with their paths.

    Where an object that should hold a figure is null, so is the figure.

    Args:
        document: an object of figures.
        pattern: glob of paths.
        path: what the paths begin with.
    """
    for key, value in document.items():
        name = f"{path}.{key}" if path else str(key)
        if name == "null_because":
            continue  # paths of metrics are its keys
        if isinstance(value, Mapping):
            yield from figures_in(value, pattern, name)
        elif not isinstance(value, list) and fnmatchcase(name, pattern):
            yield name, value
        elif value is None and (below := _below(name, pattern)):
            yield below, None


def _below(path: str, pattern: str) -> str:
    """Return the path that a pattern fits below a null; empty if it fits none."""
    names = path.count(".") + 1
    words = pattern.split(".")
    if len(words) <= names or not fnmatchcase(path, ".".join(words[:names])):
        return ""
    return ".".join((path, *words[names:]))


def _no_such_figure(pattern: str, parts: Sequence[Json]) -> str:
    """Say that no figure fits a pattern, and which are called nearly so."""
    names = {path for part in parts for path, _ in figures_in(part, "*")}
    near = get_close_matches(pattern, sorted(names), 3, 0.8)
    text = "no metric of this log is called so"
    return f"{text}; near it are {', '.join(near)}" if near else text


def _reason(document: Json, path: str) -> str:
    """Return why a metric is null, and the findings that concern it."""
    because = _null_because(document.get("null_because", {}), path.rpartition(": ")[2])
    texts = [
        each["text"]
        for each in document.get("findings", ())
        if each["code"] == because or (each["where"] and f"{path}.".startswith(f"{each['where']}."))
    ]
    return "; ".join(dict.fromkeys(texts)) or because


def _null_because(reasons: Mapping[str, str], path: str) -> str:
    """Return why a metric, or what holds it, is null: a finding's code or a sentence."""
    while path and path not in reasons:
        path = path.rpartition(".")[0]
    return reasons.get(path, "")


def _is_number(value: Value) -> TypeGuard[float]:
    return isinstance(value, int | float) and not isinstance(value, bool)


def value_text(value: Value) -> str:
    """Return a value as a sentence shows it."""
    if value is None:
        return "not known"
    return f"{value:.4g}" if isinstance(value, float) else str(value)
