"""The summary, to be read in ten seconds: the gait, a few numbers, and whether to trust them."""

from collections.abc import Iterator, Sequence
from typing import Final

from dogbot_logtool.core.checks.engine import first_of
from dogbot_logtool.core.checks.questions import Check, Outcome, checks_of
from dogbot_logtool.core.gait.classes import STAND
from dogbot_logtool.core.metrics import WalkMetrics
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.finding import Finding, Severity
from dogbot_logtool.report.numbers import date_of, decimal
from dogbot_logtool.report.verdict import (
    evidence,
    fall_headline,
    gait_headline,
    gait_name,
    is_known,
)
from dogbot_logtool.results import Measurement

_LEAST_RANK: Final = 20
"""Findings of a lower rank make some figures doubtful, not all."""
_LONGEST: Final = 110
"""Characters of a doubt in the headline; it stands in full below."""


@dataclass(frozen=True, slots=True)
class FindingGroup:
    """All findings of one code."""

    severity: str
    """``error``, ``warning`` or ``note``."""
    text: str
    """Text of the first."""
    code: str
    remedy: str
    alike: tuple[str, ...] = ()
    """Texts of the others, about other feet and topics."""


@dataclass(frozen=True, slots=True)
class Trust:
    """Whether the recording can be trusted."""

    level: str
    """``good``, ``care`` or ``bad``."""
    text: str
    above_all: tuple[str, ...] = ()
    """The finding that harms the figures most, with its remedy."""


@dataclass(frozen=True, slots=True)
class Tile:
    """A number with its name."""

    name: str
    value: str
    aside: str = ""


@dataclass(frozen=True, slots=True)
class Summary:
    """The head of the page."""

    headline: str
    """The fall or, without one, what makes the figures doubtful, or else the gait."""
    is_sound: bool
    """Whether the headline is a gait that has a name."""
    gait: str
    """The gait, where something else is the headline."""
    evidence: str
    trust: Trust
    tiles: tuple[Tile, ...]
    segments: tuple[str, ...]
    """The gaits in turn, where there are several."""


def summary(measured: Measurement) -> Summary:
    """Sum up a log."""
    stats = measured.stats
    main = stats.main
    words = "no foot makes a whole stride" if main is None else evidence(main)
    if main is not None and main.gait.name == STAND:
        words = "all feet are down" + (" for the longest time" if len(stats.segments) > 1 else "")
    alarm = fall_headline(stats) or _doubt(measured)
    name = gait_headline(stats)
    return Summary(
        alarm or name,
        is_known(stats) and not alarm,
        name if alarm else "",
        words,
        trust(measured),
        tuple(_tiles(stats, measured.metrics)),
        tuple(_segments(stats)) if len(stats.segments) > 1 else (),
    )


def recorded_at(start_s: float | None) -> str:
    """Say when a recording began, in UTC; clocks of simulators begin in 1970."""
    if start_s is None:
        return "not known"
    date = date_of(start_s)
    return f"{date:%Y-%m-%d %H:%M:%S} UTC" if date else f"{start_s:.0f} s (no date)"


def _doubt(measured: Measurement) -> str:
    """Say what makes all figures doubtful; empty: nothing known does."""
    if measured.damage.losses:
        return "In doubt: the log is damaged"
    found = measured.findings
    first = [each for each in first_of(found) if each.code != "FALL"]
    grave = [each for each in first if (each.rank or 0) <= _LEAST_RANK]
    errors = [each for each in found if each.severity is Severity.ERROR]
    if not (grave or errors):
        return ""
    text = (grave or errors)[0].text
    if len(text) > _LONGEST:
        text = f"{text[:_LONGEST].rsplit(' ', 1)[0]} ..."
    return f"In doubt: {text}"


def grouped(findings: Sequence[Finding]) -> list[FindingGroup]:
    """Join the findings of each code."""
    by_code: dict[str, list[Finding]] = {}
    for each in findings:
        by_code.setdefault(each.code, []).append(each)
    return [
        FindingGroup(
            first.severity.word,
            first.text,
            first.code,
            first.remedy,
            tuple(other.text for other in others),
        )
        for first, *others in by_code.values()
    ]


def trust(measured: Measurement) -> Trust:
    """Say whether the numbers can be relied on."""
    # Damage has a sentence of its own.
    found = [each for each in measured.findings if each.code != "LOST"]
    severities = [each.severity for each in found]
    above_all = tuple(f"{each.text}. {each.remedy}".strip() for each in first_of(found))
    errors, warnings = severities.count(Severity.ERROR), severities.count(Severity.WARNING)
    counted = ", ".join(
        f"{count} {word}{'' if count == 1 else 's'}"
        for count, word in ((errors, "error"), (warnings, "warning"))
        if count
    )
    if measured.damage.losses:
        text = "The log is damaged"
        return Trust("bad", f"{text}; {counted}." if counted else f"{text}.", above_all)
    if errors:
        return Trust("bad", f"Do not trust it unseen: {counted}.", above_all)
    if warnings:
        return Trust("care", f"Trust it with care: {counted}.", above_all)
    return _trust_of_checks(checks_of(measured.stats, found))


def _trust_of_checks(checks: Sequence[Check]) -> Trust:
    """Say whether a log without damage and warnings can be trusted."""
    not_made = _listed(checks, Outcome.NOT_MADE)
    if not_made:
        return Trust("care", f"No fault was found, but not all was checked: {not_made}.")
    passed = sum(check.outcome is Outcome.PASSED for check in checks)
    text = f"It can be trusted: no damage, no warnings, {passed} checks passed."
    left = _listed(checks, Outcome.DOES_NOT_APPLY)
    return Trust("good", f"{text} Not checked: {left}." if left else text)


def _listed(checks: Sequence[Check], outcome: Outcome) -> str:
    """Name the checks with an outcome, each with its reason."""
    return "; ".join(f"{each.name} ({each.reason})" for each in checks if each.outcome is outcome)


def _tiles(stats: Stats, walk: WalkMetrics) -> Iterator[Tile]:
    base, main = walk.base, stats.main
    if base.path_length_m is not None:
        yield Tile(
            "distance",
            f"{decimal(base.path_length_m, 2)} m",
            f"{decimal(base.net_displacement_m, 2)} m from start to end",
        )
        if base.forward_speed_mps is not None:
            sideways = decimal(base.lateral_speed_mps, 2)
            yield Tile(
                "speed forward",
                f"{decimal(base.forward_speed_mps, 3)} m/s",
                f"{sideways} m/s to the left",
            )
    if main is not None and main.stride_frequency_hz is not None:
        yield Tile(
            "stride frequency",
            f"{decimal(main.stride_frequency_hz, 2)} Hz",
            f"{main.strides} strides",
        )
    if main is not None and main.duty_factor is not None:
        kind = "below one half" if main.duty_below_half else "one half or more"
        yield Tile("duty factor", decimal(main.duty_factor, 3), kind)
    yield from _load_tiles(stats, walk)


def _load_tiles(stats: Stats, walk: WalkMetrics) -> Iterator[Tile]:
    peaks = [
        (float(curves.force.value.max()), foot.name)
        for foot in stats.feet
        if (curves := foot.record.curves) and curves.force
    ]
    if peaks:
        highest, name = max(peaks)
        weight = walk.settings.body_weight_n
        of = "" if weight is None else f", {decimal(highest / weight, 2)} body weights"
        yield Tile("highest load", f"{decimal(highest, 1)} N", f"{name}{of}")
    ratio = walk.forces.vertical_impulse_over_weight
    if ratio is not None:
        yield Tile("impulse over weight", decimal(ratio, 3), "1 is right")
    stability = stats.stability
    if stability is not None and stability.static_margin_m is not None:
        margin = stability.static_margin_m
        yield Tile(
            "static margin",
            f"{decimal(margin.median * 1e3, 0)} mm",
            f"least {decimal(margin.min * 1e3, 0)} mm",
        )


def _segments(stats: Stats) -> Iterator[str]:
    for segment in stats.segments:
        start, end = ((each - stats.origin) / 1e9 for each in (segment.start, segment.end))
        frequency = segment.stride_frequency_hz
        pace = "" if frequency is None else f", {frequency:.2f} strides a second"
        yield f"{start:.1f} to {end:.1f} s: {gait_name(segment).lower()}{pace}"
