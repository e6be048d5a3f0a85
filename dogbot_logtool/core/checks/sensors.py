"""Checks of the feet's sensors: what they read without load, and whether they work."""

from collections.abc import Iterator
from typing import Final

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import median_of
from dogbot_logtool.core.contact.contact_rule import HEAVILY_FILTERED
from dogbot_logtool.core.gait.feet import FootSteps
from dogbot_logtool.core.loads import is_stuck
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.finding import Finding, Words, found

PLAIN: Final = 0.02
"""Share of the weight from which an offset is worth a finding."""
WHOLE_WEIGHT: Final = 0.005
"""Share of the weight by which forces that nothing cuts off may miss it."""
FLAT: Final = 0.8
"""Mean over highest force of a nearly rectangular stance; that of half a sine is 0.64."""
SOME_S: Final = 0.1
"""s, time in contact without poses from which that is worth a warning."""


def unloaded_levels(walk: Walk) -> Iterator[Finding]:
    """Yield feet whose contact cannot be told, and offsets of sensors."""
    weight_n = walk.settings.body_weight_n or walk.settings.estimated_weight_n
    for foot in walk.settings.feet:
        level, why, name = foot.level, foot.rule.unusable, foot.name
        where = f"feet.{name}.force_offset_n"
        if why and why != HEAVILY_FILTERED:
            unknown = f"feet.{name}.contact_fraction"
            yield found("CONTACT_UNKNOWN", where=unknown, feet=(name,), why=why)
        if level.reason:
            yield found("SENSOR_OFFSET", say="unknown", where=where, foot=name, why=level.reason)
            continue
        if level.moved_n:
            yield found("SENSOR_OFFSET", where=where, say="moves", foot=name, newtons=level.moved_n)
        newtons = float(np.linalg.norm(level.offset_n))
        scale_n = weight_n or level.loaded_n
        if scale_n and newtons > PLAIN * scale_n:
            share, of = newtons / scale_n, "weight" if weight_n else "usual load"
            words: Words = {"newtons": newtons, "share": share, "scale": of, "origin": level.origin}
            yield found("SENSOR_OFFSET", where=where, foot=name, **words)


def filtered(walk: Walk) -> Iterator[Finding]:
    """Yield which forces went through a low-pass filter."""
    filters = [(foot.name, foot.low_pass) for foot in walk.settings.feet if foot.low_pass]
    for say, resolved in (("plain", True), ("heavy", False)):
        some = {name: each.tau_s for name, each in filters if each.resolved is resolved}
        if some:
            tau_s = max(some.values())
            cases = () if resolved else ("heavy",)
            yield found(
                "FORCE_FILTERED",
                *cases,
                where="feet",
                say=say,
                feet=tuple(some),
                names=", ".join(some),
                milliseconds=1e3 * tau_s,
                hertz=1.0 / (2.0 * np.pi * tau_s),
            )


def silent_feet(walk: Walk) -> Iterator[Finding]:
    """Yield feet of which no message tells, or none that can be used."""
    for row, foot in enumerate(walk.feet):
        record, on = foot.record, f" on {foot.topic}" if foot.topic else ""
        unusable = record.start is None and not walk.settings.feet[row].rule.unusable
        if not record.messages or unusable:
            say = "unusable" if record.messages else "plain"
            yield found("NO_MESSAGES", "foot", say=say, feet=(foot.name,), on=on)


def some_feet(walk: Walk) -> Iterator[Finding]:
    """Yield that the robot has other feet, of which the log does not tell."""
    if walk.settings.lacks_feet and any(foot.record.messages for foot in walk.feet):
        names = ", ".join(foot.name for foot in walk.feet)
        yield found("NO_MESSAGES", "others", where="gait", say="others", names=names)


def broken(walk: Walk) -> Iterator[Finding]:
    """Yield sensors that show one constant force under load, have stopped, or never feel ground."""
    for foot in _telling(walk):
        feet, spans = (foot.name,), foot.record.stopped
        if is_stuck(foot.record, [other.record for other in walk.feet if other is not foot]):
            cases = () if len(foot.stances.touchdown) > 1 else ("never_lifts",)
            yield found("STUCK", *cases, feet=feet)
        elif len(spans):
            # Less than a stride tells nothing of a foot.
            throughout = foot.is_dead or not len(foot.strides.stance)
            cases = ("throughout",) if throughout else ()
            start, end = walk.seconds(spans.ravel()[[0, -1]])
            seconds = timespans.total(spans) / 1e9
            yield found("STOPPED", *cases, feet=feet, start=start, end=end, seconds=seconds)
        elif foot.is_dead:
            yield found("DEAD", feet=feet)


def odd_forces(walk: Walk) -> Iterator[Finding]:
    """Yield sensors that are cut off at a limit, have lone spikes, flicker, or are too slow."""
    for row, foot in enumerate(walk.feet):
        if not len(foot.stances.touchdown):
            continue
        name, record, whole = foot.name, foot.record, foot.stances.whole
        if foot_is_saturated(walk, row):
            limit_n = walk.settings.feet[row].level.limit_n
            yield found("SATURATED", feet=(name,), limit_n=limit_n)
        if foot.spikes:
            where = f"feet.{name}.peak_force_n"
            yield found("SPIKES", where=where, foot=name, spikes=foot.spikes)
        if record.filled_swings + record.dropped_stances > max(2.0, 0.2 * len(whole)):
            yield found("CHATTER", where=f"feet.{name}.chatter", foot=name, record=record)
        rates = foot.stances.figures.loading_rate_nps[whole]
        if whole.any() and record.has_force and not np.isfinite(rates).any():
            where = f"feet.{name}.loading_rate_nps"
            yield found("SAMPLED_SLOWLY", "loading", where=where, feet=(name,))


def foot_is_saturated(walk: Walk, row: int) -> bool:
    """Tell whether an axis of a foot's sensor is cut off at a limit.

    Flat forces that carry the whole weight, as some simulators make them, are not.
    """
    figures = walk.feet[row].record.stances.figures
    share = (figures.mean_force_n / figures.peak_force_n)[figures.peak_force_n > 0.0]
    is_flat = len(share) > 0 and float(median_of(share)) >= FLAT
    ratio = walk.loads.vertical_impulse_over_weight
    carries_all = is_flat and ratio is not None and abs(ratio - 1.0) <= WHOLE_WEIGHT
    return walk.settings.feet[row].level.limit_n is not None and not carries_all


def samples_left_out(walk: Walk) -> Iterator[Finding]:
    """Yield how many messages of feet are left out, and contact that no pose is near to."""
    for row, foot in enumerate(walk.feet):
        record, name = foot.record, foot.name
        if not len(foot.stances.touchdown):
            continue
        if count := record.not_finite:
            what = "with a force that is not finite"
            if walk.settings.feet[row].level.drops_out:
                what = "without a force (lone zeros under load)"
            yield found("NOT_FINITE", say="feet", foot=name, messages=count, what=what)
        if count := record.not_advancing:
            yield found("BAD_STAMPS", say="left_out", foot=name, messages=count)
        seconds = walk.poses.unplaced(record.in_contact) / 1e9
        if len(walk.base_history.time) and seconds > SOME_S and not walk.base_by_feet:
            yield found("GAPS", say="no_pose", foot=name, seconds=seconds)


def _telling(walk: Walk) -> Iterator[FootSteps]:
    """Yield the feet with usable messages from which contact can be told."""
    for row, foot in enumerate(walk.feet):
        if foot.record.start is not None and not walk.settings.feet[row].rule.unusable:
            yield foot
