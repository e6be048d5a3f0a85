"""All metrics of a walk as records.

metrics = metrics_of(walk, log, findings)
metrics.gait.name, metrics.feet["front_left"].stance_s.median
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from dogbot_logtool.core import metrics, timespans
from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.core.base.motion import base_motion
from dogbot_logtool.core.checks.engine import null_because, questions_of
from dogbot_logtool.core.events import find_events
from dogbot_logtool.core.gait.feet import foot_metrics
from dogbot_logtool.core.gait.segments import no_gait, with_support
from dogbot_logtool.core.loads import WalkLoads, share_of, symmetry_index_percent
from dogbot_logtool.core.records import copied, fields_of, unknown, void
from dogbot_logtool.core.settings import legs_in_order
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.finding import Finding


def metrics_of(walk: Walk, log: metrics.Log, findings: Sequence[Finding]) -> metrics.WalkMetrics:
    """Return all metrics of a log; those that findings void are null.

    Args:
        walk: all that was worked out of it.
        log: what was read.
        findings: about the log and its metrics, the worst first.
    """
    track = walk.command_track
    no_commands = replace(unknown(metrics.Commands), topic=walk.settings.command_topic or None)
    groups = _of_span(walk, timespans.ALWAYS)
    for row, (name, foot) in enumerate(groups["feet"].items()):
        plan = walk.planned[row] if walk.planned else None
        height = None if walk.legs is None else walk.legs.feet[row].height
        planned = None if plan is None else plan.metrics
        groups["feet"][name] = replace(foot, height_over_stride_m=height, planned=planned)
    measured = metrics.WalkMetrics(
        schema_version=metrics.SCHEMA_VERSION,
        log=log,
        settings=_settings(walk, findings),
        gait=_gait(walk),
        **groups,
        legs=unknown(metrics.Legs) if walk.legs is None else walk.legs.metrics,
        commands=no_commands if track is None else track.metrics(),
        imu=unknown(metrics.Imu) if walk.imu is None else walk.imu.metrics,
        quality=_quality(walk, findings),
        events=find_events(walk),
        findings=tuple(map(_finding, findings)),
        null_because={},
    )
    voided = void(measured, [pattern for each in findings for pattern in each.voids])
    return replace(voided, null_because=null_because(voided, walk, findings))


def _gait(walk: Walk) -> metrics.GaitOfLog:
    """Return the gait of the longest segment, with the support of the whole log."""
    own = len(walk.feet[walk.reference].strides.stance) if walk.feet else None
    gait = replace(no_gait(walk.feet), strides=own) if walk.main is None else walk.main.gait
    segments = [
        metrics.Segment(
            start_s=(each.start - walk.origin) / 1e9,
            end_s=(each.end - walk.origin) / 1e9,
            gait=each.gait,
            **_of_span(walk, each.span),
        )
        for each in walk.segments
    ]
    return copied(
        metrics.GaitOfLog,
        with_support(gait, walk.support, walk.feet),
        transition_strides=(own or 0) - sum(segment.strides for segment in walk.segments),
        segments=tuple(segments),
    )


def _of_span(walk: Walk, within: Ints) -> dict[str, Any]:
    """Return what is measured of the whole log and, with the same names, of each segment."""
    forward_rad = walk.settings.forward_rad
    feet = {
        foot.name: foot_metrics(foot, walk.loads.weight_n, walk.origin, within)
        for foot in walk.feet
    }
    return {
        "base": base_motion(walk.track, forward_rad, within) or unknown(metrics.Base),
        "feet": feet,
        "forces": _forces(walk, walk.loads_in(within), feet),
        "stability": walk.stability_in(within) or unknown(metrics.Stability),
    }


def _forces(walk: Walk, loads: WalkLoads, feet: Mapping[str, metrics.Foot]) -> metrics.Forces:
    """Return the loads of the whole robot over a span."""
    share, symmetry = unknown(metrics.LoadShare), {}
    positions = [foot.leg_position for foot in walk.feet]
    if loads.shares is not None:
        fore, left = (share_of(word, loads.shares, positions) for word in ("front", "left"))
        share = metrics.LoadShare(dict(zip(feet, loads.shares, strict=True)), fore, left)
    in_order = [list(feet.values())[row] for row in legs_in_order(positions) or ()]
    if len(in_order) == 4:
        symmetry = {"fore": _symmetry(*in_order[:2]), "hind": _symmetry(*in_order[2:])}
    return metrics.Forces(loads.vertical_impulse_over_weight, share, symmetry)


def _symmetry(left: metrics.Foot, right: metrics.Foot) -> metrics.Symmetry:
    """Compare the means of a pair of feet."""
    indices = {}
    for field in fields_of(metrics.Symmetry):
        sides = (getattr(foot, field.name) for foot in (left, right))
        indices[field.name] = symmetry_index_percent(*(each and each.mean for each in sides))
    return metrics.Symmetry(**indices)


def _settings(walk: Walk, findings: Sequence[Finding]) -> metrics.Settings:
    """Return what decided the metrics of a log."""
    settings = walk.settings
    feet = {
        foot.name: metrics.FootSettings(
            topic=foot.topic or None,
            leg_position=foot.leg_position,
            contact_on_n=foot.rule.on_n,
            contact_off_n=foot.rule.off_n,
            debounce_s=foot.rule.debounce_s,
            offset_from=foot.level.origin,
        )
        for foot in settings.feet
    }
    base_from = None
    if len(walk.base_history.time):
        base_from = "legs" if settings.base_from_legs or walk.ground is not None else "pose"
    contact_from = None
    if any(foot.record.start is not None for foot in walk.feet):
        is_planned = any(each.code == "PLANNED" and not each.cases for each in findings)
        contact_from = "plan" if is_planned else settings.contact_from or "sensor"
    return copied(
        metrics.Settings,
        settings,
        robot_guessed=settings.robot_is_guessed,
        clock=settings.clock.value,
        body_weight_n=walk.loads.weight_n,
        weight_source=walk.loads.weight_source,
        wrench_frame=settings.wrench_frame.value,
        reference_foot=walk.feet[walk.reference].name if walk.feet else None,
        base_from=base_from,
        contact_from=contact_from,
        feet=feet,
    )


def _quality(walk: Walk, findings: Sequence[Finding]) -> metrics.Quality:
    """Return what tells whether a recording can be trusted."""
    worlds, topics = walk.worlds, walk.corrected.topics
    known = [each.known for each in walk.records if each.start is not None]
    if len(walk.poses.time):
        known.append(walk.poses.known)
    return metrics.Quality(
        topics={topic.topic: copied(metrics.TopicQuality, topic) for topic in topics},
        feet={foot.name: _foot_quality(walk, row) for row, foot in enumerate(walk.feet)},
        overlap_s=timespans.total(timespans.intersect(known)) / 1e9,
        base_to_feet_m=None if worlds is None else worlds.distance_m,
        feet_spread_m=None if worlds is None else worlds.spread_m,
        checks=questions_of(walk, findings),
    )


def _foot_quality(walk: Walk, row: int) -> metrics.FootQuality:
    foot, level = walk.feet[row], walk.settings.feet[row].level
    return copied(
        metrics.FootQuality,
        foot.record,
        discarded_strides=dict(foot.discarded),
        spikes=len(foot.spikes),
        force_offset_n=None if level.reason else tuple(level.offset_n.tolist()),
        force_noise_n=level.noise_n,
        force_drift_n_per_min=level.drift_n_per_min,
    )


def _finding(finding: Finding) -> metrics.Finding:
    return copied(
        metrics.Finding,
        finding,
        severity=finding.severity.word,
        where=finding.where or None,
        voids=tuple(finding.voids),
    )
