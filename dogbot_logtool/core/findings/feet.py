"""Findings about one foot and its sensor."""

from collections.abc import Iterator
from typing import Final

import numpy as np

from dogbot_logtool.core.findings.wording import counted
from dogbot_logtool.core.gait.foot_statistics import FootStatistics
from dogbot_logtool.core.geometry import timespans
from dogbot_logtool.core.load.load_figures import is_stuck, vertical_is_known
from dogbot_logtool.core.load.slip import LARGEST_FOOT_M
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.finding import Finding

SOME_S: Final = 0.1
"""s, time from which a lack is worth a warning."""


def foot_findings(stats: Stats, foot: FootStatistics) -> Iterator[Finding]:
    """Yield what is missing or doubtful in the figures of a foot."""
    record, name, where = foot.record, foot.name, f"feet.{foot.name}"
    if record.messages == 0:
        topic = f" on {foot.topic}" if foot.topic else ""
        yield Finding("W_NO_MESSAGES", f"no message{topic} tells of {name}", where)
        return
    if stats.settings.sensor(stats.feet.index(foot)).rule.unusable:
        return
    if record.start is None:
        yield Finding("W_NOTHING_USABLE", f"no message of {name} can be used", where)
        return
    if foot.is_dead:
        yield _fault(stats, foot, where) or Finding(
            "W_DEAD",
            f"{name} never touches the ground: its sensor seems dead, or the foot is lifted",
            where,
        )
        return
    if len(foot.stances.touchdown) == 0:
        text = f"{name} never touches the ground, and the other feet carry the whole weight"
        yield Finding("N_LIFTED", text, where)
        return
    yield from _sensor(stats, foot, where)
    if foot.stance_s is None:
        text = f"no stance of {name} is seen from touchdown to lift-off: no stance figures"
        yield Finding("N_NO_STANCES", text, f"{where}.stance_s")
    if not len(foot.strides.stance):
        text = f"{name} makes no whole stride, so it has no stride figures"
        yield Finding("N_NO_STRIDES", text, f"{where}.strides")
    yield from _force_reasons(stats, foot, where)
    if foot.stance_s is not None:
        yield from _stance_reasons(stats, foot, where)
    yield from _base_reasons(stats, foot, where)


def _fault(stats: Stats, foot: FootStatistics, where: str) -> Finding | None:
    """Return that a sensor is stuck, or has stopped at times; None: neither."""
    others = [other.record for other in stats.feet if other is not foot]
    spans = foot.record.stopped
    if is_stuck(foot.record, others):
        text = f"the sensor of {foot.name} shows one constant force while it is loaded: stuck"
        return Finding("W_STUCK", f"{text}; no loads", where)
    if not len(spans):
        return None
    start, end = stats.seconds(spans.ravel()[[0, -1]])
    lasts = timespans.total(spans) / 1e9
    text = (
        f"no step of {foot.name} is seen from {start:.2f} s to {end:.2f} s ({lasts:.1f} s in all) "
        "while other feet go on: its load is missing, stays the same, or stays while the base "
        "goes away; its sensor has stopped, or what it reads without load is not what it "
        "seems; contact and load are not known then"
    )
    return Finding("W_STOPPED", text, where)


def _base_reasons(stats: Stats, foot: FootStatistics, where: str) -> Iterator[Finding]:
    name = foot.name
    if foot.strides.stance.size and foot.stride_length_m is None:
        why = "no odometry around the touchdowns"
        if stats.clocks_apart & {foot.topic, stats.settings.odometry_topic}:
            why = "the odometry's clock is not that"
        elif stats.loses_way:
            why = "the odometry drifts among the contact points"
        text = f"{why} of {name}: its stride length is not known"
        yield Finding("N_NO_STRIDE_LENGTH", text, f"{where}.stride_length_m")
    without_pose = stats.contact_without_pose_s[stats.feet.index(foot)]
    if len(stats.base_history.time) and without_pose > SOME_S:
        text = f"{name} is in contact for {without_pose:.1f} s further than 0.1 s from odometry"
        yield Finding("W_CONTACT_WITHOUT_ODOMETRY", text, where)


def _sensor(stats: Stats, foot: FootStatistics, where: str) -> Iterator[Finding]:
    record, name = foot.record, foot.name
    fault = _fault(stats, foot, where)
    if fault:
        yield fault
    if foot.is_saturated:
        limit_n = stats.settings.sensor(stats.feet.index(foot)).level.limit_n
        at = "" if limit_n is None else f" at {limit_n:.4g} N"
        text = f"forces of {name} are cut off{at}: its sensor seems saturated; no peaks"
        yield Finding("W_SATURATED", text, where)
    if foot.spikes:
        spikes = counted(foot.spikes, "lone spike")
        text = f"{spikes} in the force of {name}, far above all else in a stance: not in its peaks"
        yield Finding("W_SPIKES", text, f"{where}.peak_force_n")
    if record.not_finite:
        messages = counted(record.not_finite, "message")
        text = f"{messages} of {name} with a force that is not finite; left out"
        if stats.settings.sensor(stats.feet.index(foot)).level.drops_out:
            text = f"{messages} of {name} without a force (lone zeros under load); left out"
        yield Finding("W_NOT_FINITE", text, where)
    if record.not_advancing:
        messages = counted(record.not_advancing, "message")
        text = f"{messages} of {name} with a time that repeats or steps back; left out"
        yield Finding("W_NOT_ADVANCING", text, where)
    chatter = record.filled_swings + record.dropped_stances
    if chatter > max(2.0, 0.2 * len(foot.stances.touchdown)):
        text = (
            f"{name} chatters: {record.filled_swings} short swings filled, "
            f"{record.dropped_stances} short stances dropped"
        )
        yield Finding("W_CHATTER", text, f"{where}.chatter")


def _force_reasons(stats: Stats, foot: FootStatistics, where: str) -> Iterator[Finding]:
    if not foot.record.has_force:
        others = [each.record for each in stats.feet if each is not foot]
        stuck = is_stuck(foot.record, others)
        why = "is stuck" if stuck else "tells contact, not force"
        text = f"the sensor of {foot.name} {why}: it has no force figures"
        yield Finding("N_NO_FORCE", text, f"{where}.peak_force_n")
    elif not vertical_is_known(foot.record):
        text = (
            f"wrenches of {foot.name} are not in the world frame ({stats.settings.wrench_frame}): "
            "only the magnitude of its force is known, vertical and tangential parts are not"
        )
        yield Finding("N_VERTICAL_UNKNOWN", text, f"{where}.peak_vertical_force_n")


def _stance_reasons(stats: Stats, foot: FootStatistics, where: str) -> Iterator[Finding]:
    name = foot.name
    if foot.loading_rate_nps is None and foot.record.has_force:
        text = f"{name} is loaded within one sampling interval: its loading rate is not resolved"
        yield Finding("N_LOADING_RATE_UNRESOLVED", text, f"{where}.loading_rate_nps")
    if foot.contact_travel_m is None:
        lost = "no travel" if foot.slip_source else "no travel, no slip"
        text = f"no contact points of {name} around 10 % and 90 % of a stance: {lost}"
        yield Finding("N_NO_CONTACT_POINTS", text, f"{where}.contact_travel_m")
    elif stats.settings.foot_rolling_m is None and foot.slip_source is None:
        yield from _unknown_slip(foot, where)
    if not np.isfinite(foot.stances.figures.friction_use).any() and vertical_is_known(foot.record):
        text = f"no contact normals of {name}: its friction use is not known"
        yield Finding("N_NO_NORMALS", text, f"{where}.friction_use")


def _unknown_slip(foot: FootStatistics, where: str) -> Iterator[Finding]:
    """Yield what contact points tell of a foot whose rolling is not known."""
    reach = foot.stances.figures.contact_reach_m[foot.stances.whole]
    far = int((reach > LARGEST_FOOT_M).sum())
    if far:
        text = (
            f"the contact point of {foot.name} travels up to {np.nanmax(reach):.2f} m in "
            f"{counted(far, 'stance')}, further than a foot is long: it slips, or poses drift"
        )
        yield Finding("W_SLIPS", text, f"{where}.contact_travel_m")
    text = (
        f"how far the contact point of {foot.name} moves without slip is not known "
        "(foot_rolling_m in the robot's file): no slip"
    )
    yield Finding("N_SLIP_UNKNOWN", text, f"{where}.slip_m")
