"""Whether flags and raw counts of feet tell contact, by some messages of each topic.

Flags are compared with the forces beside them. Raw counts have two clear modes in a walk, in the
air and on the ground: from which count on a foot touches then lies between them, although nothing
says what a count is in newtons.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Floats, Ints, distinct, norms, percentiles_of
from dogbot_logtool.core.contact.contact_rule import MOST_OF_LOAD, contact_rule
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.corrections.sensor import SensorLevel, estimate_level
from dogbot_logtool.finding import Finding
from dogbot_logtool.io.printable import listed
from dogbot_logtool.reader.containers.log import Channel, Log
from dogbot_logtool.reader.messages.contact_messages import source_of
from dogbot_logtool.reader.messages.feet import FootChannels
from dogbot_logtool.reader.recording import read_recording
from dogbot_logtool.reader.wanted import Wanted
from dogbot_logtool.robot.message_feet import is_planned
from dogbot_logtool.robot.robot import Robot

_LOOKS_AT_COUNTS: Final = 24
"""Chunks of which counts are read; also `_LOOKS_AT_FLAGS`."""
_LOOKS_AT_FLAGS: Final = 4
_LOAD_SHARE: Final = 0.2
"""Share of all feet's load from which a foot cannot be in the air."""
_CONTRADICTED: Final = 0.2
"""Share of contradicted flags from which constant flags are taken for not filled in."""
_DOUBTFUL: Final = 0.05
"""Share of contradicted flags from which it is said."""
_BLUR: Final = 0.02
"""Share of a sensor's range by which its counts are blurred; a walk's loads vary by far more."""
_UNLOADED: Final = 0.25
"""Share of the counts under load up to which the lower of two levels is that of a foot in the air;
weight that is shifted in a stand leaves more on each foot."""
_WALKING: Final = (0.1, 0.95)
"""Share of the time in which a walking robot's foot is on the ground."""


def _sampled(
    log: Log, contacts: Sequence[Channel], feet: FootChannels, looks: int
) -> tuple[Samples, ...]:
    """Read the samples of each foot in some chunks, spread over the log."""
    ids = {channel.id for channel in contacts}
    useful = [c for c in log.chunks if c.counts is None or not ids.isdisjoint(c.counts)]
    rows = distinct(np.linspace(0, len(useful) - 1, looks).round().astype(int))
    spans = log.grouped([useful[row] for row in rows.tolist()] if useful else [])
    return read_recording(log, Wanted(tuple(contacts), feet), 1, spans=spans).recording.feet


@dataclass(frozen=True, slots=True)
class FlagUse:
    """Whether the contact flags of a log are used."""

    are_useless: bool = False
    """Whether they never change although forces do: they are not filled in."""
    findings: tuple[Finding, ...] = ()


def compare_flags(
    log: Log, contacts: Sequence[Channel], feet_of: Mapping[int, tuple[int, ...]], robot: Robot
) -> FlagUse:
    """Compare contact flags with the forces beside them."""
    flagged = []
    for channel in contacts:
        source = source_of(channel, robot.feet_of(channel.topic))
        if source is not None and source.has_flags and source.has_force:
            flagged.append(channel)
    if not flagged:
        return FlagUse()
    feet = FootChannels(robot.feet, feet_of)
    by_flag = _sampled(log, flagged, feet, _LOOKS_AT_FLAGS)
    by_force = _sampled(log, flagged, replace(feet, ignores_flags=True), _LOOKS_AT_FLAGS)
    times = np.unique(np.concatenate([each.log_time for each in (*by_flag, *by_force)]))
    flag = _table(times, [(each, each.in_contact.astype(float)) for each in by_flag])
    load = _table(times, [(each, norms(each.force)) for each in by_force])
    known = np.isfinite(flag) & np.isfinite(load)
    total = np.where(known, load, 0.0).sum(axis=1, keepdims=True)
    touching = flag > 0.0
    wrong = np.where(touching, load == 0.0, load > _LOAD_SHARE * total)
    # Without any load, as before a simulation begins, forces tell nothing.
    wrong &= known & (total > 0.0)
    contradicted = float(wrong.sum() / max(known.sum(), 1))
    constant = int((touching & known).sum()) in {0, int(known.sum())}
    share = f"{contradicted:.0%} of the contact flags of {listed([c.topic for c in flagged])}"
    if constant and contradicted > _CONTRADICTED:
        text = f"{share} contradict the forces, and no flag ever changes: forces decide contact"
        return FlagUse(are_useless=True, findings=(Finding("FLAGS_CONTRADICTED", text),))
    if contradicted > _DOUBTFUL:
        text = f"{share} contradict the forces; flags decide contact"
        return FlagUse(findings=(Finding("FLAGS_CONTRADICTED", text),))
    return FlagUse()


def _table(times: Ints, columns: Sequence[tuple[Samples, Floats]]) -> Floats:
    """Return (n, feet) values at n times; NaN where a foot has none."""
    found = np.full((len(times), len(columns)), np.nan)
    for foot, (samples, values) in enumerate(columns):
        found[np.searchsorted(times, samples.log_time), foot] = values
    return found


@dataclass(frozen=True, slots=True)
class RawLevels:
    """A robot whose raw sensors tell contact, or why they do not."""

    robot: Robot
    estimated: bool = False
    """Whether offsets and the contact threshold are estimated from the log."""
    reason: str = ""
    """Why they could not be; empty: they could, or need not."""


def with_raw_levels(
    log: Log, contacts: Sequence[Channel], feet_of: Mapping[int, tuple[int, ...]], robot: Robot
) -> RawLevels:
    """Estimate offsets and contact threshold of raw sensors that nothing else tells.

    All feet must have two clear modes: a threshold that fits some says nothing of the others.
    """
    raw = [
        channel
        for channel in contacts
        if (source := source_of(channel, robot.feet_of(channel.topic))) and source.is_raw
    ]
    scaled = any(foot.newtons_per_count is not None for foot in robot.feet)
    if not raw or scaled or robot.contact_on_counts is not None:
        return RawLevels(robot)
    # So their vertical force is the count itself.
    counting = [replace(foot, offset=0.0, newtons_per_count=1.0) for foot in robot.feet]
    samples = _sampled(log, raw, FootChannels(counting, feet_of), _LOOKS_AT_COUNTS)
    feet, thresholds = [], []
    for foot, mine in zip(robot.feet, samples, strict=True):
        level = _level(mine)
        rule = contact_rule(level, None)
        offset, loaded = float(level.offset_n[2]), level.loaded_n
        if level.reason or loaded is None or rule.on_n > MOST_OF_LOAD * loaded:
            why = level.reason or "its counts hardly change"
            return RawLevels(robot, reason=f"{foot.name}: {why}")
        down = float((mine.force[:, 2] - offset >= rule.on_n).mean())
        if not _WALKING[0] <= down <= _WALKING[1]:
            return RawLevels(robot, reason=f"{foot.name}: on the ground {down:.0%} of the time")
        feet.append(replace(foot, offset=offset))
        thresholds.append(rule.on_n)
    robot = replace(robot, feet=tuple(feet), contact_on_counts=max(thresholds))
    return RawLevels(robot, estimated=True)


def _level(samples: Samples) -> SensorLevel:
    """Return the level of a sensor that load raises, from its counts."""
    if not len(samples.force):
        return estimate_level(samples.log_time, samples.force)
    # A mode that is a count or two narrower than the other must not pass for the unloaded one.
    low, high = percentiles_of(samples.force[:, 2], [5.0, 95.0])
    blur = np.random.default_rng(0).normal(0.0, _BLUR * (high - low), len(samples.force))
    level = estimate_level(samples.log_time, samples.force + blur[:, None] * [0.0, 0.0, 1.0])
    light = level.alternative
    if light is None or light.loaded_n is None:
        return level
    offset = float(light.offset_n[2])
    return light if 0.0 <= offset <= _UNLOADED * (offset + light.loaded_n) else level


def source_findings(contacts: Sequence[Channel], levels: RawLevels) -> Iterator[Finding]:
    """Say what contact messages do not tell."""
    for channel in sorted(contacts, key=lambda channel: channel.type_name):
        name, source = channel.type_name, source_of(channel, levels.robot.feet_of(channel.topic))
        if source is None:
            continue
        if not source.has_force:
            text = f"{name} tells contact, not force: gait figures only, no arrows, no loads"
            yield Finding("NO_FORCE", text)
        if source.is_raw:
            yield from _not_calibrated(name, levels)
        if not source.has_header:
            text = f"{name} has no header: log time is used for it"
            yield Finding("LOG_TIME_USED", text, cases=("no_header",))
        if source.silent_in_swing:
            text = f"{name} is published only in contact: silence is taken for swing"
            yield Finding("SILENT_SWING", text)
    for channel in filter(is_planned, contacts):
        text = "is a plan, not a measurement: contacts, forces and figures are the planned ones"
        yield Finding("PLANNED", f"{channel.topic} {text}", channel.topic)


def _not_calibrated(name: str, levels: RawLevels) -> Iterator[Finding]:
    """Warn of figures that are missing while the counts of raw sensors have no scale."""
    robot = levels.robot
    unscaled = [foot.name for foot in robot.feet if foot.newtons_per_count is None]
    if not unscaled:
        return
    text = f"{name} has raw counts, and the robot's file has no newtons_per_count for "
    text += f"{', '.join(unscaled)}: no forces"
    if robot.contact_on_counts is None:
        text += ", and without contact.on_counts no contact either"
        text += f" (it cannot be estimated from the log; {levels.reason})" if levels.reason else ""
    else:
        text += f"; contact from {robot.contact_on_counts:g} counts above a foot's offset on"
        text += " (both estimated from the log)" if levels.estimated else ""
    yield Finding("NOT_CALIBRATED", text, feet=tuple(unscaled))
