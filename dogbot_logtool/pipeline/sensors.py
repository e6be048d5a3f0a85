"""How each foot's sensor reads, learnt from the log before it is read through.

A sensor that reads zero in swing shows that in the few chunks of the probe. Of any other, longer
stretches are read: all of a short log, a sixteenth of a long one, spread over it.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from dogbot_logtool.core.contact.contact_rule import (
    ContactRule,
    FootSensor,
    Thresholds,
    contact_rule,
)
from dogbot_logtool.core.contact.contacts import Samples, no_samples
from dogbot_logtool.core.contact.silent_swing import SilentFeet, learn_silences
from dogbot_logtool.core.geometry.arrays import all_finite, norms
from dogbot_logtool.core.geometry.blocks import concatenated
from dogbot_logtool.core.geometry.clock import usual_interval_s
from dogbot_logtool.core.geometry.order_statistics import median_of
from dogbot_logtool.core.load.loads import body_weight_n
from dogbot_logtool.core.sensors.sensor_level import (
    Origin,
    SensorLevel,
    estimate_level,
    no_offset,
    zero_level,
    zero_reading,
)
from dogbot_logtool.core.sensors.sensor_modes import CONSTANT
from dogbot_logtool.core.sensors.weighed_levels import (
    checked_levels,
    turned_levels,
    weighed_levels,
    weight_of_levels,
)
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.errors import CallError
from dogbot_logtool.io.printable import listed
from dogbot_logtool.pipeline.options import TopicOptions
from dogbot_logtool.pipeline.probe import Probe
from dogbot_logtool.pipeline.topics.selection import Selection
from dogbot_logtool.reader.containers.log import Channel, Chunk, Log
from dogbot_logtool.reader.messages.contacts.registry import read_contacts

_WHOLE_BYTES: Final = 4 << 20
"""Contact channels of smaller logs are read through."""
_MORE_BYTES: Final = 32 << 20
"""So are those of larger ones where a sensor's level does not show."""
_SHARE: Final = 16
"""One byte in so many of larger ones is read."""
_STRETCH_S: Final = 15.0
"""s: long enough for several strides."""
_MOST_STRETCHES: Final = 24


@dataclass(frozen=True, slots=True)
class LearntSensors:
    """How all feet's sensors read."""

    feet: tuple[FootSensor, ...]
    """In the order of the robot's feet."""
    silent: SilentFeet
    """Those that send no messages in swing."""
    estimated_weight_n: float | None
    """N, the feet's mean sum of loads, where no mass is given and thresholds rest on it."""


def learn_sensors(
    log: Log,
    selection: Selection,
    probe: Probe,
    topics: TopicOptions,
    given: Thresholds | None = None,
) -> LearntSensors:
    """Learn how each foot's sensor reads with and without load, and what counts as contact.

    Args:
        log: the log.
        selection: its feet.
        probe: what a quick look into it showed.
        topics: what the user says about offsets and mass.
        given: thresholds that are not to be chosen here; what is None in it is the robot's.

    Raises:
        CallError: the user names a foot that the log does not have.
    """
    names = [foot.name for foot in selection.robot.feet]
    for name in topics.offsets_n or {}:
        if name not in names:
            raise CallError(f"--tare {name}: the log has no such foot; it has {listed(names)}")
    feet = range(len(names))
    weight = body_weight_n(selection.robot.mass_kg)
    thresholds = _thresholds(selection, given or Thresholds())
    found = {
        foot: None if _saw_light_load_only(level, weight, thresholds) else level
        for foot in feet
        for level in [_zero_in_probe(selection, probe, topics, foot)]
    }
    noisy = [foot for foot in feet if found[foot] is None]
    closer = sorted({*noisy, *probe.intervals})

    def levels_in(samples: Samples) -> tuple[SensorLevel, ...]:
        return tuple(found[foot] or _level(selection, samples, foot, topics) for foot in feet)

    chunks = _spread(log, selection, closer, _WHOLE_BYTES)
    samples = _read(log, selection, closer, chunks)
    levels = levels_in(samples)
    if any(levels[foot].reason for foot in noisy):
        # A robot that stands for most of a log may have walked where nothing was read.
        more = _spread(log, selection, closer, _MORE_BYTES)
        if len(more) > len(chunks):
            samples = _read(log, selection, closer, more)
            levels = levels_in(samples)
    if not selection.robot_is_guessed or topics.mass_kg is not None:
        levels = checked_levels(weighed_levels(turned_levels(levels, weight), weight), weight)
    else:
        levels = turned_levels(levels, None)
    varies = any(level.loaded_n and level.reason != CONSTANT for level in levels)
    estimated = weight_of_levels(levels) if weight is None else None
    return LearntSensors(
        tuple(
            FootSensor(
                level,
                _rule(
                    level,
                    weight or estimated,
                    thresholds,
                    others_vary=varies,
                    by_flag=selection.has_flags(foot),
                ),
            )
            for foot, level in enumerate(levels)
        ),
        learn_silences(samples, probe.intervals, probe.silence_clock),
        estimated,
    )


def _rule(
    level: SensorLevel,
    weight_n: float | None,
    given: Thresholds,
    *,
    others_vary: bool,
    by_flag: bool,
) -> ContactRule:
    """Return what counts as contact; a sensor that is stuck while others vary tells none."""
    rule = contact_rule(level, weight_n, given)
    if by_flag:
        return replace(rule, by_flag=True, backdates=False, unusable="")
    if level.reason == CONSTANT and level.loaded_n and others_vary:
        return replace(rule, unusable="its sensor reads one constant force while others vary")
    return rule


def _zero_in_probe(
    selection: Selection, probe: Probe, topics: TopicOptions, foot: int
) -> SensorLevel | None:
    """Return the level of a foot whose sensor reads zero in swing; None: look closer."""
    known = selection.robot.feet[foot]
    if known.offset_n is not None or known.name in (topics.offsets_n or {}):
        return None
    sources = selection.sources_of(foot)
    samples = probe.contacts.pick(probe.contacts.foot == foot)
    force = samples.force[all_finite(samples.force)]
    interval_s = usual_interval_s(samples.log_time)
    if any(source.silent_in_swing for source in sources):
        # Its samples are those in contact only, and their mean is no mean over strides.
        level = zero_level(np.concatenate([np.zeros((len(force) + 3, 3)), force]), interval_s)
        return replace(level or zero_reading(), mean_n=None)
    if not selection.knows_force(foot):
        return replace(zero_reading(), interval_s=interval_s)
    if not len(force):
        return None
    level = zero_level(force, interval_s)
    if level is None and all(source.lists_contacts for source in sources):
        # A foot that is down throughout: its messages would say if it were not.
        mean = float(median_of(norms(force)))
        return replace(zero_reading(), loaded_n=mean, mean_n=mean, interval_s=interval_s)
    return level


def _saw_light_load_only(
    level: SensorLevel | None, weight_n: float | None, given: Thresholds
) -> bool:
    """Tell whether the probe's chunks may have shown a foot at its touchdowns alone.

    They are evenly spaced, and so may be as far apart as strides are.
    """
    if level is None or level.origin != "estimated":
        return False
    # Without a mean, the sensor is silent in swing: a closer look shows no swing either.
    return level.mean_n is not None and bool(contact_rule(level, weight_n, given).unusable)


def _level(selection: Selection, samples: Samples, foot: int, topics: TopicOptions) -> SensorLevel:
    """Estimate a foot's level, or take the one that is given."""
    rows = samples.pick(samples.foot == foot)
    known = (topics.offsets_n or {}).get(selection.robot.feet[foot].name)
    origin: Origin = "option"
    if known is None and topics.takes_offsets:
        known, origin = selection.robot.feet[foot].offset_n, "robot"
    if known is None and topics.takes_offsets:
        level = estimate_level(rows.log_time, rows.force)
        if level.zero_in_swing or level.reason:
            return level
        from dogbot_logtool.core.sensors.swing_levels import follow_level  # noqa: PLC0415

        return follow_level(rows.log_time, rows.force, level)
    offset = np.array([known or (0.0, 0.0, 0.0)])
    rest = estimate_level(rows.log_time, rows.force - offset)
    return replace(rest, knots=no_offset()[0], offset=offset, origin=origin, reason="")


def _thresholds(selection: Selection, given: Thresholds) -> Thresholds:
    """Complete thresholds from the robot's file."""
    robot = selection.robot
    return replace(
        given,
        on_n=given.on_n or robot.contact_on_n,
        off_n=given.off_n or robot.contact_off_n,
        debounce_s=robot.debounce_s if given.debounce_s is None else given.debounce_s,
        origin="option" if given.on_n else "robot",
    )


def _channels_of(selection: Selection, feet: Sequence[int]) -> list[Channel]:
    """Return the channels of some feet."""
    return [
        channel
        for channel in selection.contacts
        if not set(selection.feet_of[channel.id]).isdisjoint(feet)
    ]


def _read(log: Log, selection: Selection, feet: Sequence[int], chunks: Sequence[Chunk]) -> Samples:
    """Read the contact samples of some feet from some chunks."""
    channels = _channels_of(selection, feet)
    found = [no_samples()]
    for span in log.grouped(chunks):
        batch = log.read(span)
        decoded = read_contacts(batch, channels, selection.foot_channels())
        found.extend(read.reduced.samples for read in decoded)
    samples = concatenated(found)
    return samples.pick(np.argsort(samples.log_time, kind="stable"))


def _spread(
    log: Log, selection: Selection, feet: Sequence[int], least_bytes: int
) -> Sequence[Chunk]:
    """Choose chunks with messages of some feet: all of a short log, stretches of a long one."""
    channels = {channel.id for channel in _channels_of(selection, feet)}
    if not channels:
        return ()
    useful = [c for c in log.chunks if c.counts is None or not channels.isdisjoint(c.counts)]
    behind = np.cumsum([0, *(chunk.data_size for chunk in useful)])
    budget = max(least_bytes, int(behind[-1]) // _SHARE)
    if behind[-1] <= budget:
        return useful
    duration_s = 0.0
    if log.start_time is not None and log.end_time is not None:
        duration_s = (log.end_time - log.start_time) / 1e9
    read_s = duration_s * budget / int(behind[-1])
    number = int(np.clip(read_s / _STRETCH_S, 2, _MOST_STRETCHES))
    length = budget // number
    starts = np.linspace(0, int(behind[-1]) - length, number)
    chosen = [
        any(start < end and begin < start + length for start in starts.tolist())
        for begin, end in zip(behind[:-1].tolist(), behind[1:].tolist(), strict=True)
    ]
    return [chunk for chunk, taken in zip(useful, chosen, strict=True) if taken]
