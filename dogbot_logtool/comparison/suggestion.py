"""Suggest limits from good runs."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Final, NamedTuple

from dogbot_logtool.comparison.judge import can_tell, figures_in, findings_in
from dogbot_logtool.io.printable import printable

Json = Mapping[str, Any]


_BETWEEN: Final = "between = [{low}, {high}]"
_MOST: Final = "at_most = {high}"
_LEAST: Final = "at_least = {low}"


class _Suggested(NamedTuple):
    """A metric for which limits are suggested."""

    pattern: str
    why: str
    percent: float = 5.0
    """Room on either side of what was seen, of its size."""
    least: float = 0.0
    """Room at least, in the metric's unit."""
    demand: str = _BETWEEN
    """Tells whether too little is bad, or too much, or both."""


_METRICS: Final = (
    _Suggested("feet.*.duty_factor.median", "how much of a stride each foot stands"),
    _Suggested("feet.*.stride_period_s.median", "s, how long a stride takes"),
    _Suggested("feet.*.stride_length_m.median", "m, how far a stride gets", least=0.005),
    _Suggested("feet.*.peak_force_bw.median", "body weights, how hard feet land and push", 15.0),
    _Suggested("feet.*.slip_m.max", "m, the largest slip of each foot", 50.0, 0.003, _MOST),
    _Suggested("forces.load_share.feet.*", "each foot's share of the load", 10.0, 0.02),
    _Suggested(
        "forces.vertical_impulse_over_weight", "1 where sensors and mass are right", 2.0, 0.02
    ),
    _Suggested("stability.static_margin_m.min", "m, least static margin", 0.0, 0.02, _LEAST),
    _Suggested("gait.class_distance", "cycles, how far from the ideal gait", 0.0, 0.05, _MOST),
)
_ALIKE: Final = 1.2
"""Feet share a rule if its range is at most so many times the narrowest of theirs."""
_HEAD: Final = """\
# Limits for `dogbot-logtool check`, suggested from {runs}: {names}.
# Each range is what these runs show, and some room. Edit it: you know what matters.
"""
_FINDINGS: Final = """
# What must not be found in a good run; the page docs/findings.md has all codes.
[[rule]]
finding = "error"

[[rule]]
finding = "warning"
at_most = {most}
level = "warn"
"""
_EVENTS: Final = (
    "fall",
    "tipping",
    "carried",
    "stumble",
    "slip",
    "early_contact",
    "margin_below_zero",
    "gait_change",
)
"""Types of events of the robot; those of its recording are among the findings."""
_SENSORS: Final = ("DEAD", "STUCK", "SATURATED", "FALL")


def suggest_limits(documents: Sequence[Json], names: Sequence[str]) -> str:
    """Return a limits file that these runs pass.

    Args:
        documents: ``stats --json`` of each.
        names: what to call them.
    """
    runs = "1 run" if len(documents) == 1 else f"{len(documents)} runs"
    parts = [_HEAD.format(runs=runs, names=", ".join(names))]
    parts += [f"# {line}\n" for line in (*_damage(documents, names), *doubts(documents, names))]
    parts += _gait(documents)
    for suggested in _METRICS:
        parts += _rules(documents, suggested)
    parts += _events(documents)
    counts = [_warnings(document) for document in documents]
    unseen = [code for code in _SENSORS if not any(code in count for count in counts)]
    parts += [f'\n[[rule]]\nfinding = "{code}"\n' for code in unseen]
    most = max(count.total() for count in counts)
    parts.append(_FINDINGS.format(most=most))
    return "".join(parts)


def doubts(documents: Sequence[Json], names: Sequence[str]) -> list[str]:
    """Return sentences on what speaks against these runs as examples of good ones.

    Args:
        documents: ``stats --json`` of each.
        names: what to call them.
    """
    found = []
    for document, name in zip(documents, names, strict=True):
        bad = [code for code in _SENSORS if code in _warnings(document)]
        if bad:
            found.append(f"{name} has {', '.join(bad)}: is it a good run?")
    classes = sorted({str(document["gait"]["name"] or "no gait") for document in documents})
    if len(classes) > 1:
        found.append(
            f"The runs differ in gait ({', '.join(classes)}), and the ranges hold all of them: "
            "suggest limits from runs of one gait each."
        )
    return found


def _damage(documents: Sequence[Json], names: Sequence[str]) -> Iterator[str]:
    """Yield which runs are damaged, and how."""
    for document, name in zip(documents, names, strict=True):
        for each in findings_in(document):
            if each["code"] == "LOST":
                yield f"{name} is damaged: {printable(each['text'])}"


def _gait(documents: Sequence[Json]) -> Iterator[str]:
    classes = {document["gait"]["name"] for document in documents}
    if len(classes) == 1 and (name := classes.pop()) is not None:
        yield f'\n[[rule]]\nfigure = "gait.name"\nequals = "{name}"\n'


def _rules(documents: Sequence[Json], suggested: _Suggested) -> Iterator[str]:
    """Yield the rules of a figure: one for all feet where they are alike, else one a foot."""
    values: dict[str, list[float]] = {}
    for document in documents:
        for path, value in figures_in(document, suggested.pattern):
            if isinstance(value, int | float):
                values.setdefault(path, []).append(float(value))
    ranges = {
        path: _range(found, suggested)
        for path, found in values.items()
        if len(found) == len(documents)
    }
    if not ranges:
        return
    low, high = min(low for low, _ in ranges.values()), max(high for _, high in ranges.values())
    if high - low <= _ALIKE * min(high - low for low, high in ranges.values()):
        ranges = {suggested.pattern: (low, high)}
    comment = f"\n# {suggested.why}"
    for path, (low, high) in ranges.items():
        demand = suggested.demand.format(low=f"{low:.4g}", high=f"{high:.4g}")
        yield f'{comment}\n[[rule]]\nfigure = "{path}"\n{demand}\n'
        comment = ""


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
    comment = "\n# What may happen: what never did in these runs, fails."
    for kind in _EVENTS:
        if all(can_tell(document, kind) for document in documents):
            counts = [sum(e["type"] == kind for e in d["events"]) for d in documents]
            most = f'at_most = {max(counts)}\nlevel = "warn"\n' if any(counts) else ""
            yield f'{comment}\n[[rule]]\nevent = "{kind}"\n{most}'
            comment = ""


def _warnings(document: Json) -> Counter[str]:
    """Count the warnings of a run by code."""
    return Counter(each["code"] for each in findings_in(document) if each["severity"] == "warning")
