"""From the columns of a recording to all figures of its walk.

    stats = analyse(recording, StatsSettings(feet, mass_kg=19.2))

The order is the same for every log: corrections here (clock, bad stamps), masks in
`masked_walk.py`, metrics in `evaluation.py`. Checks (`checks/`) then look for reasons to doubt what
was measured, and `walk_metrics/` sets to null what their findings void.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.core.base.poses import base_history
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
from dogbot_logtool.core.evaluation import work_out
from dogbot_logtool.core.masked_walk import Recorded
from dogbot_logtool.core.quality.quality import (
    TopicQuality,
    TopicTimes,
    topic_quality,
    topic_times,
    with_gaps,
)
from dogbot_logtool.core.recording import Recording, VectorTopic
from dogbot_logtool.core.settings import StatsSettings
from dogbot_logtool.core.statistics import Stats

if TYPE_CHECKING:
    from dogbot_logtool.core.frames.transforms import TransformBuffer
    from dogbot_logtool.core.legs.paths import LegSettings
    from dogbot_logtool.core.vectors import VectorHistory


def analyse(
    recording: Recording,
    settings: StatsSettings,
    legs: "tuple[LegSettings, TransformBuffer] | None" = None,
) -> Stats:
    """Work out all figures of a recording.

    Args:
        recording: its columns, with forces above the sensors' offsets and in the world.
        settings: what decides the figures.
        legs: where the recording tells of legs, and their frames that transforms move; None: it
            does not.
    """
    samples = recording.feet
    times = {
        topic: topic_times(topic, each.log_time, each.stamp)
        for topic, each in recording.topics.items()
        if len(each.log_time)
    }
    tracks = _offset_tracks(times, settings)
    checks, base_check = _stamp_checks(recording, settings)
    clock = choose_clock(
        [*checks, base_check], _differences(tracks, settings), settings.time_source
    )
    settings = on_clock(settings, clock)
    base = recording.base
    on_stamps = clock.source is TimeSource.HEADER
    if on_stamps:
        samples = tuple(without_bad_stamps(*each) for each in zip(samples, checks, strict=True))
        base = without_bad_stamps(base, base_check)
    feet = tuple(_foot(foot, each, settings, clock) for foot, each in enumerate(samples))
    recorded = Recorded(
        feet=feet,
        base=base_history(base, clock.source, clock.breaks),
        clocks=_differences(tracks, settings) if on_stamps else (),
        topics=_topic_qualities(settings, times, feet),
        commands=_vectors(settings, settings.command_topic, recording.commands, tracks),
        inertial=_vectors(settings, settings.imu_topic, recording.accelerations, tracks),
    )
    stats = work_out(settings, recorded)
    return stats if legs is None else _with_legs(recording, stats, legs, tracks)


def log_clock(recording: Recording, settings: StatsSettings) -> LogClock:
    """Choose the clock that a recording is measured on."""
    times = {
        topic: topic_times(topic, each.log_time, each.stamp)
        for topic, each in recording.topics.items()
        if topic in _measured_topics(settings) and len(each.log_time)
    }
    checks, base_check = _stamp_checks(recording, settings)
    differences = _differences(_offset_tracks(times, settings), settings)
    return choose_clock([*checks, base_check], differences, settings.time_source)


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


def _foot(foot: int, samples: Samples, settings: StatsSettings, clock: LogClock) -> FootHistory:
    """Measure a foot by its samples, whose bad stamps are zero."""
    return foot_history(
        samples,
        settings.sensor(foot).rule,
        clock.source,
        force_in_world=settings.force_in_world,
        has_force=settings.feet[foot].has_force,
        breaks=clock.breaks,
    )


def _vectors(
    settings: StatsSettings,
    topic: str,
    recorded: VectorTopic | None,
    tracks: Mapping[str, OffsetTrack],
) -> "VectorHistory | None":
    """Return the vectors of a topic; None without any. Loaded for logs that have them."""
    if recorded is None:
        return None
    from dogbot_logtool.core.vectors import vector_history  # noqa: PLC0415

    base = tracks.get(settings.odometry_topic)
    return vector_history(topic, recorded.samples, recorded.frames, settings.clock, base)


def _with_legs(
    recording: Recording,
    stats: Stats,
    legs: "tuple[LegSettings, TransformBuffer]",
    tracks: Mapping[str, OffsetTrack],
) -> Stats:
    """Add the figures of the legs."""
    from dogbot_logtool.core.leg_evaluation import with_legs  # noqa: PLC0415

    settings, frames = legs
    offsets = {}
    for table in recording.joints:
        own = table.samples
        # Messages without a stamp have their log time.
        stamped = own.stamp != own.log_time
        offsets[table.topic] = offset_track(own.log_time[stamped], own.stamp[stamped])
    on_stamps = stats.settings.clock is TimeSource.HEADER
    clocks = _differences({**offsets, **tracks}, stats.settings) if on_stamps else ()
    return with_legs(stats, recording.joints, settings, frames, clocks)


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
