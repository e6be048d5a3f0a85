"""Figures of the gait: of the longest segment, of each segment, and of the support."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, Final

from dogbot_logtool.core.gait.gait import IRREGULAR, STAND
from dogbot_logtool.core.gait.gait_classes import CLASS_NAMES
from dogbot_logtool.core.gait.phases import diagonality, limb_phases
from dogbot_logtool.core.gait.segments import Segment
from dogbot_logtool.core.gait.support_pattern import Support
from dogbot_logtool.core.geometry.aggregates import CircularMean
from dogbot_logtool.core.statistics import SegmentFigures, Stats
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.report.figures.base import BASE
from dogbot_logtool.report.figures.commands import COMMANDS_OF_SEGMENT
from dogbot_logtool.report.figures.feet import FOOT_OF_SEGMENT
from dogbot_logtool.report.figures.figure import (
    Column,
    Figure,
    Kind,
    Member,
    Scope,
    Shape,
    TableName,
    inside,
)
from dogbot_logtool.report.figures.foot_source import FootSource
from dogbot_logtool.report.figures.loads import FORCES_OF_SEGMENT, STABILITY, LoadSource

_STEPS, _SUMMARY, _INDEX = TableName.STEPS, TableName.SUMMARY, TableName.INDEX
_LOG_ROWS = TableName.LOG_ROWS
_NO_SUPPORT: Final = "there is no time in which the state of every foot is known"
_NO_STRIDE: Final = "no foot makes a whole stride in it"


@dataclass(frozen=True, slots=True)
class SegmentSource:
    """The source of a segment's figures."""

    stats: Stats
    segment: Segment

    @property
    def figures(self) -> SegmentFigures:
        """Figures of base, feet and support in it."""
        return self.stats.segment_figures[self.stats.segments.index(self.segment)]

    @property
    def phases(self) -> Mapping[str, CircularMean | None]:
        """Phase of each foot against the reference foot, by its name."""
        return dict(zip(self._names, self.segment.phases, strict=True))

    @property
    def hind_phases(self) -> Mapping[str, CircularMean | None] | None:
        """The same against the left hind foot."""
        phases = self.segment.hind_phases
        return None if phases is None else dict(zip(self._names, phases, strict=True))

    @property
    def feet(self) -> Mapping[str, FootSource]:
        """The source of each foot's figures in it, by its name."""
        feet = self.figures.feet
        return {foot.name: FootSource(self.stats, row, foot) for row, foot in enumerate(feet)}

    @property
    def load_source(self) -> LoadSource:
        """The source of its figures of loads."""
        return LoadSource(self.figures.loads, self.figures.feet, self.stats.corners)

    @property
    def corner_phases(self) -> list[float] | None:
        """Mean phases of the four corners; None unless all are known."""
        corners = [self.segment.phases[foot] for foot in self.stats.corners or ()]
        phases = [phase.mean for phase in corners if phase is not None]
        return phases if len(phases) == 4 else None

    @property
    def _names(self) -> list[str]:
        return [foot.name for foot in self.stats.feet]

    def seconds(self, time: int) -> float:
        """Return a time as seconds since the log's start."""
        return (time - self.stats.origin) / 1e9


def segment_sources(stats: Stats) -> list[SegmentSource]:
    """Return what the figures of each segment are taken from."""
    return [SegmentSource(stats, segment) for segment in stats.segments]


def main_source(stats: Stats) -> SegmentSource | None:
    """Return what the figures of the longest segment are taken from."""
    return SegmentSource(stats, stats.main) if stats.main else None


def _diagonality(source: SegmentSource) -> float | None:
    phases = source.corner_phases
    return None if phases is None else diagonality(phases)


def _limb_phase(source: SegmentSource) -> dict[str, float] | None:
    phases = source.corner_phases
    sides = ("left", "right")
    return None if phases is None else dict(zip(sides, limb_phases(phases), strict=True))


def _double_support(support: Support | None) -> float | None:
    return None if support is None else support.double_support_fraction


_PHASE: Final[Sequence[Figure[CircularMean]]] = (
    Figure(
        "mean",
        Kind.FRACTION,
        lambda phase: phase.mean,
        "touchdown of the foot after that of the reference foot / stride period of the reference "
        "foot (Hildebrand 1965), mean on the circle (Batschelet 1981), in [0, 1)",
        unit="cycles",
        columns=(Column(_STEPS, "phase", 3, rank=60),),
    ),
    Figure(
        "consistency",
        Kind.FRACTION,
        lambda phase: phase.consistency,
        "length R of the mean on the circle: 1 where all phases are equal, near 0 where they are "
        "spread evenly (Batschelet 1981)",
        columns=(Column(_STEPS, "R", 2, rank=70),),
    ),
)
_PHASE_OF_HIND: Final = tuple(replace(figure, columns=()) for figure in _PHASE)
GAIT: Final[Sequence[Member]] = (
    Figure[SegmentSource](
        "class",
        Kind.TEXT,
        lambda source: source.segment.gait.name,
        "class of the gait by its phases: the nearest class, if the phases deviate by at most 0.1 "
        "cycles and every R exceeds 0.8; else irregular. stand: all feet are down for longer than "
        "1 s and than a stride",
        null="not four feet whose leg positions are known; a foot has no touchdowns in it",
        choices=(STAND, *CLASS_NAMES, IRREGULAR),
        columns=(Column(_LOG_ROWS, "gait", rank=30),),
    ),
    Figure[SegmentSource](
        "sequence",
        Kind.TEXT,
        lambda source: source.segment.gait.sequence,
        "order of the feet, where the class leaves it open: lateral or diagonal in a walk, rotary "
        "or transverse in a gallop",
        null="the class does not leave it open; both fore feet follow each other",
        choices=("lateral", "diagonal", "rotary", "transverse"),
        columns=(Column(_LOG_ROWS, "sequence", rank=30),),
    ),
    Figure[SegmentSource](
        "nearest_class",
        Kind.TEXT,
        lambda source: source.segment.gait.nearest,
        "class whose phases are nearest, whether it fits or not",
        null="not four feet whose leg positions are known; a foot has no touchdowns in it",
    ),
    Figure[SegmentSource](
        "class_distance",
        Kind.NUMBER,
        lambda source: source.segment.gait.distance,
        "largest deviation of the phases from what defines the nearest class",
        unit="cycles",
        null="as `nearest_class`",
    ),
    Figure[SegmentSource](
        "duty_below_half",
        Kind.FLAG,
        lambda source: source.segment.duty_below_half,
        "whether the duty factor is below 0.5; not a definition of running (Biknevicius and Reilly "
        "2006)",
        null=_NO_STRIDE,
    ),
    Figure[SegmentSource](
        "duty_factor",
        Kind.FRACTION,
        lambda source: source.segment.duty_factor,
        "mean of the feet's mean duty factors",
        null=_NO_STRIDE,
        columns=(
            Column(_SUMMARY, "duty", 3, rank=20),
            Column(_INDEX, "duty", 3, rank=20),
            Column(_LOG_ROWS, "gait_duty_factor", rank=40),
        ),
    ),
    Figure[SegmentSource](
        "stride_frequency_hz",
        Kind.NUMBER,
        lambda source: source.segment.stride_frequency_hz,
        "stride frequency of the reference foot",
        null="the reference foot makes no whole stride in it",
        columns=(
            Column(_SUMMARY, "strides/s", 3, rank=30),
            Column(_INDEX, "strides/s", 3, rank=30),
            Column(_LOG_ROWS, "gait_stride_frequency_hz", rank=40),
        ),
    ),
    Figure[SegmentSource](
        "diagonality",
        Kind.FRACTION,
        _diagonality,
        "share of the stride by which a hind footfall precedes the fore one of its side, mean of "
        "both sides on the circle (Cartmill, Lemelin and Schmitt 2002)",
        unit="cycles",
        null="not four feet whose leg positions are known; a foot has no touchdowns in it",
    ),
    Figure[SegmentSource](
        "limb_phase",
        Kind.FRACTIONS_BY_NAME,
        _limb_phase,
        "share of the stride by which the hind footfall precedes the fore one, left and right",
        unit="cycles",
        null="not four feet whose leg positions are known; a foot has no touchdowns in it",
    ),
    Figure[SegmentSource](
        "moves_without_steps",
        Kind.FLAG,
        lambda source: source.segment.moves_without_steps,
        "whether all feet stay down while the base moves: no gait is claimed",
    ),
    Scope(
        "phase",
        _PHASE,
        lambda source: source.phases,
        "phase of each foot in the stride of the reference foot",
        shape=Shape.BY_NAME,
        null_items="the foot has no touchdowns in the strides of the reference foot",
    ),
    Scope(
        "phase_left_hind",
        _PHASE_OF_HIND,
        lambda source: source.hind_phases,
        "phase of each foot in the stride of the left hind foot, as papers often have it",
        shape=Shape.BY_NAME,
        null="no left hind foot, or it makes no whole stride",
        null_items="the foot has no touchdowns in the strides of the left hind foot",
    ),
)
"""Figures of the gait of a `SegmentSource`."""

SEGMENT: Final[Sequence[Member]] = (
    Figure[SegmentSource](
        "start_s",
        Kind.NUMBER,
        lambda source: source.seconds(source.segment.start),
        "its start, since the log's start",
    ),
    Figure[SegmentSource](
        "end_s",
        Kind.NUMBER,
        lambda source: source.seconds(source.segment.end),
        "its end, since the log's start",
    ),
    Figure[SegmentSource](
        "strides",
        Kind.COUNT,
        lambda source: source.segment.strides,
        "whole strides of the reference foot",
    ),
    *GAIT,
    Figure[SegmentSource](
        "flight_fraction",
        Kind.FRACTION,
        lambda source: source.segment.flight_fraction,
        "share of the time with no foot down",
        null=_NO_SUPPORT,
    ),
    Figure[SegmentSource](
        "double_support_fraction",
        Kind.FRACTION,
        lambda source: _double_support(source.figures.support),
        "share of the time with both of two feet down",
        null=f"not two feet; {_NO_SUPPORT}",
    ),
    Scope(
        "base",
        BASE,
        lambda source: source.figures.base,
        "motion of the base in it",
        null="fewer than two poses in it",
    ),
    Scope(
        "feet",
        FOOT_OF_SEGMENT,
        lambda source: source.feet,
        "each foot in it; aggregates are over its whole stances or strides",
        shape=Shape.BY_NAME,
    ),
    Scope("forces", FORCES_OF_SEGMENT, lambda source: source.load_source, "loads in it"),
    Scope(
        "stability",
        STABILITY,
        lambda source: source.figures.stability,
        "static stability in it, at 25 instants a second",
        null="there is no time in it in which the base and the state of every foot are known",
    ),
    Scope(
        "commands",
        COMMANDS_OF_SEGMENT,
        lambda source: source.figures.commands,
        "how the base follows its velocity commands in it",
        null="the log has no velocity commands, or no poses",
    ),
)
"""Figures of a `SegmentSource`."""


@dataclass(frozen=True, slots=True)
class SupportSet:
    """Feet that are down at once, and for which part of the time."""

    feet: list[str]
    fraction: float


def _support_sets(stats: Stats) -> list[SupportSet] | None:
    if stats.support is None:
        return None
    return [
        SupportSet([stats.feet[foot].name for foot in feet], fraction)
        for feet, fraction in stats.support.sets
    ]


def _feet_down(support: Support) -> dict[str, float]:
    return {str(number): fraction for number, fraction in enumerate(support.feet_down)}


_SETS: Final[Sequence[Figure[SupportSet]]] = (
    Figure("feet", Kind.TEXTS, lambda each: each.feet, "the feet that are down"),
    Figure("fraction", Kind.FRACTION, lambda each: each.fraction, "share of the time"),
)


def _support(stats: Stats) -> Any:  # noqa: ANN401 - None or support
    return stats.support


SUPPORT: Final[Sequence[Member]] = (
    *inside(
        (
            Figure(
                "support",
                Kind.FRACTIONS_BY_NAME,
                _feet_down,
                "share of the time with 0, 1, 2 ... feet down, of the time known to all feet",
            ),
        ),
        _support,
        _NO_SUPPORT,
    ),
    Scope(
        "support_sets",
        _SETS,
        _support_sets,
        "the most frequent sets of feet that are down at once",
        null=_NO_SUPPORT,
        shape=Shape.LIST,
    ),
    *inside(
        (
            Figure(
                "flight_fraction",
                Kind.FRACTION,
                lambda support: support.flight_fraction,
                "share of the time with no foot down, of the time known to all feet",
            ),
            Figure(
                "double_support_fraction",
                Kind.FRACTION,
                lambda support: support.double_support_fraction,
                "share of the time with both of two feet down",
                null="not two feet",
            ),
        ),
        _support,
        _NO_SUPPORT,
    ),
)
"""Figures of the support pattern, from `Stats`."""
