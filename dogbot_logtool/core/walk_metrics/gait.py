"""Metrics of how the feet are coordinated."""

from collections.abc import Sequence
from typing import Final

from dogbot_logtool.core.arrays import CircularMean
from dogbot_logtool.core.gait.gait import STAND
from dogbot_logtool.core.gait.gait_classes import TOLERANCE
from dogbot_logtool.core.gait.phases import diagonality, limb_phases
from dogbot_logtool.core.gait.segments import Segment
from dogbot_logtool.core.gait.support_pattern import Support
from dogbot_logtool.core.metrics import Gait, LimbPhase, Phase, SupportSet
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.core.walk_metrics.span import Span

FEWEST_STRIDES: Final = 3
"""Strides from which phases can be consistent."""


def gait_metrics(span: Span) -> Gait:
    """Return the gait of a span; of the whole log that of its longest segment."""
    segment, support, corners = span.segment, span.support, _corner_phases(span)
    gait = None if segment is None else segment.gait
    return Gait(
        name=None if gait is None else gait.name,
        confidence=None if segment is None else _confidence(segment),
        sequence=None if gait is None else gait.sequence,
        nearest_name=None if gait is None else gait.nearest,
        class_distance=None if gait is None else gait.distance,
        diagonality=None if corners is None else diagonality(corners),
        limb_phase=LimbPhase(*((None, None) if corners is None else limb_phases(corners))),
        duty_factor=None if segment is None else segment.duty_factor,
        stride_frequency_hz=None if segment is None else segment.stride_frequency_hz,
        strides=_strides(span),
        flight_fraction=_flight(span),
        double_support_fraction=None if support is None else support.double_support_fraction,
        support=None if support is None else _feet_down(support),
        support_sets=None if support is None else _support_sets(support, span.names),
        phase=_phases(span.stats, segment),
    )


def _confidence(segment: Segment) -> float | None:
    """Return how sure the class is, 0 to 1; None where phases do not tell."""
    gait = segment.gait
    if gait.name == STAND:
        return 1.0
    consistency = [phase.consistency for phase in segment.phases if phase is not None]
    if gait.name is None or gait.distance is None or not consistency:
        return None
    fit = max(0.0, 1.0 - gait.distance / (2.0 * TOLERANCE))
    return fit * min(consistency) * min(1.0, segment.strides / FEWEST_STRIDES)


def _strides(span: Span) -> int | None:
    if span.segment is not None:
        return span.segment.strides
    stats = span.stats
    return len(stats.feet[stats.reference].strides.stance) if stats.feet else None


def _flight(span: Span) -> float | None:
    if span.is_whole:
        return None if span.support is None else span.support.flight_fraction
    return None if span.segment is None else span.segment.flight_fraction


def _corner_phases(span: Span) -> list[float] | None:
    """Return the mean phases of the four corners; None unless all are known."""
    if span.segment is None:
        return None
    corners = [span.segment.phases[foot] for foot in span.stats.corners or ()]
    phases = [phase.mean for phase in corners if phase is not None]
    return phases if len(phases) == 4 else None


def _feet_down(support: Support) -> dict[str, float]:
    return {str(number): fraction for number, fraction in enumerate(support.feet_down)}


def _support_sets(support: Support, names: Sequence[str]) -> tuple[SupportSet, ...]:
    return tuple(
        SupportSet(tuple(names[foot] for foot in feet), fraction) for feet, fraction in support.sets
    )


def _phases(stats: Stats, segment: Segment | None) -> dict[str, Phase]:
    own = None if segment is None else segment.phases
    hind = None if segment is None else segment.hind_phases
    return {
        foot.name: _phase(None if own is None else own[row], None if hind is None else hind[row])
        for row, foot in enumerate(stats.feet)
    }


def _phase(own: CircularMean | None, hind: CircularMean | None) -> Phase:
    return Phase(
        mean=None if own is None else own.mean,
        consistency=None if own is None else own.consistency,
        left_hind=None if hind is None else hind.mean,
    )
