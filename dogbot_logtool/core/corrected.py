"""Correct the columns of a recording: one clock, no bad stamps, forces as contacts of feet."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.core.base.axes import leaning_walk_rad
from dogbot_logtool.core.base.poses import BaseHistory, base_history
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.contact.foot_history import FootHistory, foot_history
from dogbot_logtool.core.corrections.clock import (
    ClockDifference,
    LogClock,
    OffsetTrack,
    StampCheck,
    TimeSource,
    check_stamps,
    choose_clock,
    clock_differences,
    offset_track,
    without_bad_stamps,
)
from dogbot_logtool.core.quality.quality import (
    TopicQuality,
    TopicTimes,
    topic_quality,
    topic_times,
    with_gaps,
)
from dogbot_logtool.core.recording import Recording, VectorTopic
from dogbot_logtool.core.settings import StatsSettings
from dogbot_logtool.dataclass import dataclass

if TYPE_CHECKING:
    from dogbot_logtool.core.base.foot_path import FootPath
    from dogbot_logtool.core.legs.joints import JointTable
    from dogbot_logtool.core.vectors import VectorHistory


@dataclass(frozen=True, slots=True)
class Corrected:
    """The columns of a recording on one clock."""

    settings: StatsSettings
    """With the clock that is used."""
    feet: tuple[FootHistory, ...]
    places: "tuple[FootPath | None, ...]"
    """Of each foot in the base's axes, where its messages tell that."""
    base: BaseHistory
    """As recorded, jumps and all; without poses if these lean."""
    leaning_rad: float | None
    """rad, how far the base seems to lean while the robot walks: its poses are left out; None: it
    does not."""
    offsets: Mapping[str, OffsetTrack]
    """How far the stamps of the feet and of the base lie behind log time, by topic."""
    clocks: tuple[ClockDifference, ...]
    """How far topics' clocks are from that of the feet; nothing on log time."""
    topics: tuple[TopicQuality, ...]
    commands: "VectorHistory | None"
    """Velocity commands; None: the log has none. Likewise `inertial`."""
    inertial: "VectorHistory | None"


def correct(recording: Recording, settings: StatsSettings) -> Corrected:
    """Choose the clock, leave out bad stamps, and find the contacts of each foot.

    Args:
        recording: columns, with forces above the sensors' offsets and in the world.
        settings: what decides the metrics.
    """
    times = _times(recording, set(recording.topics))
    offsets = _offset_tracks(times, settings)
    checks, base_check = _stamp_checks(recording, settings)
    differences = _differences(offsets, settings)
    clock = choose_clock([*checks, base_check], differences, settings.time_source)
    settings = on_clock(settings, clock)
    samples, poses = recording.feet, recording.base
    on_stamps = clock.source is TimeSource.HEADER
    if on_stamps:
        samples = tuple(without_bad_stamps(*each) for each in zip(samples, checks, strict=True))
        poses = without_bad_stamps(poses, base_check)
    feet = tuple(
        foot_history(
            each,
            settings.sensor(row).rule,
            clock.source,
            force_in_world=settings.force_in_world,
            has_force=settings.feet[row].has_force,
            breaks=clock.breaks,
        )
        for row, each in enumerate(samples)
    )
    base = base_history(poses, clock.source, clock.breaks)
    leaning = leaning_walk_rad(base, feet)
    behind = offsets.get(settings.odometry_topic)
    return Corrected(
        settings=settings,
        feet=feet,
        places=recording.places or (None,) * len(feet),
        base=base if leaning is None else base.without_poses(),
        leaning_rad=leaning,
        offsets=offsets,
        clocks=differences if on_stamps else (),
        topics=_topic_qualities(settings, times, feet),
        commands=_vectors(settings, settings.command_topic, recording.commands, behind),
        inertial=_vectors(settings, settings.imu_topic, recording.accelerations, behind),
    )


def log_clock(recording: Recording, settings: StatsSettings) -> LogClock:
    """Choose the clock that a recording is measured on."""
    times = _times(recording, _measured_topics(settings))
    checks, base_check = _stamp_checks(recording, settings)
    differences = _differences(_offset_tracks(times, settings), settings)
    return choose_clock([*checks, base_check], differences, settings.time_source)


def clocks_of_joints(
    corrected: Corrected, joints: "Sequence[JointTable]"
) -> tuple[ClockDifference, ...]:
    """Compare the clocks of joint states, too; nothing on log time."""
    settings = corrected.settings
    if settings.clock is TimeSource.LOG:
        return ()
    offsets = {}
    for table in joints:
        own = table.samples
        # Messages without a stamp have their log time.
        stamped = own.stamp != own.log_time
        offsets[table.topic] = offset_track(own.log_time[stamped], own.stamp[stamped])
    return _differences({**offsets, **corrected.offsets}, settings)


def _times(recording: Recording, topics: set[str]) -> dict[str, TopicTimes]:
    """Return the times of some topics that have messages."""
    return {
        topic: topic_times(topic, each.log_time, each.stamp)
        for topic, each in recording.topics.items()
        if topic in topics and len(each.log_time)
    }


def on_clock(settings: StatsSettings, clock: LogClock) -> StatsSettings:
    """Return settings that say which clock is used, where no option did."""
    if not clock.reason:
        return settings
    return replace(settings, time_source=clock.source, time_source_reason=clock.reason)


def usable_samples(recording: Recording, settings: StatsSettings) -> tuple[Samples, ...]:
    """Return the contact samples of each foot whose times can be used."""
    if settings.clock is TimeSource.LOG:
        return recording.feet
    checks, _ = _stamp_checks(recording, settings)
    return tuple(
        each if check.usable.all() else each.pick(check.usable)
        for each, check in zip(recording.feet, checks, strict=True)
    )


def _stamp_checks(
    recording: Recording, settings: StatsSettings
) -> tuple[list[StampCheck], StampCheck]:
    """Check the header stamps of each foot, and of the base."""
    checks = [
        check_stamps(foot.topic, each.stamp, each.log_time)
        for foot, each in zip(settings.feet, recording.feet, strict=True)
    ]
    name, base = settings.odometry_topic or "the odometry", recording.base
    return checks, check_stamps(name, base.stamp, base.log_time)


def _measured_topics(settings: StatsSettings) -> set[str]:
    """Return the topics of the feet and of the base."""
    return {*(foot.topic for foot in settings.feet), settings.odometry_topic}


def _offset_tracks(
    times: Mapping[str, TopicTimes], settings: StatsSettings
) -> dict[str, OffsetTrack]:
    """Return how far the stamps of the feet and of the base lie behind log time, by topic."""
    return {
        topic: times[topic].offset_track()
        for topic in sorted(_measured_topics(settings) & times.keys())
        if times[topic].has_stamps
    }


def _differences(
    tracks: Mapping[str, OffsetTrack], settings: StatsSettings
) -> tuple[ClockDifference, ...]:
    """Compare the clocks of topics with that of the feet."""
    return clock_differences(tracks, [foot.topic for foot in settings.feet])


def _vectors(
    settings: StatsSettings, topic: str, recorded: VectorTopic | None, behind: OffsetTrack | None
) -> "VectorHistory | None":
    """Return the vectors of a topic; None without any. Loaded for logs that have them."""
    if recorded is None:
        return None
    from dogbot_logtool.core.vectors import vector_history  # noqa: PLC0415

    return vector_history(topic, recorded.samples, recorded.frames, settings.clock, behind)


def _topic_qualities(
    settings: StatsSettings, times: Mapping[str, TopicTimes], feet: Sequence[FootHistory]
) -> tuple[TopicQuality, ...]:
    """Return the timing of all topics; a swing is no gap of a sensor that is silent in swing.

    Such a topic has a gap where none of its feet is known to swing or to stand.
    """
    found = {topic: topic_quality(each, settings.clock) for topic, each in times.items()}
    gaps: dict[str, list[Ints]] = {}
    for foot, record in zip(settings.feet, feet, strict=True):
        if foot.silent_in_swing and record.start is not None:
            gaps.setdefault(foot.topic, []).append(record.gaps)
    for topic, spans in gaps.items():
        if topic in found:
            found[topic] = with_gaps(found[topic], timespans.intersect(spans))
    return tuple(quality for _, quality in sorted(found.items()))
