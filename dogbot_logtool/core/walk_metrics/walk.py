"""All metrics of a walk as records.

walk = metrics_of(stats, log, chosen, findings)
walk.gait.name, walk.feet["front_left"].stance_s.median
"""

from collections.abc import Sequence
from dataclasses import replace

from dogbot_logtool.core import metrics
from dogbot_logtool.core.events.events import find_events
from dogbot_logtool.core.metrics import (
    SCHEMA_VERSION,
    Event,
    GaitOfLog,
    Legs,
    Log,
    Segment,
    WalkMetrics,
    void,
)
from dogbot_logtool.core.records import fields_of, unknown
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.core.walk_metrics.base import base_metrics
from dogbot_logtool.core.walk_metrics.feet import feet_metrics
from dogbot_logtool.core.walk_metrics.gait import gait_metrics
from dogbot_logtool.core.walk_metrics.loads import forces_metrics, stability_metrics
from dogbot_logtool.core.walk_metrics.nulls import null_because
from dogbot_logtool.core.walk_metrics.quality import quality_metrics
from dogbot_logtool.core.walk_metrics.settings import Chosen, settings_metrics
from dogbot_logtool.core.walk_metrics.side_topics import commands_metrics, imu_metrics
from dogbot_logtool.core.walk_metrics.span import Span, segments, whole_log
from dogbot_logtool.finding import Finding


def metrics_of(stats: Stats, log: Log, chosen: Chosen, findings: Sequence[Finding]) -> WalkMetrics:
    """Return all metrics of a log; those that findings void are null.

    Args:
        stats: all that was worked out of it.
        log: what was read.
        chosen: robot and sources of contact.
        findings: about the log and its metrics, the worst first.
    """
    span = whole_log(stats)
    measured = WalkMetrics(
        schema_version=SCHEMA_VERSION,
        log=log,
        settings=settings_metrics(stats, chosen),
        base=base_metrics(span),
        gait=_gait(span),
        feet=feet_metrics(span),
        forces=forces_metrics(span),
        stability=stability_metrics(span),
        legs=unknown(Legs) if stats.legs is None else stats.legs.metrics,
        commands=commands_metrics(stats),
        imu=imu_metrics(stats),
        quality=quality_metrics(stats, findings),
        events=_events(stats),
        findings=tuple(map(_finding, findings)),
        null_because={},
    )
    walk = void(measured, [pattern for each in findings for pattern in each.voids])
    return replace(walk, null_because=null_because(walk, stats, findings))


def _gait(span: Span) -> GaitOfLog:
    own = gait_metrics(span)
    return GaitOfLog(
        **{field.name: getattr(own, field.name) for field in fields_of(metrics.Gait)},
        transition_strides=span.stats.transition_strides,
        segments=tuple(map(_segment, segments(span.stats))),
    )


def _segment(span: Span) -> Segment:
    origin, segment = span.stats.origin, span.segment
    start, end = (0, 0) if segment is None else (segment.start, segment.end)
    return Segment(
        start_s=(start - origin) / 1e9,
        end_s=(end - origin) / 1e9,
        base=base_metrics(span),
        gait=gait_metrics(span),
        feet=feet_metrics(span),
        forces=forces_metrics(span),
        stability=stability_metrics(span),
    )


def _events(stats: Stats) -> tuple[Event, ...]:
    names = [foot.name for foot in stats.feet]
    return tuple(
        Event(
            onset_s=(each.onset - stats.origin) / 1e9,
            duration_s=each.duration / 1e9,
            type=each.type.value,
            foot=None if each.foot is None else names[each.foot],
            value=each.value,
            unit=each.unit or None,
            code=each.code or None,
        )
        for each in find_events(stats)
    )


def _finding(finding: Finding) -> metrics.Finding:
    return metrics.Finding(
        code=finding.code,
        severity=finding.severity.word,
        text=finding.text,
        remedy=finding.remedy,
        where=finding.where or None,
        voids=tuple(finding.voids),
    )
