"""Correct the columns of a recording: one clock, sensors' offsets, silences, frames of forces."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.core.base.axes import leaning_walk_rad
from dogbot_logtool.core.base.foot_path import FootPath, path_in_base, path_of
from dogbot_logtool.core.base.poses import BaseHistory, Odometry, base_history
from dogbot_logtool.core.contact.contact_rule import without_offset
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.contact.foot_history import FootHistory, foot_history
from dogbot_logtool.core.contact.silent_swing import with_swings
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
from dogbot_logtool.core.frames.wrench_frame import WrenchFrame
from dogbot_logtool.core.known_frames import (
    KnownFrames,
    imu_mounting,
    known_frames,
    world_frames,
)
from dogbot_logtool.core.quality.quality import (
    TopicQuality,
    TopicTimes,
    topic_quality,
    topic_times,
    with_gaps,
)
from dogbot_logtool.core.recording import Recording, VectorTopic
from dogbot_logtool.core.sensors import with_sensors
from dogbot_logtool.core.settings import FootSettings, WalkSettings
from dogbot_logtool.core.world_frames import PlacedCounts, WorldFrames

if TYPE_CHECKING:
    from dogbot_logtool.core.legs.joints import JointTable
    from dogbot_logtool.core.vectors import VectorHistory


@dataclass(frozen=True, slots=True)
class Corrected:
    """The columns of a recording on one clock, with forces in the world above sensors' offsets."""

    recording: Recording
    """With the contact samples that are measured."""
    settings: WalkSettings
    """With the clock that is used, how sensors read, and the frame of the forces."""
    frames: KnownFrames
    turned: tuple[WorldFrames, PlacedCounts] | None
    """How forces and positions were turned into the world; None: none was to be."""
    feet: tuple[FootHistory, ...]
    places: tuple[FootPath | None, ...]
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
    offsets = _offset_tracks(times, settings)
    differences = clock_differences(offsets, [foot.topic for foot in settings.feet])
    named = [foot.topic for foot in settings.feet]
    checks = [_check(*each, times) for each in zip(named, recording.feet, strict=True)]
    base_check = _check(settings.odometry_topic or "the odometry", recording.base, times)
    clock = choose_clock([*checks, base_check], differences, settings.time_source)
    settings = _learnt(recording, _on_clock(settings, clock))
    frames = known_frames(recording, settings)
    settings = _in_frames(recording, settings, frames)
    turning = world_frames(frames, settings)
    samples = _with_swings(_without_offsets(recording.feet, settings), settings)
    samples = _without_unfilled_places(samples, settings)
    places = _places(samples, recording.base, settings)
    turned = None
    if turning is None:
        # Places that legs tell are in the world already.
        samples = samples if settings.contact_from else _without_places(samples, places)
    else:
        tracks = turning.tracks(recording.transforms, recording.base)
        samples, counts = turning.place(samples, tracks)
        turned = turning, counts
    feet = _histories(samples, recording.feet, checks, settings, clock)
    on_stamps = clock.source is TimeSource.HEADER
    poses = without_bad_stamps(recording.base, base_check) if on_stamps else recording.base
    base = base_history(poses, clock.source, clock.breaks)
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
        offsets=offsets,
        clocks=differences if on_stamps else (),
        topics=_topic_qualities(settings, times, feet),
        commands=_vectors(settings, settings.command_topic, recording.commands, behind),
        inertial=_vectors(settings, settings.imu_topic, recording.accelerations, behind),
    )


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
    every = {**offsets, **corrected.offsets}
    return clock_differences(every, [foot.topic for foot in settings.feet])


def usable_samples(recording: Recording, settings: WalkSettings) -> tuple[Samples, ...]:
    """Return the contact samples of each foot whose times can be used."""
    if settings.clock is TimeSource.LOG:
        return recording.feet
    checked = [
        (each, check_stamps(foot.topic, each.stamp, each.log_time).usable)
        for foot, each in zip(settings.feet, recording.feet, strict=True)
    ]
    return tuple(each if usable.all() else each.pick(usable) for each, usable in checked)


def _check(topic: str, columns: Samples | Odometry, times: Mapping[str, TopicTimes]) -> StampCheck:
    """Check the header stamps of a foot or the base, which are often those of its topic."""
    known = times.get(topic)
    if known is not None and known.check is not None and columns.stamp is known.stamp:
        return known.check
    return check_stamps(topic, columns.stamp, columns.log_time)


def _offset_tracks(
    times: Mapping[str, TopicTimes], settings: WalkSettings
) -> dict[str, OffsetTrack]:
    """Return how far the stamps of the feet and of the base lie behind log time, by topic."""
    measured = {*(foot.topic for foot in settings.feet), settings.odometry_topic}
    return {
        topic: times[topic].offset_track()
        for topic in sorted(measured & times.keys())
        if times[topic].has_stamps
    }


def _on_clock(settings: WalkSettings, clock: LogClock) -> WalkSettings:
    """Return settings that say which clock is used, where no option did."""
    if not clock.reason:
        return settings
    return replace(settings, time_source=clock.source, time_source_reason=clock.reason)


def _learnt(recording: Recording, settings: WalkSettings) -> WalkSettings:
    """Return settings that know how the feet's sensors read, unless they did.

    Some physics engines tell contacts with wrenches that are all zero: these are no forces.
    """
    feet = tuple(
        replace(foot, has_force=False, forces_are_zero=foot.has_force)
        if samples.in_contact.any() and not samples.force[samples.in_contact].any()
        else foot
        for foot, samples in zip(settings.feet, recording.feet, strict=True)
    )
    settings = replace(settings, feet=feet)
    if all(foot.sensor is not None for foot in feet):
        return settings
    return with_sensors(settings, recording.feet)


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


def _without_offsets(feet: Sequence[Samples], settings: WalkSettings) -> tuple[Samples, ...]:
    """Take off what unloaded sensors read."""
    found = []
    for row, recorded in enumerate(feet):
        foot = settings.feet[row]
        samples = without_offset(
            recorded,
            settings.sensor(row),
            lists_contacts=foot.lists_contacts,
            only_presses=foot.only_presses,
        )
        found.append(samples)
    return tuple(found)


def _places(
    feet: Sequence[Samples], base: Odometry, settings: WalkSettings
) -> tuple[FootPath | None, ...]:
    """Return the places of feet in the base's axes, where messages or joints tell those."""
    clock = settings.clock
    if settings.contact_from and settings.odometry_topic:
        # Joints have told these places, and the poses have placed them in the world.
        poses = base_history(base, clock)
        return tuple(path_in_base(clock.of(each), each.position, poses) for each in feet)
    return tuple(
        path_of(clock.of(samples), samples.position) if foot.in_base else None
        for foot, samples in zip(settings.feet, feet, strict=True)
    )


def _without_unfilled_places(
    feet: tuple[Samples, ...], settings: WalkSettings
) -> tuple[Samples, ...]:
    """Return samples without places in the base's axes that a driver leaves at the origin."""
    found = []
    for foot, samples in zip(settings.feet, feet, strict=True):
        unfilled = np.flatnonzero(~samples.position.any(axis=1)) if foot.in_base else np.empty(0)
        if len(unfilled):
            position = samples.position.copy()
            position[unfilled] = np.nan
            found.append(replace(samples, position=position))
        else:
            found.append(samples)
    return tuple(found)


def _without_places(
    feet: Sequence[Samples], places: Sequence[FootPath | None]
) -> tuple[Samples, ...]:
    """Return samples without positions that nothing turns into the world."""
    return tuple(
        replace(samples, position=np.full_like(samples.position, np.nan)) if path else samples
        for samples, path in zip(feet, places, strict=True)
    )


def _with_swings(feet: tuple[Samples, ...], settings: WalkSettings) -> tuple[Samples, ...]:
    """Insert samples without contact where silence is swing."""
    silent = [row for row, foot in enumerate(settings.feet) if foot.silent_in_swing]
    return with_swings(feet, silent, settings.silent_from, settings.silent_until)


def _histories(
    feet: Sequence[Samples],
    recorded: Sequence[Samples],
    checks: Sequence[StampCheck],
    settings: WalkSettings,
    clock: LogClock,
) -> tuple[FootHistory, ...]:
    """Find the contacts of each foot.

    Args:
        feet: corrected samples.
        recorded: as recorded, of which stamps are checked.
        checks: of these.
        settings: what decides contact.
        clock: that is measured on.
    """
    if clock.source is TimeSource.HEADER:
        own = [
            _own_check(*each) for each in zip(settings.feet, feet, recorded, checks, strict=True)
        ]
        feet = [without_bad_stamps(*each) for each in zip(feet, own, strict=True)]
    return tuple(
        foot_history(
            samples,
            settings.sensor(row).rule,
            clock.source,
            force_in_world=settings.force_in_world,
            has_force=settings.feet[row].has_force,
            breaks=clock.breaks,
        )
        for row, samples in enumerate(feet)
    )


def _own_check(
    foot: FootSettings, samples: Samples, recorded: Samples, check: StampCheck
) -> StampCheck:
    """Return the check of samples, of which some may have been inserted."""
    is_known = samples.stamp is recorded.stamp
    return check if is_known else check_stamps(foot.topic, samples.stamp, samples.log_time)


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
    found = {topic: topic_quality(each, settings.clock) for topic, each in times.items()}
    gaps: dict[str, list[Ints]] = {}
    for foot, record in zip(settings.feet, feet, strict=True):
        if foot.silent_in_swing and record.start is not None:
            gaps.setdefault(foot.topic, []).append(record.gaps)
    for topic, spans in gaps.items():
        if topic in found:
            found[topic] = with_gaps(found[topic], timespans.intersect(spans))
    return tuple(quality for _, quality in sorted(found.items()))
