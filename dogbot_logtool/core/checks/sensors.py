"""Checks of the feet's sensors: what they read without load, and whether they work."""

from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import median_of
from dogbot_logtool.core.checks.wording import counted
from dogbot_logtool.core.contact.contact_rule import FootSensor
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.corrections.sensor import SensorLevel
from dogbot_logtool.core.gait.feet import FootSteps
from dogbot_logtool.core.loads import is_stuck
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.finding import Finding

PLAIN: Final = 0.02
"""Share of the weight from which an offset is worth a finding."""
WHOLE_WEIGHT: Final = 0.005
"""Share of the weight by which forces that nothing cuts off may miss it."""
FLAT: Final = 0.8
"""Mean over highest force of a nearly rectangular stance; that of half a sine is 0.64."""
SOME_S: Final = 0.1
"""s, time in contact without poses from which that is worth a warning."""


def unloaded_levels(stats: Stats) -> Iterator[Finding]:
    """Yield feet whose contact cannot be told, and offsets of sensors."""
    settings = stats.settings
    names = [foot.name for foot in settings.feet]
    sensors = [settings.sensor(row) for row in range(len(names))]
    weight_n = settings.body_weight_n or settings.estimated_weight_n
    return sensor_findings(names, sensors, weight_n)


def sensor_findings(
    names: Sequence[str], sensors: Sequence[FootSensor], weight_n: float | None
) -> Iterator[Finding]:
    """Yield what a user should know of the feet's sensors.

    Args:
        names: of the feet.
        sensors: of the feet.
        weight_n: N, given or estimated; None: not known.
    """
    for name, sensor in zip(names, sensors, strict=True):
        if reason := sensor.rule.unusable:
            text = f"contact of {name} is not known: {reason}"
            yield Finding("CONTACT_UNKNOWN", text, f"feet.{name}.contact_fraction", feet=(name,))
        yield from _offset(name, sensor.level, weight_n, f"feet.{name}.force_offset_n")


def _offset(name: str, level: SensorLevel, weight_n: float | None, where: str) -> Iterator[Finding]:
    if level.reason:
        text = f"what the sensor of {name} reads without load is not known, zero is assumed: "
        yield Finding("OFFSET_UNKNOWN", text + level.reason, where)
        return
    offset = float(np.linalg.norm(level.offset_n))
    scale = weight_n or level.loaded_n
    if level.moved_n:
        text = (
            f"what the sensor of {name} reads without load moves by {level.moved_n:.3g} N in the "
            "log: it was re-zeroed, or it drifts; that is taken off swing by swing"
        )
        yield Finding("SENSOR_OFFSET", text, where)
    if scale and offset > PLAIN * scale:
        of_what = "weight" if weight_n else "usual load"
        text = (
            f"the sensor of {name} reads {offset:.3g} N without load, {offset / scale:.0%} of the "
            f"{of_what} ({level.origin}); it is taken off all forces (--set tare changes that)"
        )
        yield Finding("SENSOR_OFFSET", text, where)


def silent_feet(stats: Stats) -> Iterator[Finding]:
    """Yield feet of which no message tells, or none that can be used."""
    for row, foot in enumerate(stats.feet):
        topic = f" on {foot.topic}" if foot.topic else ""
        text = f"no message of {foot.name} can be used"
        if foot.record.messages == 0:
            text = f"no message{topic} tells of {foot.name}"
        elif foot.record.start is not None or stats.settings.sensor(row).rule.unusable:
            continue
        where = f"feet.{foot.name}"
        yield Finding("NO_MESSAGES", text, where, cases=("foot",), feet=(foot.name,))


def dead(stats: Stats) -> Iterator[Finding]:
    """Yield feet that never touch, where nothing says that they are lifted."""
    for foot in _telling(stats):
        if foot.is_dead and not (_is_stuck(stats, foot) or len(foot.record.stopped)):
            text = f"{foot.name} never touches the ground: its sensor seems dead, or it is lifted"
            yield Finding("DEAD", text, f"feet.{foot.name}", feet=(foot.name,))


def stuck(stats: Stats) -> Iterator[Finding]:
    """Yield sensors that show one constant force under load while others vary."""
    for foot in _telling(stats):
        if _is_stuck(stats, foot):
            text = f"the sensor of {foot.name} shows one constant force while it is loaded: stuck"
            cases = () if len(foot.stances.touchdown) > 1 else ("never_lifts",)
            where = f"feet.{foot.name}"
            yield Finding("STUCK", text, where, cases=cases, feet=(foot.name,))


def stopped(stats: Stats) -> Iterator[Finding]:
    """Yield sensors that tell nothing for a time in which other feet step."""
    for foot in _telling(stats):
        spans = foot.record.stopped
        if not len(spans) or _is_stuck(stats, foot):
            continue
        start, end = stats.seconds(spans.ravel()[[0, -1]])
        lasts = timespans.total(spans) / 1e9
        text = (
            f"no step of {foot.name} is seen from {start:.2f} s to {end:.2f} s ({lasts:.1f} s in "
            "all) while other feet go on: its load is missing, stays the same, or stays while the "
            "base goes away; its sensor has stopped, or what it reads without load is not what it "
            "seems; contact and load are not known then"
        )
        cases = ("throughout",) if foot.is_dead else ()
        where = f"feet.{foot.name}"
        yield Finding("STOPPED", text, where, cases=cases, feet=(foot.name,))


def saturated(stats: Stats) -> Iterator[Finding]:
    """Yield sensors that are cut off at a limit."""
    for row, foot in enumerate(stats.feet):
        if foot_is_saturated(stats, row) and len(foot.stances.touchdown):
            limit_n = stats.settings.sensor(row).level.limit_n
            at = "" if limit_n is None else f" at {limit_n:.4g} N"
            text = f"forces of {foot.name} are cut off{at}: its sensor seems saturated"
            yield Finding("SATURATED", text, f"feet.{foot.name}", feet=(foot.name,))


def foot_is_saturated(stats: Stats, row: int) -> bool:
    """Tell whether an axis of a foot's sensor is cut off at a limit.

    Flat forces that carry the whole weight, as some simulators make them, are not.
    """
    level, record = stats.settings.sensor(row).level, stats.feet[row].record
    ratio = stats.loads.vertical_impulse_over_weight
    if ratio is not None and abs(ratio - 1.0) <= WHOLE_WEIGHT and _is_flat(record):
        return False
    return level.limit_n is not None


def _is_flat(foot: FootHistory) -> bool:
    """Tell whether a foot's force is near its highest for most of a stance."""
    figures = foot.stances.figures
    share = (figures.mean_n / figures.peak_n)[figures.peak_n > 0.0]
    return len(share) > 0 and float(median_of(share)) >= FLAT


def spikes(stats: Stats) -> Iterator[Finding]:
    """Yield sensors with lone spikes."""
    for foot in _touching(stats):
        if foot.spikes:
            count = counted(foot.spikes, "lone spike")
            text = f"{count} in the force of {foot.name}, far above all else in a stance: not in "
            yield Finding("SPIKES", f"{text}its peaks", f"feet.{foot.name}.peak_force_n")


def samples_left_out(stats: Stats) -> Iterator[Finding]:
    """Yield how many messages of feet are left out, and contact that no pose is near to."""
    for row, foot in enumerate(stats.feet):
        if not len(foot.stances.touchdown):
            continue
        record, where = foot.record, f"feet.{foot.name}"
        if record.not_finite:
            messages = counted(record.not_finite, "message")
            text = f"{messages} of {foot.name} with a force that is not finite; left out"
            if stats.settings.sensor(row).level.drops_out:
                text = f"{messages} of {foot.name} without a force (lone zeros under load)"
                text += "; left out"
            yield Finding("NOT_FINITE", text, where)
        if record.not_advancing:
            messages = counted(record.not_advancing, "message")
            text = f"{messages} of {foot.name} with a time that repeats or steps back; left out"
            yield Finding("BAD_STAMPS", text, where)
        without_pose = stats.contact_without_pose_s[row]
        if len(stats.base_history.time) and without_pose > SOME_S:
            text = f"{foot.name} is in contact for {without_pose:.1f} s further than 0.1 s from "
            yield Finding("GAPS", f"{text}odometry", where)


def chatter(stats: Stats) -> Iterator[Finding]:
    """Yield feet whose contact flickers."""
    for foot in _touching(stats):
        filled, dropped = foot.record.filled_swings, foot.record.dropped_stances
        if filled + dropped > max(2.0, 0.2 * len(foot.stances.touchdown)):
            text = (
                f"{foot.name} chatters: {filled} short swings filled, {dropped} short stances "
                "dropped"
            )
            yield Finding("CHATTER", text, f"feet.{foot.name}.chatter")


def sampled_slowly(stats: Stats) -> Iterator[Finding]:
    """Yield feet that are loaded within one sampling interval."""
    for foot in _touching(stats):
        whole = foot.stances.whole
        rates = foot.stances.figures.loading_rate_nps[whole]
        if whole.any() and foot.record.has_force and not np.isfinite(rates).any():
            text = f"{foot.name} is loaded within one sampling interval: its loading rate is not "
            where = f"feet.{foot.name}.loading_rate_nps"
            cases = ("loading",)
            yield Finding(
                "SAMPLED_SLOWLY", f"{text}resolved", where, cases=cases, feet=(foot.name,)
            )


def _telling(stats: Stats) -> Iterator[FootSteps]:
    """Yield the feet with usable messages from which contact can be told."""
    for row, foot in enumerate(stats.feet):
        if foot.record.start is not None and not stats.settings.sensor(row).rule.unusable:
            yield foot


def _touching(stats: Stats) -> Iterator[FootSteps]:
    """Yield those that touch the ground."""
    return (foot for foot in _telling(stats) if len(foot.stances.touchdown))


def _is_stuck(stats: Stats, foot: FootSteps) -> bool:
    return is_stuck(foot.record, [other.record for other in stats.feet if other is not foot])
