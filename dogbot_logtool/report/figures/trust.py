"""Figures of what was checked before a recording is trusted: clocks, worlds, and the checks."""

from collections.abc import Iterator, Sequence
from typing import Final

from dogbot_logtool.core.checks.questions import Check, Outcome
from dogbot_logtool.core.consistency.worlds import Worlds
from dogbot_logtool.core.quality.clocks import ClockDifference
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.report.figures.figure import Figure, Kind


@dataclass(frozen=True, slots=True)
class ClockSource:
    """The source of figures of a topic's clock."""

    clock: ClockDifference
    is_apart: bool
    """Whether what rests on it and on the feet's clocks is left out."""


def clock_sources(stats: Stats) -> Iterator[ClockSource]:
    """Yield what the figures of each topic's clock are taken from."""
    for clock in stats.clocks:
        yield ClockSource(clock, clock.topic in stats.clocks_apart)


CHECK: Final[Sequence[Figure[Check]]] = (
    Figure("name", Kind.TEXT, lambda check: check.name, "what should hold"),
    Figure(
        "outcome",
        Kind.TEXT,
        lambda check: str(check.outcome),
        "what came of the check",
        choices=tuple(map(str, Outcome)),
    ),
    Figure(
        "reason",
        Kind.TEXT,
        lambda check: check.reason or None,
        "why it failed, could not be made or does not apply",
        null="it passed",
    ),
)
CLOCK: Final[Sequence[Figure[ClockSource]]] = (
    Figure("topic", Kind.TEXT, lambda source: source.clock.topic, "a topic with header stamps"),
    Figure(
        "behind_s",
        Kind.NUMBER,
        lambda source: source.clock.behind_s,
        "median by which its stamps are older than those of the feet's topics, against log time",
    ),
    Figure(
        "drift_s",
        Kind.NUMBER,
        lambda source: source.clock.drift_s,
        "by how much that grows from the log's start to its end",
    ),
    Figure(
        "jitter_s",
        Kind.AMOUNT,
        lambda source: source.clock.jitter_s,
        "standard deviation about the drift, robustly estimated",
    ),
    Figure(
        "apart",
        Kind.FLAG,
        lambda source: source.is_apart,
        "whether figures that need both clocks are null",
    ),
)
WORLDS: Final[Sequence[Figure[Worlds]]] = (
    Figure(
        "base_to_feet_m",
        Kind.AMOUNT,
        lambda worlds: worlds.distance_m,
        "median horizontal distance of the base from the centroid of the feet's usual positions",
    ),
    Figure(
        "base_to_feet_change_m",
        Kind.AMOUNT,
        lambda worlds: worlds.change_m,
        "change of the base's position among the feet from the log's first third to its last",
    ),
    Figure(
        "feet_spread_m",
        Kind.AMOUNT,
        lambda worlds: worlds.spread_m,
        "distance of the outermost foot's usual position from that centroid",
    ),
    Figure(
        "beyond_fraction",
        Kind.FRACTION,
        lambda worlds: worlds.beyond_fraction,
        "share of the time in which the base is further from it than the outermost foot",
    ),
    Figure(
        "agree",
        Kind.FLAG,
        lambda worlds: worlds.agree,
        "whether contact points and base are in one world",
    ),
)
