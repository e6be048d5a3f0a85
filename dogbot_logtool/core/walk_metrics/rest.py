"""Metrics of settings and recording, joints, commands and accelerometer: of the whole log only."""

from collections.abc import Sequence
from dataclasses import replace

from dogbot_logtool.core import timespans
from dogbot_logtool.core.checks.engine import questions_of
from dogbot_logtool.core.metrics import (
    Commands,
    FootQuality,
    FootSettings,
    Imu,
    Quality,
    Settings,
    TopicQuality,
)
from dogbot_logtool.core.records import taken, unknown
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.finding import Finding


def settings_metrics(walk: Walk, findings: Sequence[Finding]) -> Settings:
    """Return what decided the metrics of a log."""
    settings, loads = walk.settings, walk.loads
    offset = settings.com_offset_m
    return Settings(
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


def _foot_settings(walk: Walk, row: int) -> FootSettings:
    foot, sensor = walk.feet[row], walk.settings.sensor(row)
    position = foot.leg_position
    return FootSettings(
        topic=foot.topic or None,
        leg_position=None if position is None else tuple(position),
        contact_on_n=sensor.rule.on_n,
        contact_off_n=sensor.rule.off_n,
        debounce_s=sensor.rule.debounce_s,
        offset_from=sensor.level.origin,
    )


def quality_metrics(walk: Walk, findings: Sequence[Finding]) -> Quality:
    """Return what tells whether a recording can be trusted."""
    worlds = walk.worlds
    return Quality(
        topics={topic.topic: taken(TopicQuality, topic) for topic in walk.topics},
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


def _foot_quality(walk: Walk, row: int) -> FootQuality:
    foot, level = walk.feet[row], walk.settings.sensor(row).level
    return taken(
        FootQuality,
        foot.record,
        discarded_strides=dict(foot.discarded),
        spikes=foot.spikes,
        force_offset_n=None if level.reason else tuple(level.offset_n.tolist()),
        force_noise_n=level.noise_n,
        force_drift_n_per_min=level.drift_n_per_min,
    )


def commands_metrics(walk: Walk) -> Commands:
    """Return how the base follows its velocity commands over the whole log."""
    if walk.command_track is None:
        return replace(unknown(Commands), topic=walk.settings.command_topic or None)
    return walk.command_track.metrics()


def imu_metrics(walk: Walk) -> Imu:
    """Return what the accelerometer says of forces and poses."""
    return unknown(Imu) if walk.imu is None else walk.imu.metrics()
