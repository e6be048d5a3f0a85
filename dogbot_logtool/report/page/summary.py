"""What happened, to be read in ten seconds: the gait, a few numbers, and whether to trust them."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final

from dogbot_logtool.core.gait.gait import STAND
from dogbot_logtool.core.remarks import remarks
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.finding import Finding
from dogbot_logtool.report.numbers import decimal
from dogbot_logtool.report.verdict import evidence, gait_name, headline, is_known
from dogbot_logtool.results import LogFacts

GRAVE: Final = (
    "W_NO_MESSAGES",
    "W_NOTHING_USABLE",
    "W_DEAD",
    "W_STUCK",
    "W_SATURATED",
    "W_IMPULSE_IS_NOT_WEIGHT",
    "W_FALL",
    "W_POSE_JUMP",
    "W_GAPS",
    "W_LOG_TIME_USED",
)
"""Findings that change what the figures mean, the gravest first."""
MOST_ABOVE_ALL: Final = 3
_SEVERITIES: Final = {"E": "error", "W": "warning", "N": "note"}


@dataclass(frozen=True, slots=True)
class Sentence:
    """A finding, worst first."""

    severity: str
    """``error``, ``warning`` or ``note``."""
    text: str
    code: str
    alike: tuple[str, ...] = ()
    """What else is said under the same code, of other feet and topics."""


@dataclass(frozen=True, slots=True)
class Trust:
    """Whether the recording can be trusted."""

    level: str
    """``good``, ``care`` or ``bad``."""
    text: str
    above_all: tuple[str, ...] = ()
    """What harms the figures most."""


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
    is_known: bool
    evidence: str
    trust: Trust
    tiles: tuple[Tile, ...]
    segments: tuple[str, ...]
    """The gaits in turn, where there are several."""


def summary(stats: Stats, log: LogFacts) -> Summary:
    """Sum up a log."""
    main = stats.main
    words = "no foot makes a whole stride" if main is None else evidence(main)
    if main is not None and main.gait.name == STAND:
        words = "all feet are down" + (" for the longest time" if len(stats.segments) > 1 else "")
    return Summary(
        headline(stats),
        is_known(stats),
        words,
        trust(stats, log),
        tuple(_tiles(stats)),
        tuple(_segments(stats)) if len(stats.segments) > 1 else (),
    )


def findings(stats: Stats, log: LogFacts) -> list[Sentence]:
    """Return all that should be said of the log, the worst first."""
    said: list[Finding] = [*remarks(stats), *log.findings]
    said.sort(key=lambda each: "EWN".find(each.code[:1]))
    return [Sentence(_SEVERITIES.get(each.code[:1], "note"), each.text, each.code) for each in said]


def grouped(sentences: Sequence[Sentence]) -> list[Sentence]:
    """Join the findings of each code; the first speaks for them."""
    texts: dict[str, list[str]] = {}
    for each in sentences:
        texts.setdefault(each.code, []).append(each.text)
    first = {each.code: each for each in reversed(sentences)}
    return [replace(first[code], alike=tuple(others)) for code, (_, *others) in texts.items()]


def trust(stats: Stats, log: LogFacts) -> Trust:
    """Say whether the numbers can be relied on."""
    said = findings(stats, log)
    severities = [each.severity for each in said]
    grave = sorted(
        (each for each in said if each.code in GRAVE or each.severity == "error"),
        key=lambda each: GRAVE.index(each.code) if each.code in GRAVE else -1,
    )
    above_all = tuple(each.text for each in grave[:MOST_ABOVE_ALL])
    errors, warnings = severities.count("error"), severities.count("warning")
    counted = ", ".join(
        f"{count} {word}{'' if count == 1 else 's'}"
        for count, word in ((errors, "error"), (warnings, "warning"))
        if count
    )
    if log.losses:
        lost = "an unknown number of" if log.lost_messages is None else f"{log.lost_messages:,}"
        text = f"The log is damaged: {lost} messages lost"
        return Trust("bad", f"{text}, {counted}." if counted else f"{text}.", above_all)
    if errors:
        return Trust("bad", f"Do not trust it unseen: {counted}.", above_all)
    if warnings:
        return Trust("care", f"Trust it with care: {counted}.", above_all)
    return Trust("good", "It can be trusted: no damage, no warnings.")


def _tiles(stats: Stats) -> Iterator[Tile]:
    base, main = stats.base, stats.main
    if base is not None:
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
        kind = "running" if main.duty_factor < 0.5 else "not running"
        yield Tile("duty factor", decimal(main.duty_factor, 3), kind)
    yield from _load_tiles(stats)


def _load_tiles(stats: Stats) -> Iterator[Tile]:
    peaks = [
        (float(curves.force.high.max()), foot.name)
        for foot in stats.feet
        if (curves := foot.record.curves) and curves.force
    ]
    if peaks:
        highest, name = max(peaks)
        weight = stats.settings.body_weight_n
        of = "" if weight is None else f", {decimal(highest / weight, 2)} body weights"
        yield Tile("highest load", f"{decimal(highest, 1)} N", f"{name}{of}")
    ratio = stats.loads.vertical_impulse_over_weight
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
        start, end = (each / 1e9 for each in (segment.spans[0] - stats.origin).tolist())
        frequency = segment.stride_frequency_hz
        pace = "" if frequency is None else f", {frequency:.2f} strides a second"
        yield f"{start:.1f} to {end:.1f} s: {gait_name(segment).lower()}{pace}"
