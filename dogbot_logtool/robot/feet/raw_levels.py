"""Contact by raw counts of foot sensors, learnt from the log itself.

In a walk each sensor's counts have two clear modes, in the air and on the ground. From which count
on a foot touches then lies between them, although nothing says what a count is in newtons.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import concatenated, percentiles_of
from dogbot_logtool.core.contact.contact_rule import MOST_OF_LOAD, contact_rule
from dogbot_logtool.core.contact.contacts import Samples, no_samples
from dogbot_logtool.core.corrections.sensor import SensorLevel, estimate_level
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.reader.containers.log import Channel, Log
from dogbot_logtool.reader.messages.contact_messages import read_messages, source_of
from dogbot_logtool.reader.messages.feet import FootChannels
from dogbot_logtool.robot.feet.message_feet import sampled_messages
from dogbot_logtool.robot.robot import Robot

_LOOKS: Final = 24
"""Chunks of a topic that are read."""
_BLUR: Final = 0.02
"""Share of a sensor's range by which its counts are blurred; a walk's loads vary by far more."""
_UNLOADED: Final = 0.25
"""Share of the counts under load up to which the lower of two levels is that of a foot in the air;
weight that is shifted in a stand leaves more on each foot."""
_WALKING: Final = (0.1, 0.95)
"""Share of the time in which a walking robot's foot is on the ground."""


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
    samples = _counts(log, raw, feet_of, robot)
    feet, thresholds = [], []
    for index, foot in enumerate(robot.feet):
        mine = samples.pick(samples.foot == index)
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
    return RawLevels(
        replace(robot, feet=tuple(feet), contact_on_counts=max(thresholds)), estimated=True
    )


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


def _counts(
    log: Log, raw: Sequence[Channel], feet_of: Mapping[int, tuple[int, ...]], robot: Robot
) -> Samples:
    """Return samples whose vertical force is the count itself."""
    unscaled = [replace(foot, offset=0.0, newtons_per_count=1.0) for foot in robot.feet]
    feet = FootChannels(unscaled, feet_of)
    found = [no_samples()]
    for channel in raw:
        source = source_of(channel)
        if source is not None:
            messages = sampled_messages(log, channel, source, _LOOKS)
            found.extend(read_messages(source, each, feet).samples for each in messages)
    samples = concatenated(found)
    return samples.pick(np.argsort(samples.log_time, kind="stable"))
