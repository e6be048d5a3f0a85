"""Suggest limits from good runs."""

from collections.abc import Iterator, Sequence
from itertools import chain
from typing import Final, Literal, NamedTuple

from dogbot_logtool.comparison.judge import Json, can_tell, figures_in
from dogbot_logtool.comparison.limits import is_number
from dogbot_logtool.core.events import STEPS, EventType
from dogbot_logtool.core.records import METRICS, MetricPath
from dogbot_logtool.io.printable import printable
from dogbot_logtool.io.toml_table import to_toml


class _Suggested(NamedTuple):
    """A metric for which limits are suggested."""

    of: MetricPath
    why: str
    percent: float = 5.0
    """Room on either side of what was seen, of its size."""
    least: float = 0.0
    """Room at least, in the metric's unit."""
    demand: Literal["between", "at_most", "at_least"] = "between"
    """Tells whether too little is bad, or too much, or both."""


_FEET: Final = METRICS.feet["*"]
_FORCES: Final = METRICS.forces
_MARGIN: Final = METRICS.stability.static_margin_m.min
_METRICS: Final = (
    _Suggested(_FEET.duty_factor.median, "how much of a stride each foot stands"),
    _Suggested(_FEET.stride_period_s.median, "s, how long a stride takes"),
    _Suggested(_FEET.stride_length_m.median, "m, how far a stride gets", least=0.005),
    _Suggested(_FEET.peak_force_bw.median, "body weights, how hard feet land and push", 15.0),
    _Suggested(_FEET.slip_m.max, "m, the largest slip of each foot", 50.0, 0.003, "at_most"),
    _Suggested(_FORCES.load_share.feet["*"], "each foot's share of the load", 10.0, 0.02),
    _Suggested(_FORCES.vertical_impulse_over_weight, "1 if sensors and mass fit", 2.0, 0.02),
    _Suggested(_MARGIN, "m, minimum static margin", 0.0, 0.02, "at_least"),
    _Suggested(METRICS.gait.class_distance, "cycles from the ideal gait", 0.0, 0.05, "at_most"),
)
_ALIKE: Final = 1.2
"""Feet share a rule if its range is at most so many times the narrowest of theirs."""
_OF_RECORDING: Final = STEPS | {EventType.POSE_JUMP, EventType.SENSOR_FAULT, EventType.GAP}
"""Types of events that say nothing of the robot, or are among the findings."""
_SENSORS: Final = ("DEAD", "STUCK", "SATURATED", "FALL")
"""Findings that no good run has."""


def suggest_limits(documents: Sequence[Json], names: Sequence[str]) -> str:
    """Return a limits file that these runs pass.

    Args:
        documents: ``stats --json`` of each.
        names: what to call them.
    """
    runs = "1 run" if len(documents) == 1 else f"{len(documents)} runs"
    parts = [
        f"# Limits for `dogbot-logtool check`, suggested from {runs}: {', '.join(names)}.\n",
        "# Each range is what these runs show, and some room. Edit it: you know what matters.\n",
        *(f"# {printable(doubt)}\n" for doubt in doubts(documents, names)),
    ]
    classes = {document["gait"]["name"] for document in documents}
    if len(classes) == 1 and (name := classes.pop()) is not None:
        parts.append(_rule("", figure=str(METRICS.gait.name), equals=name))
    for suggested in _METRICS:
        parts += _rules(documents, suggested)
    parts += _events(documents)
    seen = [_warnings(document) for document in documents]
    parts += [_rule("", finding=each) for each in _SENSORS if each not in chain(*seen)]
    words = "What must not be found in a good run; the page docs/findings.md has all codes."
    parts.append(_rule(words, finding="error"))
    parts.append(_rule("", finding="warning", at_most=max(map(len, seen)), level="warn"))
    return "".join(parts)


def _rule(comment: str, **keys: object) -> str:
    """Return a rule as TOML."""
    lines = [f"{key} = {to_toml(value)}" for key, value in keys.items()]
    above = ["", f"# {comment}"] if comment else [""]
    return "\n".join([*above, "[[rule]]", *lines, ""])


def doubts(documents: Sequence[Json], names: Sequence[str]) -> list[str]:
    """Return sentences on what speaks against these runs as examples of good ones.

    Args:
        documents: ``stats --json`` of each.
        names: what to call them.
    """
    found = []
    for document, name in zip(documents, names, strict=True):
        lost = (each["text"] for each in document["findings"] if each["code"] == "LOST")
        found += [f"{name} is damaged: {text}" for text in lost]
        bad = [code for code in ("LOST", *_SENSORS) if code in _warnings(document)]
        if bad:
            found.append(f"{name} has {', '.join(bad)}: is it a good run?")
    classes = sorted({str(document["gait"]["name"] or "no gait") for document in documents})
    if len(classes) > 1:
        found.append(
            f"The runs differ in gait ({', '.join(classes)}), and the ranges hold all of them: "
            "suggest limits from runs of one gait each."
        )
    return found


def _rules(documents: Sequence[Json], suggested: _Suggested) -> Iterator[str]:
    """Yield the rules of a metric: one for all feet where they are alike, else one a foot.

    A foot of which some run does not know it has no rule.
    """
    found = [dict(figures_in(document, str(suggested.of))) for document in documents]
    paths = dict.fromkeys(chain(*found))
    values = {path: [each.get(path) for each in found] for path in paths}
    known = {path: [v for v in each if is_number(v)] for path, each in values.items()}
    ranges = {p: _range(v, suggested) for p, v in known.items() if len(v) == len(documents)}
    if not ranges:
        return
    low, high = min(low for low, _ in ranges.values()), max(high for _, high in ranges.values())
    narrowest = min(high - low for low, high in ranges.values())
    if len(ranges) == len(paths) and high - low <= _ALIKE * narrowest:
        ranges = {str(suggested.of): (low, high)}
    why = suggested.why
    for path, (low, high) in ranges.items():
        bounds = float(f"{low:.4g}"), float(f"{high:.4g}")
        demands = {"between": bounds, "at_least": bounds[0], "at_most": bounds[1]}
        yield _rule(why, figure=path, **{suggested.demand: demands[suggested.demand]})
        why = ""


def _range(found: Sequence[float], suggested: _Suggested) -> tuple[float, float]:
    """Return the range of what was seen, with room on either side."""
    low, high = min(found), max(found)
    room = max(map(abs, found)) * suggested.percent / 100.0
    room = max(room, (high - low) / 2.0, suggested.least)
    return low - room, high + room


def _events(documents: Sequence[Json]) -> Iterator[str]:
    """Yield a rule for each type of event that these runs can tell.

    Where good runs have some, one more is not bad yet: that is a warning.
    """
    comment = "What may happen: what never did in these runs, fails."
    for kind in (each for each in EventType if each not in _OF_RECORDING):
        if all(can_tell(document, kind) for document in documents):
            most = max(sum(e["type"] == kind for e in d["events"]) for d in documents)
            more = {"at_most": most, "level": "warn"} if most else {}
            yield _rule(comment, event=str(kind), **more)
            comment = ""


def _warnings(document: Json) -> list[str]:
    """Return the codes of a run's warnings."""
    return [each["code"] for each in document["findings"] if each["severity"] == "warning"]
