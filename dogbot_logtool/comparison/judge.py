"""Judge the metrics, findings and events of a log by rules.

The words are those of log reviewers for flight logs: GOOD, WARN, FAIL, and UNKNOWN where a figure
is not known.
"""

from collections.abc import Iterator, Mapping, Sequence
from difflib import get_close_matches
from enum import StrEnum
from fnmatch import fnmatchcase
from typing import Any, Final, NamedTuple

from dogbot_logtool.comparison.limits import Rule, Value, is_number
from dogbot_logtool.core.events import EventType
from dogbot_logtool.core.records import METRICS, MetricPath

Json = Mapping[str, Any]
_FEET: Final = METRICS.feet["*"]
_OF_BASE: Final = EventType.FALL, EventType.TIPPING, EventType.CARRIED, EventType.POSE_JUMP
_OF_CONTACT: Final = EventType.STUMBLE, EventType.EARLY_CONTACT
NEEDED: Final[Mapping[str, MetricPath]] = {
    EventType.SLIP: _FEET.contact_travel_m.median,
    EventType.MARGIN_BELOW_ZERO: METRICS.stability.static_margin_m.median,
    **dict.fromkeys(_OF_CONTACT, _FEET.contact_fraction),
    **dict.fromkeys(_OF_BASE, METRICS.base.duration_s),
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


class Judgement(NamedTuple):
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
    damage = [each for each in _judged(document, DAMAGE, None) if each.status is Status.WARN]
    return damage + [each for rule in rules for each in _judged(document, rule, baseline)]


def worst(judgements: Sequence[Judgement]) -> Status:
    """Return what a log comes to."""
    return min((found.status for found in judgements), key=list(Status).index, default=Status.GOOD)


def _judged(document: Json, rule: Rule, baseline: Json | None) -> Iterator[Judgement]:
    match rule.subject:
        case "finding":
            yield _judgement(rule, rule.pattern, *_findings(document, rule.pattern))
        case "event":
            yield _judgement(rule, rule.pattern, *_events(document, rule.pattern))
        case "figure":
            # Of several segments, the baseline's first one counts.
            others = reversed([*_parts(baseline or {}, rule.where)] if rule.baseline else [])
            before = dict(each for _, part in others for each in figures_in(part, rule.pattern))
            for prefix, path, value, look in _figures(document, rule):
                yield _judgement(rule, prefix + path, value, look, before.get(path))


def _judgement(rule: Rule, path: str, value: Value, look: str, before: Value = None) -> Judgement:
    """Judge a value; `look` says why it is null, or what it comes from."""
    demand = rule.demand if before is None else f"{rule.demand}, {value_text(before)}"
    if rule.baseline is not None and before is None and value is not None:
        value, look = None, "the baseline does not have it"
    if value is None:
        status = Status.GOOD if rule.null == "pass" else Status[rule.null.upper()]
        return Judgement(status, rule, path, None, demand, look)
    good = rule.kept_by(value, before)
    if good is None:
        status = Status.UNKNOWN
        look = "a number, which the rule's value is not" if is_number(value) else "no number"
    elif not good:
        status = Status[rule.level.upper()]
    else:
        status, look = Status.GOOD, "" if rule.subject == "figure" else look
    return Judgement(status, rule, path, value, demand, look)


def _findings(document: Json, pattern: str) -> tuple[int, str]:
    """Count the findings of a code or a severity, and quote the first."""
    found = [
        each["text"]
        for each in document.get("findings", ())
        if each["severity"] == pattern or fnmatchcase(each["code"], pattern)
    ]
    return len(found), "; ".join(found[:3])


def _events(document: Json, pattern: str) -> tuple[int | None, str]:
    """Count the events of a type, and say when they were; None: the log cannot tell."""
    events = document.get("events")
    if events is None:
        return None, "no events in it"
    times = [each["onset_s"] for each in events if fnmatchcase(each["type"], pattern)]
    if not times and not can_tell(document, pattern):
        return None, f"the log cannot tell: {NEEDED[pattern]} is null"
    return len(times), f"at {', '.join(f'{time:.2f} s' for time in times[:3])}" if times else ""


def can_tell(document: Json, event: str) -> bool:
    """Tell whether a log has what events of a type are found by."""
    values = [value for _, value in figures_in(document, str(NEEDED.get(event, "")))]
    return not values or any(value is not None for value in values)


def _figures(document: Json, rule: Rule) -> Iterator[tuple[str, str, Value, str]]:
    """Yield the metrics that a rule looks at: segment, path, value, and what is known of it."""
    parts = list(_parts(document, rule.where))
    found = [(name, *each) for name, part in parts for each in figures_in(part, rule.pattern)]
    for name, path, value in found:
        yield name, path, value, _reason(document, path)
    if not parts:
        yield "", rule.pattern, None, f"no segment is a {rule.where}"
    elif not found:
        yield "", rule.pattern, None, _no_such_figure(rule.pattern, [part for _, part in parts])


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
    reasons, above = document.get("null_because", {}), path
    while above and above not in reasons:
        above = above.rpartition(".")[0]
    because = reasons.get(above, "")
    texts = [
        each["text"]
        for each in document.get("findings", ())
        if each["code"] == because or (each["where"] and f"{path}.".startswith(f"{each['where']}."))
    ]
    return "; ".join(dict.fromkeys(texts)) or because


def value_text(value: Value) -> str:
    """Return a value as a sentence shows it."""
    if value is None:
        return "not known"
    return f"{value:.4g}" if isinstance(value, float) else str(value)
