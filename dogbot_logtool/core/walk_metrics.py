"""All metrics of a walk as records.

metrics = metrics_of(walk, log, findings)
metrics.gait.name, metrics.feet["front_left"].stance_s.median
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, Final

from dogbot_logtool.core import metrics, timespans
from dogbot_logtool.core.arrays import Aggregate, Ints, aggregate
from dogbot_logtool.core.checks.engine import questions_of
from dogbot_logtool.core.events.events import find_events
from dogbot_logtool.core.gait.feet import foot_metrics
from dogbot_logtool.core.gait.segments import Segment, no_gait
from dogbot_logtool.core.gait.support import Support
from dogbot_logtool.core.loads import WalkLoads, share_of, symmetry_index_percent
from dogbot_logtool.core.nulls import null_because
from dogbot_logtool.core.records import copied, unknown, void
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.finding import Finding

_PAIRS: Final = {"fore": (0, 1), "hind": (2, 3)}
"""Corners, left and right, of the pairs of a quadruped."""


def metrics_of(walk: Walk, log: metrics.Log, findings: Sequence[Finding]) -> metrics.WalkMetrics:
    """Return all metrics of a log; those that findings void are null.

    Args:
        walk: all that was worked out of it.
        log: what was read.
        findings: about the log and its metrics, the worst first.
    """
    main, support = walk.main, walk.support
    gait = _supported(walk, no_gait(walk.feet) if main is None else main.gait, support)
    gait = replace(gait, flight_fraction=None if support is None else support.feet_down[0])
    feet = {
        foot.name: replace(_foot(walk, row), planned=_planned(walk, row))
        for row, foot in enumerate(walk.feet)
    }
    strides = sum(segment.strides for segment in walk.segments)
    own = len(walk.feet[walk.reference].strides.stance) if walk.feet else None
    if main is None:
        gait = replace(gait, strides=own)
    measured = metrics.WalkMetrics(
        schema_version=metrics.SCHEMA_VERSION,
        log=log,
        settings=_settings_metrics(walk, findings),
        base=walk.base or unknown(metrics.Base),
        gait=copied(
            metrics.GaitOfLog,
            gait,
            transition_strides=0 if own is None else own - strides,
            segments=tuple(_segment(walk, each) for each in walk.segments),
        ),
        feet=feet,
        forces=_forces(walk, walk.loads, feet),
        stability=walk.stability or unknown(metrics.Stability),
        legs=unknown(metrics.Legs) if walk.legs is None else walk.legs.metrics,
        commands=_commands_metrics(walk),
        imu=_imu_metrics(walk),
        quality=_quality_metrics(walk, findings),
        events=find_events(walk),
        findings=tuple(map(_finding, findings)),
        null_because={},
    )
    voided = void(measured, [pattern for each in findings for pattern in each.voids])
    return replace(voided, null_because=null_because(voided, walk, findings))


def _settings_metrics(walk: Walk, findings: Sequence[Finding]) -> metrics.Settings:
    """Return what decided the metrics of a log."""
    settings, loads = walk.settings, walk.loads
    offset = settings.com_offset_m
    return metrics.Settings(
        robot=settings.robot,
        robot_guessed=settings.robot_is_guessed,
        clock=settings.clock.value,
        mass_kg=settings.mass_kg,
        body_weight_n=loads.weight_n,
        weight_source=loads.weight_source,
        forward_axis=settings.forward_axis,
        wrench_frame=settings.wrench_frame.value,
        reference_foot=walk.feet[walk.reference].name if walk.feet else None,
        com_offset_m=None if offset is None else tuple(offset),
        base_from=_base_from(walk),
        contact_from=_contact_from(walk, findings),
        feet={foot.name: _foot_settings(walk, row) for row, foot in enumerate(walk.feet)},
    )


def _base_from(walk: Walk) -> str | None:
    if not len(walk.base_history.time):
        return None
    by_legs = walk.settings.base_from_legs or walk.ground is not None
    return "legs" if by_legs else "pose"


def _contact_from(walk: Walk, findings: Sequence[Finding]) -> str | None:
    if all(foot.record.start is None for foot in walk.feet):
        return None
    is_planned = any(each.code == "PLANNED" and not each.cases for each in findings)
    return "plan" if is_planned else walk.settings.contact_from or "sensor"


def _foot_settings(walk: Walk, row: int) -> metrics.FootSettings:
    foot, sensor = walk.feet[row], walk.settings.feet[row]
    position = foot.leg_position
    return metrics.FootSettings(
        topic=foot.topic or None,
        leg_position=None if position is None else tuple(position),
        contact_on_n=sensor.rule.on_n,
        contact_off_n=sensor.rule.off_n,
        debounce_s=sensor.rule.debounce_s,
        offset_from=sensor.level.origin,
    )


def _quality_metrics(walk: Walk, findings: Sequence[Finding]) -> metrics.Quality:
    """Return what tells whether a recording can be trusted."""
    worlds, topics = walk.worlds, walk.corrected.topics
    return metrics.Quality(
        topics={topic.topic: copied(metrics.TopicQuality, topic) for topic in topics},
        feet={foot.name: _foot_quality(walk, row) for row, foot in enumerate(walk.feet)},
        overlap_s=_overlap_s(walk),
        base_to_feet_m=None if worlds is None else worlds.distance_m,
        feet_spread_m=None if worlds is None else worlds.spread_m,
        checks=questions_of(walk, findings),
    )


def _overlap_s(walk: Walk) -> float:
    """Return the time known to all feet that have samples, and to the base if it has poses."""
    known = [each.known for each in walk.records if each.start is not None]
    if len(walk.poses.time):
        known.append(walk.poses.known)
    return timespans.total(timespans.intersect(known)) / 1e9


def _foot_quality(walk: Walk, row: int) -> metrics.FootQuality:
    foot, level = walk.feet[row], walk.settings.feet[row].level
    return copied(
        metrics.FootQuality,
        foot.record,
        discarded_strides=dict(foot.discarded),
        spikes=foot.spikes,
        force_offset_n=None if level.reason else tuple(level.offset_n.tolist()),
        force_noise_n=level.noise_n,
        force_drift_n_per_min=level.drift_n_per_min,
    )


def _commands_metrics(walk: Walk) -> metrics.Commands:
    """Return how the base follows its velocity commands over the whole log."""
    if walk.command_track is None:
        return replace(unknown(metrics.Commands), topic=walk.settings.command_topic or None)
    return walk.command_track.metrics()


def _imu_metrics(walk: Walk) -> metrics.Imu:
    """Return what the accelerometer says of forces and poses."""
    return unknown(metrics.Imu) if walk.imu is None else walk.imu.metrics()


def _segment(walk: Walk, segment: Segment) -> metrics.Segment:
    """Measure a segment: the same metrics over another span."""
    within = segment.spans
    feet = {foot.name: _foot(walk, row, within) for row, foot in enumerate(walk.feet)}
    return metrics.Segment(
        start_s=(segment.start - walk.origin) / 1e9,
        end_s=(segment.end - walk.origin) / 1e9,
        base=walk.base_in(within) or unknown(metrics.Base),
        gait=_supported(walk, segment.gait, walk.support_in(within)),
        feet=feet,
        forces=_forces(walk, walk.loads_in(within), feet),
        stability=walk.stability_in(within) or unknown(metrics.Stability),
    )


def _foot(walk: Walk, row: int, within: Ints | None = None) -> metrics.Foot:
    """Return the metrics of a foot, and of its swings where its leg tells them."""
    foot = walk.feet[row]
    found = foot_metrics(foot, walk.loads.weight_n, walk.origin, within)
    if walk.legs is None:
        return found
    leg = walk.legs.feet[row]
    inside = slice(None) if within is None else foot.strides.rows_within(within)
    # Work of legs stands in the table of strides only.
    named = [name for name in leg.strides if hasattr(found, name)]
    swings = {name: aggregate(leg.strides[name][inside]) for name in named}
    return replace(
        found,
        **dict[str, Any](swings),
        height_over_stride_m=leg.height if within is None else None,
    )


def _planned(walk: Walk, row: int) -> metrics.Planned | None:
    """Return how a foot follows its plan over the whole log; None without one."""
    plan = walk.planned[row] if walk.planned else None
    return None if plan is None else plan.metrics


def _supported(walk: Walk, gait: metrics.Gait, support: Support | None) -> metrics.Gait:
    """Return a gait with the support in its time, where that is known."""
    if support is None:
        return gait
    names = [foot.name for foot in walk.feet]
    return replace(
        gait,
        double_support_fraction=support.feet_down[2] if len(names) == 2 else None,
        support={str(number): share for number, share in enumerate(support.feet_down)},
        support_sets=tuple(
            metrics.SupportSet(tuple(names[foot] for foot in feet), share)
            for feet, share in support.sets
        ),
    )


def _forces(walk: Walk, loads: WalkLoads, feet: dict[str, metrics.Foot]) -> metrics.Forces:
    """Return the loads of the whole robot over a span."""
    share = unknown(metrics.LoadShare)
    if loads.shares is not None:
        positions = [foot.leg_position for foot in walk.feet]
        fore, left = (share_of(word, loads.shares, positions) for word in ("front", "left"))
        share = metrics.LoadShare(dict(zip(feet, loads.shares, strict=True)), fore, left)
    corners, each = walk.corners, list(feet.values())
    return metrics.Forces(
        vertical_impulse_over_weight=loads.vertical_impulse_over_weight,
        load_share=share,
        symmetry_index_percent={}
        if corners is None
        else {
            name: _symmetry(each[corners[left]], each[corners[right]])
            for name, (left, right) in _PAIRS.items()
        },
    )


def _symmetry(left: metrics.Foot, right: metrics.Foot) -> metrics.Symmetry:
    return metrics.Symmetry(
        stance_s=_index(left.stance_s, right.stance_s),
        duty_factor=_index(left.duty_factor, right.duty_factor),
        peak_force_n=_index(left.peak_force_n, right.peak_force_n),
    )


def _index(left: Aggregate | None, right: Aggregate | None) -> float | None:
    """Return the symmetry index of two means, percent."""
    means = [None if each is None else each.mean for each in (left, right)]
    return symmetry_index_percent(*means)


def _finding(finding: Finding) -> metrics.Finding:
    return metrics.Finding(
        code=finding.code,
        severity=finding.severity.word,
        text=finding.text,
        remedy=finding.remedy,
        where=finding.where or None,
        voids=tuple(finding.voids),
    )
