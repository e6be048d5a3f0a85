"""Which gait it is and how sure that is; whether the recording can be trusted, and why not.

The same words stand on the terminal and on the page.
"""

import math
import re
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import fields, replace
from pathlib import PurePath
from typing import Final, NamedTuple

from dogbot_logtool.core.metrics import Gait, Segment, WalkMetrics
from dogbot_logtool.core.records import METRICS
from dogbot_logtool.finding import Finding, Severity, counted
from dogbot_logtool.io.printable import printable
from dogbot_logtool.report.tables import NOTHING, decimal, why_null
from dogbot_logtool.results import Measurement

FEWEST_STRIDES: Final = 3
"""Strides from which phases can be consistent."""
UNNAMED: Final = {None, "irregular"}
_HIGH: Final = 0.8
_FAIR: Final = 0.5
_WHOLE: Final = 0.7
"""Share of a log from which its longest segment stands for the whole."""
_SOURCES: Final = {
    "plan": ", as planned, not measured",
    "joint_torques": ", contact estimated from joint torques",
    "kinematics": ", contact estimated from the motion of the legs",
}

_WITHOUT_UNIT: Final = re.compile(
    r"(_(m|n|s|ns|nps|mps|mps2|rad|radps|j|percent|fraction)(?=\.|$)|[_.*])+"
)


class Quality(NamedTuple):
    """Whether a recording can be trusted."""

    word: str
    """OK: no warning. USABLE: warnings, none of which voids a metric. DOUBTFUL: one does, or there
    is an error. DAMAGED: something could not be read."""
    reasons: str
    """What the word rests on."""
    warnings: tuple[tuple[Finding, ...], ...]
    """Errors and warnings by code, the worst first; that something is lost has a line of its
    own."""
    unchecked: tuple[str, ...]
    """Checks that could not be made, each with its reason."""

    @property
    def level(self) -> str:
        """``good``, ``care`` or ``bad``: how it is coloured."""
        return {"OK": "good", "USABLE": "care"}.get(self.word, "bad")

    @property
    def line(self) -> str:
        """The verdict in one line."""
        return f"Data quality: {self.word} ({self.reasons})"


def quality_of(measured: Measurement) -> Quality:
    """Judge a recording."""
    checks = measured.metrics.quality.checks
    outcomes = Counter(check.outcome for check in checks)
    made = counted(outcomes["passed"] + outcomes["failed"], "check")
    doubts = [each for each in measured.findings if each.severity is not Severity.NOTE]
    warnings = grouped(each for each in sorted(doubts, key=_consequence) if each.code != "LOST")
    if measured.damage.losses or measured.damage.bytes:
        word = "DAMAGED"
    elif any(each.voids or each.severity is Severity.ERROR for group in warnings for each in group):
        word = "DOUBTFUL"
    else:
        word = "USABLE" if warnings else "OK"
    reasons = [
        counted(len(warnings), "warning") if warnings else "",
        f"{outcomes['passed']} of {made} passed" if outcomes["failed"] else f"{made} passed",
        f"{outcomes['not made']} could not be made" if outcomes["not made"] else "",
    ]
    unchecked = (f"{each.name}: {each.reason}" for each in checks if each.outcome == "not made")
    return Quality(word, ", ".join(filter(None, reasons)), warnings, tuple(unchecked))


def grouped(findings: Iterable[Finding]) -> tuple[tuple[Finding, ...], ...]:
    """Join findings by code, in the order of the first of each."""
    groups: dict[str, list[Finding]] = {}
    for each in findings:
        groups.setdefault(each.code, []).append(each)
    return tuple(map(tuple, groups.values()))


def _consequence(finding: Finding) -> tuple[int, int, bool, float]:
    rank = math.inf if finding.rank is None else finding.rank
    return finding.severity, finding.code != "FALL", not finding.voids, rank


def in_words(patterns: Sequence[str]) -> str:
    """Name the metrics that patterns stand for."""
    words: dict[str, None] = {}
    for pattern in patterns:
        group, _, rest = pattern.partition(".")
        if group == "feet":
            foot, _, metric = rest.partition(".")
            whose = "" if foot in {"*", ""} else f" of {foot}"
            words[f"{_without_unit(metric) or ('all' if whose else 'feet')}{whose}"] = None
        elif group == "commands":
            words["following of commands"] = None
        elif rest != "confidence":
            words[group if rest in {"*", "name"} else _without_unit(rest)] = None
    return ", ".join(words)


def _without_unit(key: str) -> str:
    return _WITHOUT_UNIT.sub(" ", key).strip().replace(" bw", " in body weights")


def headline(metrics: WalkMetrics) -> str:
    """Name the gait, and how sure that is; before that, when the robot falls."""
    gait, fall = gait_headline(metrics), fall_headline(metrics)
    return f"{fall}; {gait[0].lower()}{gait[1:]}" if fall else gait


def fall_headline(metrics: WalkMetrics) -> str:
    """``Fall at 8.0 s``, or that it tips over as the recording ends; empty if it does neither."""
    times = [f"{each.onset_s:.1f} s" for each in metrics.events if each.type == "fall"]
    if times:
        return f"Fall at {', '.join(times[:3])}"
    tipping = [f"{each.onset_s:.1f} s" for each in metrics.events if each.type == "tipping"]
    return f"Tips over from {tipping[0]}, as the recording ends" if tipping else ""


def gait_headline(metrics: WalkMetrics) -> str:
    """Name the gait of the longest segment, and how sure that is."""
    gait = metrics.gait
    if gait.name is not None:
        name, details = gait_name(gait), how_sure(gait)
        if gait.name == "irregular" and gait.class_distance is not None:
            details = f"nearest: {gait.nearest_name}, phases {gait.class_distance:.2f} cycles off; "
            details += counted(gait.strides or 0, "stride")
    elif metrics.feet:
        slides = any(each.code == "MOVES_WITHOUT_STEPS" for each in metrics.findings)
        name = "moves without steps" if slides else "not known"
        details = why_null(metrics, METRICS.gait.name)
    else:
        name, details = "not measured", "no topic of feet"
    return f"Gait: {name}" + (f" ({details})" if details else "") + contact_source(metrics)


def contact_source(metrics: WalkMetrics) -> str:
    """Say where contacts come from that no sensor tells; empty where one does."""
    return _SOURCES.get(metrics.settings.contact_from or "", "") if metrics.feet else ""


def gait_name(gait: Gait) -> str:
    """Name a gait as people do: ``lateral-sequence walk``."""
    sequence = gait.sequence
    if sequence in {"lateral", "diagonal"}:
        sequence = f"{sequence}-sequence"
    return " ".join(filter(None, (sequence, gait.name))) or "not known"


def how_sure(gait: Gait) -> str:
    """Say how sure the name of a gait is; empty where there is none, and of a stand."""
    if confidence(gait) == NOTHING or gait.confidence is None:
        return ""
    strides = counted(gait.strides or 0, "stride")
    if (gait.strides or 0) < FEWEST_STRIDES:
        return f"low confidence: only {strides}"
    # Never rounded up to 1.00.
    share = math.floor(gait.confidence * 100) / 100
    return f"{confidence(gait)} confidence: {share:.2f}; {strides}"


def confidence(gait: Gait) -> str:
    """Return high, fair or low; a dash where there is none to tell."""
    if gait.name in UNNAMED or gait.name == "stand" or gait.confidence is None:
        return NOTHING
    if (gait.strides or 0) < FEWEST_STRIDES:
        return "low"
    return "high" if gait.confidence >= _HIGH else "fair" if gait.confidence >= _FAIR else "low"


def main_part(metrics: WalkMetrics) -> Segment | None:
    """Return the longest segment, where the whole log is another matter than it; None: it is not.

    A fall, a stand or another gait would be mixed into the metrics of the whole log.
    """
    longest = max(metrics.gait.segments, key=lambda each: each.end_s - each.start_s, default=None)
    duration = metrics.log.duration_s or 0.0
    if longest is None or longest.end_s - longest.start_s >= _WHOLE * duration:
        return None
    return longest


def during(metrics: WalkMetrics, segment: Segment) -> WalkMetrics:
    """Return metrics of which those of a span are a segment's."""
    own = {each.name: getattr(segment.gait, each.name) for each in fields(Gait)}
    return replace(
        metrics,
        base=segment.base,
        gait=replace(metrics.gait, **own),
        feet=segment.feet,
        forces=segment.forces,
        stability=segment.stability,
    )


SUMMARY: Final = (
    "log", "gait", "conf.", "speed\nm/s", "strides\n1/s", "duty", "load\n%", "quality", "worst",
)  # fmt: skip
"""Headings of a `summary_row`."""


def summary_row(measured: Measurement) -> tuple[str, ...]:
    """Return the row of a log among several."""
    whole, quality = measured.metrics, quality_of(measured)
    part, others = main_part(whole), len(whole.gait.segments) - 1
    metrics = whole if part is None else during(whole, part)
    gait, load = metrics.gait, metrics.forces.vertical_impulse_over_weight
    codes = [first.code for first, *_ in quality.warnings]
    more = f" +{len(codes) - 1}" if len(codes) > 1 else ""
    return (
        printable(PurePath(whole.log.path).name),
        NOTHING if gait.name is None else gait.name + (f" +{others}" if others > 0 else ""),
        confidence(gait),
        decimal(metrics.base.forward_speed_mps, 2),
        decimal(gait.stride_frequency_hz, 2),
        decimal(gait.duty_factor, 2),
        decimal(load and load * 100.0, 0),
        quality.word,
        f"{codes[0]}{more}" if codes else "",
    )
