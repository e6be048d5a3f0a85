"""Which gait it is and how sure that is; whether the recording can be trusted, and why not.

The same words stand on the terminal and on the page.
"""

import math
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, fields, replace
from pathlib import PurePath
from typing import Final

from dogbot_logtool.core.metrics import Gait, Segment, WalkMetrics
from dogbot_logtool.finding import Finding, Severity, counted
from dogbot_logtool.io.printable import printable
from dogbot_logtool.report.numbers import NOTHING, decimal
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

SUMMARY_HEADERS: Final = (
    "log",
    "gait",
    "conf.",
    "speed\nm/s",
    "strides\n1/s",
    "duty",
    "load\n%",
    "quality",
    "worst",
)
"""Headings of a `summary_row`."""


@dataclass(frozen=True, slots=True)
class Quality:
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
    def mark(self) -> str:
        """A sign for those who see no colours."""
        return {"OK": "✔", "USABLE": "▲"}.get(self.word, "✖")

    @property
    def line(self) -> str:
        """The verdict in one line."""
        return f"Data quality: {self.word} ({self.reasons})"


def quality_of(measured: Measurement) -> Quality:
    """Judge a recording."""
    checks = measured.metrics.quality.checks
    outcomes = Counter(check.outcome for check in checks)
    made, lost = outcomes["passed"] + outcomes["failed"], measured.damage
    doubts = [each for each in measured.findings if each.severity is not Severity.NOTE]
    warnings = grouped(each for each in sorted(doubts, key=_consequence) if each.code != "LOST")
    is_doubtful = any(
        each.voids or each.severity is Severity.ERROR for group in warnings for each in group
    )
    is_damaged = bool(lost.losses or lost.bytes)
    reasons = [
        counted(len(warnings), "warning") if warnings else "",
        f"{outcomes['passed']} of {counted(made, 'check')} passed"
        if outcomes["failed"]
        else f"{counted(made, 'check')} passed",
        f"{outcomes['not made']} could not be made" if outcomes["not made"] else "",
    ]
    word = (
        "DAMAGED" if is_damaged else "DOUBTFUL" if is_doubtful else "USABLE" if warnings else "OK"
    )
    unchecked = tuple(
        f"{each.name}: {each.reason}" for each in checks if each.outcome == "not made"
    )
    return Quality(word, ", ".join(filter(None, reasons)), warnings, unchecked)


def grouped(findings: Iterable[Finding]) -> tuple[tuple[Finding, ...], ...]:
    """Join findings by code, in the order of the first of each."""
    groups: dict[str, list[Finding]] = {}
    for each in findings:
        groups.setdefault(each.code, []).append(each)
    return tuple(map(tuple, groups.values()))


def _consequence(finding: Finding) -> tuple[int, int, bool, float]:
    rank = math.inf if finding.rank is None else finding.rank
    return finding.severity, finding.code != "FALL", not finding.voids, rank


def headline(walk: WalkMetrics) -> str:
    """Name the gait, and how sure that is; before that, when the robot falls."""
    gait, fall = gait_headline(walk), fall_headline(walk)
    return f"{fall}; {gait[0].lower()}{gait[1:]}" if fall else gait


def fall_headline(walk: WalkMetrics) -> str:
    """``Fall at 8.0 s``, or that it tips over as the recording ends; empty if it does neither."""
    times = [f"{each.onset_s:.1f} s" for each in walk.events if each.type == "fall"]
    if times:
        return f"Fall at {', '.join(times[:3])}"
    tipping = [f"{each.onset_s:.1f} s" for each in walk.events if each.type == "tipping"]
    return f"Tips over from {tipping[0]}, as the recording ends" if tipping else ""


def gait_headline(walk: WalkMetrics) -> str:
    """Name the gait of the longest segment, and how sure that is."""
    details = gait_details(walk)
    return f"Gait: {gait_of(walk)}" + (f" ({details})" if details else "") + contact_source(walk)


def contact_source(walk: WalkMetrics) -> str:
    """Say where contacts come from that no sensor tells; empty where one does."""
    return _SOURCES.get(walk.settings.contact_from or "", "") if walk.feet else ""


def gait_of(walk: WalkMetrics) -> str:
    """Name the gait of the longest segment, or say that it has no name."""
    if walk.gait.name is not None:
        return gait_name(walk.gait)
    if any(each.code == "MOVES_WITHOUT_STEPS" for each in walk.findings):
        return "moves without steps"
    return "not known" if walk.feet else "not measured"


def gait_name(gait: Gait) -> str:
    """Name a gait as people do: ``lateral-sequence walk``."""
    sequence = gait.sequence
    if sequence in {"lateral", "diagonal"}:
        sequence = f"{sequence}-sequence"
    return " ".join(filter(None, (sequence, gait.name))) or "not known"


def gait_details(walk: WalkMetrics) -> str:
    """Say how sure the gait is, or why it is not known."""
    gait = walk.gait
    if gait.name is None:
        return why_null(walk, "gait.name") if walk.feet else "no topic of feet"
    if gait.name == "irregular" and gait.class_distance is not None:
        near = f"nearest: {gait.nearest_name}, phases {gait.class_distance:.2f} cycles off"
        return f"{near}; {counted(gait.strides or 0, 'stride')}"
    return how_sure(gait)


def how_sure(gait: Gait) -> str:
    """Say how sure the name of a gait is; empty where there is none, and of a stand."""
    if gait.name in UNNAMED or gait.name == "stand" or gait.confidence is None:
        return ""
    strides = counted(gait.strides or 0, "stride")
    if (gait.strides or 0) < FEWEST_STRIDES:
        return f"low confidence: only {strides}"
    # Never rounded up to 1.00.
    return (
        f"{confidence(gait)} confidence: {math.floor(gait.confidence * 100) / 100:.2f}; {strides}"
    )


def confidence(gait: Gait) -> str:
    """Return high, fair or low."""
    if gait.confidence is None or (gait.strides or 0) < FEWEST_STRIDES:
        return "low"
    return "high" if gait.confidence >= _HIGH else "fair" if gait.confidence >= _FAIR else "low"


def why_null(walk: WalkMetrics, path: str) -> str:
    """Return why a metric is null, as a few words."""
    because = walk.null_because.get(path, "not known")
    found = next((each.text for each in walk.findings if each.code == because), "")
    return found.split(": ")[0] or because


def main_part(walk: WalkMetrics) -> Segment | None:
    """Return the longest segment, where the whole log is another matter than it; None: it is not.

    A fall, a stand or another gait would be mixed into the metrics of the whole log.
    """
    longest = max(walk.gait.segments, key=lambda each: each.end_s - each.start_s, default=None)
    duration = walk.log.duration_s or 0.0
    if longest is None or longest.end_s - longest.start_s >= _WHOLE * duration:
        return None
    return longest


def during(walk: WalkMetrics, segment: Segment) -> WalkMetrics:
    """Return a walk whose metrics of a span are those of a segment."""
    own = {each.name: getattr(segment.gait, each.name) for each in fields(Gait)}
    return replace(
        walk,
        base=segment.base,
        gait=replace(walk.gait, **own),
        feet=segment.feet,
        forces=segment.forces,
        stability=segment.stability,
    )


def summary_row(measured: Measurement) -> tuple[str, ...]:
    """Return the row of a log among several."""
    whole, quality = measured.metrics, quality_of(measured)
    part, others = main_part(whole), len(whole.gait.segments) - 1
    walk = whole if part is None else during(whole, part)
    gait, load = walk.gait, walk.forces.vertical_impulse_over_weight
    codes = [first.code for first, *_ in quality.warnings]
    more = f" +{len(codes) - 1}" if len(codes) > 1 else ""
    return (
        printable(PurePath(whole.log.path).name),
        NOTHING if gait.name is None else gait.name + (f" +{others}" if others > 0 else ""),
        confidence(gait) if how_sure(gait) else NOTHING,
        decimal(walk.base.forward_speed_mps, 2),
        decimal(gait.stride_frequency_hz, 2),
        decimal(gait.duty_factor, 2),
        decimal(load and load * 100.0, 0),
        quality.word,
        f"{codes[0]}{more}" if codes else "",
    )
