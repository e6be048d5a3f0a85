"""Correct the columns of a recording: one clock, sensors' offsets, silences, frames of forces."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.core.base.foot_path import FootPath, path_in_base, path_of
from dogbot_logtool.core.base.motion import leaning_walk_rad
from dogbot_logtool.core.base.poses import BaseHistory, Odometry, base_history
from dogbot_logtool.core.contact.contacts import Samples, with_swings
from dogbot_logtool.core.contact.filtered import find_filters, without_filter
from dogbot_logtool.core.contact.foot_history import FootHistory, foot_history
from dogbot_logtool.core.corrections.clock import (
    ClockDifference,
    OffsetTrack,
    StampCheck,
    TimeSource,
    check_stamps,
    clock_breaks,
    clock_differences,
    offset_track,
    why_clocks_cannot_be_joined,
    why_unusable,
    without_bad_stamps,
)
from dogbot_logtool.core.frames.wrench_frame import WrenchFrame
from dogbot_logtool.core.known_frames import (
    Counts,
    KnownFrames,
    WorldFrames,
    imu_mounting,
    known_frames,
)
from dogbot_logtool.core.quality import TopicQuality, TopicTimes, topic_quality, topic_times
from dogbot_logtool.core.recording import JointTable, Recording, VectorTopic
from dogbot_logtool.core.sensors import with_sensors, without_offset
from dogbot_logtool.core.settings import WalkSettings

if TYPE_CHECKING:
    from dogbot_logtool.core.vectors import VectorHistory


class Corrected(NamedTuple):
    """The columns of a recording on one clock, with forces in the world above sensors' offsets."""

    recording: Recording
    """With the contact samples that are measured."""
    settings: WalkSettings
    """With the clock that is used, how sensors read, and the frame of the forces."""
    frames: KnownFrames
    turned: tuple[WorldFrames, Counts] | None
    """How forces and positions were turned into the world; None: none was to be."""
    feet: tuple[FootHistory, ...]
    places: tuple[FootPath | None, ...]
    """Of each foot in the base's axes, where its messages tell that."""
    base: BaseHistory
    """As recorded, jumps and all; without poses if these lean."""
    leaning_rad: float | None
    """rad, how far the base seems to lean while the robot walks: its poses are left out; None: it
    does not."""
    clocks: tuple[ClockDifference, ...]
    """How far topics' clocks are from that of the feet; nothing on log time. Also
    `joint_clocks`, with those of joint states."""
    joint_clocks: tuple[ClockDifference, ...]
    topics: tuple[TopicQuality, ...]
    commands: "VectorHistory | None"
    """Velocity commands; None: the log has none. Likewise `inertial`."""
    inertial: "VectorHistory | None"


def correct(recording: Recording, settings: WalkSettings) -> Corrected:
    """Choose the clock, leave out bad stamps, correct forces, and find the contacts of each foot.

    Args:
        recording: columns as recorded.
        settings: what is known before they are looked at.
    """
    times = {
        topic: topic_times(topic, each.log_time, each.stamp)
        for topic, each in recording.topics.items()
        if len(each.log_time)
    }
    named = [foot.topic for foot in settings.feet]
    stamped = {topic: each for topic, each in times.items() if each.has_stamps}
    measured = sorted({*named, settings.odometry_topic} & stamped.keys())
    offsets = {topic: offset_track(*stamped[topic].usable()) for topic in measured}
    clocks = clock_differences(offsets, named)
    base_check = _check(settings.odometry_topic or "the odometry", recording.base)
    checks = [*map(_check, named, recording.feet), base_check]
    # One clock serves all feet and the base, since phases and support compare them.
    if settings.time_source is None:
        why = why_unusable(checks) or why_clocks_cannot_be_joined(clocks)
        source = TimeSource.LOG if why else None
        settings = replace(settings, time_source=source, time_source_reason=why)
    on_stamps = settings.clock is TimeSource.HEADER
    breaks = timespans.no_spans() if on_stamps else clock_breaks(checks)
    recording, settings = _without_filters(recording, settings)
    settings = with_sensors(settings, recording.feet)
    frames = known_frames(recording, settings)
    settings = _in_frames(recording, settings, frames)
    samples, places, turned = _corrected_samples(recording, settings, frames)
    feet = tuple(
        foot_history(
            without_bad_stamps(own, _check(foot.topic, own)) if on_stamps else own,
            foot.rule,
            settings.clock,
            breaks,
            force_in_world=settings.force_in_world,
            has_force=foot.has_force,
        )
        for foot, own in zip(settings.feet, samples, strict=True)
    )
    poses = without_bad_stamps(recording.base, base_check) if on_stamps else recording.base
    base = base_history(poses, settings.clock, breaks)
    leaning = leaning_walk_rad(base, feet)
    behind = offsets.get(settings.odometry_topic)
    return Corrected(
        recording=replace(recording, feet=samples),
        settings=settings,
        frames=frames,
        turned=turned,
        feet=feet,
        places=places,
        base=base if leaning is None else base.without_poses(),
        leaning_rad=leaning,
        clocks=clocks if on_stamps else (),
        joint_clocks=_joint_clocks(recording.joints, offsets, named) if on_stamps else (),
        topics=_topic_qualities(settings, times, feet),
        commands=_vectors(settings, settings.command_topic, recording.commands, behind),
        inertial=_vectors(settings, settings.imu_topic, recording.accelerations, behind),
    )


def usable_samples(recording: Recording, settings: WalkSettings) -> tuple[Samples, ...]:
    """Return the contact samples of each foot whose times can be used."""
    if settings.clock is TimeSource.LOG:
        return recording.feet
    checked = [
        (each, _check(foot.topic, each).usable)
        for foot, each in zip(settings.feet, recording.feet, strict=True)
    ]
    return tuple(each if usable.all() else each.pick(usable) for each, usable in checked)


def _check(topic: str, columns: Samples | Odometry) -> StampCheck:
    """Check the header stamps of a foot or the base."""
    return check_stamps(topic, columns.stamp, columns.log_time)


def _without_filters(
    recording: Recording, settings: WalkSettings
) -> tuple[Recording, WalkSettings]:
    """Take out low-pass filters that forces went through, where these decide contact."""
    rows = [
        row
        for row, foot in enumerate(settings.feet)
        if foot.has_force
        and not (foot.has_flags or foot.lists_contacts or foot.silent_in_swing)
        and len(recording.feet[row].log_time)
    ]
    samples, feet = list(recording.feet), list(settings.feet)
    filters = find_filters([samples[row] for row in rows])
    for row, each in zip(rows, filters, strict=True):
        if each is not None:
            samples[row] = without_filter(samples[row], each)
            feet[row] = feet[row]._replace(low_pass=each)
    return replace(recording, feet=tuple(samples)), replace(settings, feet=tuple(feet))


def _joint_clocks(
    joints: Sequence[JointTable], offsets: Mapping[str, OffsetTrack], feet: Sequence[str]
) -> tuple[ClockDifference, ...]:
    """Compare the clocks of joint states, too."""
    own = [(table.topic, table.samples.log_time, table.samples.stamp) for table in joints]
    # Messages without a stamp have their log time.
    tracks = {name: offset_track(log[log != at], at[log != at]) for name, log, at in own}
    return clock_differences({**tracks, **offsets}, feet) if tracks else ()


def _in_frames(recording: Recording, settings: WalkSettings, frames: KnownFrames) -> WalkSettings:
    """Return settings with the frame of the forces, and how the accelerometer is mounted."""
    seen = frames.wrench_frame
    if settings.wrench_frame is WrenchFrame.UNKNOWN:
        settings = replace(
            settings, wrench_frame=seen.frame, wrench_frame_is_inferred=seen.is_inferred
        )
    if recording.accelerations is None or settings.imu_mounting is not None:
        return settings
    return replace(settings, imu_mounting=imu_mounting(recording, frames))


def _corrected_samples(
    recording: Recording, settings: WalkSettings, frames: KnownFrames
) -> tuple[
    tuple[Samples, ...],
    tuple[FootPath | None, ...],
    tuple[WorldFrames, Counts] | None,
]:
    """Take off offsets, fill swings in, turn forces and places into the world.

    Returns:
        samples and places of each foot, and how they were turned, as in `Corrected`.
    """
    feet = [
        without_offset(own, foot) for foot, own in zip(settings.feet, recording.feet, strict=True)
    ]
    silent = [row for row, foot in enumerate(settings.feet) if foot.silent_in_swing]
    feet = list(with_swings(feet, silent, settings.silent_from, settings.silent_until))
    clock = settings.clock
    places: list[FootPath | None] = [None] * len(feet)
    for row in [row for row, foot in enumerate(settings.feet) if foot.in_base]:
        # A driver leaves places at the origin that it does not know.
        known = (feet[row].position != 0.0).any(axis=1, keepdims=True)
        position = np.where(known, feet[row].position, np.nan)
        feet[row] = replace(feet[row], position=position)
        places[row] = path_of(clock.of(feet[row]), position)
    if settings.contact_from and settings.odometry_topic:
        # Joints have told these places, and the poses have placed them in the world.
        poses = base_history(recording.base, clock)
        places = [path_in_base(clock.of(own), own.position, poses) for own in feet]
    # No slip or support is measured with the origin of a foot's frame: it is no contact point.
    links = frames.links if settings.wrench_frame is WrenchFrame.LINK else [None] * len(feet)
    turning = frames.follow(links, frames.in_base(settings))
    if turning is not None:
        samples, counts = turning.place(feet)
        return samples, tuple(places), (turning, counts)
    if not settings.contact_from:
        # Nothing turns these places into the world.
        feet = [
            replace(own, position=np.full_like(own.position, np.nan)) if path else own
            for own, path in zip(feet, places, strict=True)
        ]
    return tuple(feet), tuple(places), None


def _vectors(
    settings: WalkSettings, topic: str, recorded: VectorTopic | None, behind: OffsetTrack | None
) -> "VectorHistory | None":
    """Return the vectors of a topic; None without any. Loaded for logs that have them."""
    if recorded is None:
        return None
    from dogbot_logtool.core.vectors import vector_history  # noqa: PLC0415

    return vector_history(topic, recorded.samples, recorded.frames, settings.clock, behind)


def _topic_qualities(
    settings: WalkSettings, times: Mapping[str, TopicTimes], feet: Sequence[FootHistory]
) -> tuple[TopicQuality, ...]:
    """Return the timing of all topics; a swing is no gap of a sensor that is silent in swing.

    Such a topic has a gap where none of its feet is known to swing or to stand.
    """
    gaps: dict[str, list[Ints]] = {}
    for foot, record in zip(settings.feet, feet, strict=True):
        if foot.silent_in_swing and record.start is not None:
            gaps.setdefault(foot.topic, []).append(record.gaps)
    silences = {topic: timespans.intersect(spans) for topic, spans in gaps.items()}
    return tuple(
        topic_quality(each, settings.clock, silences.get(topic))
        for topic, each in sorted(times.items())
    )
