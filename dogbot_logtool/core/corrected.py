"""Correct the columns of a recording: one clock, sensors' offsets, silences, frames of forces."""

import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Floats, Ints
from dogbot_logtool.core.base.ground import FootPath, path_in_base, path_of
from dogbot_logtool.core.base.motion import leaning_walk_rad
from dogbot_logtool.core.base.poses import BaseHistory, Odometry, base_history
from dogbot_logtool.core.clock import (
    ClockDifference,
    OffsetTrack,
    StampCheck,
    TimeSource,
    advancing,
    check_stamps,
    clock_at,
    clock_breaks,
    clock_differences,
    offset_track,
    why_clocks_cannot_be_joined,
    why_unusable,
)
from dogbot_logtool.core.contact.contacts import Samples, with_swings
from dogbot_logtool.core.contact.filtered import find_filters, without_filter
from dogbot_logtool.core.contact.foot_history import FootHistory, foot_history
from dogbot_logtool.core.frames.transforms import lookup, track_of
from dogbot_logtool.core.frames.wrench_frame import WrenchFrame
from dogbot_logtool.core.known_frames import (
    Counts,
    KnownFrames,
    known_frames,
)
from dogbot_logtool.core.quality import TopicQuality, topic_quality
from dogbot_logtool.core.recording import JointTable, Recording, VectorTopic, has_own_stamps
from dogbot_logtool.core.rotations import conjugate, multiply, normalised, rotate
from dogbot_logtool.core.sensors import with_sensors, without_offset
from dogbot_logtool.core.settings import WalkSettings
from dogbot_logtool.finding import Finding, Words, found

if TYPE_CHECKING:
    from dogbot_logtool.core.vectors import VectorHistory


class Corrected(NamedTuple):
    """The columns of a recording on one clock, with forces in the world above sensors' offsets."""

    recording: Recording
    """With the contact samples that are measured."""
    settings: WalkSettings
    """With the clock that is used, how sensors read, and the frame of the forces."""
    frames: KnownFrames
    turned: Counts
    """How many forces and positions were turned into the world; empty: none was to be."""
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
    named = [foot.topic for foot in settings.feet]
    offsets = _offsets(recording, {*named, settings.odometry_topic})
    clocks = clock_differences(offsets, named)
    checks = [*map(_check, named, recording.feet)]
    checks.append(_check(settings.odometry_topic or "the odometry", recording.base))
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
            own,
            foot.rule,
            settings.clock,
            breaks,
            force_in_world=settings.force_in_world,
            has_force=foot.has_force,
        )
        for foot, own in zip(settings.feet, samples, strict=True)
    )
    base = base_history(recording.base, settings.clock, breaks)
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
        topics=_topic_qualities(recording, settings, feet),
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


def _offsets(recording: Recording, topics: Collection[str]) -> dict[str, OffsetTrack]:
    """Return how far the stamps of some topics lie behind log time, where they have any."""
    found = {}
    for topic, times in sorted(recording.topics.items()):
        if topic in topics and times.stamp is not None:
            check = check_stamps(topic, times.stamp, times.log_time)
            if check.mostly_usable:
                rows = check.usable
                found[topic] = offset_track(times.log_time[rows], times.stamp[rows])
    return found


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
    if recording.accelerations is None:
        return settings
    return replace(settings, imu_mounting=frames.mounting(recording.accelerations.frames))


def _corrected_samples(
    recording: Recording, settings: WalkSettings, frames: KnownFrames
) -> tuple[
    tuple[Samples, ...],
    tuple[FootPath | None, ...],
    Counts,
]:
    """Take off offsets, fill swings in, turn forces and places into the world.

    Returns:
        samples and places of each foot, and how many were turned, as in `Corrected`.
    """
    feet = [
        without_offset(own, foot) for foot, own in zip(settings.feet, recording.feet, strict=True)
    ]
    silent = [row for row, foot in enumerate(settings.feet) if foot.silent_in_swing]
    clock = settings.clock
    feet = list(with_swings(feet, silent, clock, settings.silent_from, settings.silent_until))
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
        return samples, tuple(places), counts
    if not settings.contact_from:
        # Nothing turns these places into the world.
        feet = [
            replace(own, position=np.full_like(own.position, np.nan)) if path else own
            for own, path in zip(feet, places, strict=True)
        ]
    return tuple(feet), tuple(places), {}


def _vectors(
    settings: WalkSettings, topic: str, recorded: VectorTopic | None, behind: OffsetTrack | None
) -> "VectorHistory | None":
    """Return the vectors of a topic; None without any. Loaded for logs that have them."""
    if recorded is None:
        return None
    from dogbot_logtool.core.vectors import vector_history  # noqa: PLC0415

    return vector_history(topic, recorded, settings.clock, behind)


def _topic_qualities(
    recording: Recording, settings: WalkSettings, feet: Sequence[FootHistory]
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
        topic_quality(topic, each.log_time, each.stamp, settings.clock, silences.get(topic))
        for topic, each in sorted(recording.topics.items())
        if len(each.log_time)
    )


SAME_SPEED: Final = 0.02
"""Difference of a clock's speed from that of log time that does not matter."""
FEWEST: Final = 20
LONG_NS: Final = 1_000_000_000


def on_one_clock(recording: Recording, topic: str) -> tuple[Recording, tuple[Finding, ...]]:
    """Stamp feet and base that have no stamps by the clock of those that do.

    Only where that clock runs at another speed than log time, as in a simulation: what comes
    without a stamp happened when the stamped clock read what it did at that log time.

    Args:
        recording: the columns of a log.
        topic: of the base's poses.

    Returns:
        the recording, and what was done.
    """
    every: list[Any] = [*recording.feet, recording.base]
    speaking = [each for each in every if len(each.log_time)]
    stamped = [each for each in speaking if has_own_stamps(each)]
    if not stamped or len(stamped) == len(speaking):
        return recording, ()
    source = max(stamped, key=lambda each: len(each.log_time))
    rows = np.flatnonzero((source.stamp > 0) & advancing(source.stamp) & advancing(source.log_time))
    log_time, stamp = source.log_time[rows], source.stamp[rows]
    if len(rows) < FEWEST or log_time[-1] - log_time[0] < LONG_NS:
        return recording, ()
    speed = float(stamp[-1] - stamp[0]) / float(log_time[-1] - log_time[0])
    if abs(speed - 1.0) <= SAME_SPEED:
        return recording, ()
    for row, each in enumerate(every):
        if not has_own_stamps(each):
            every[row] = replace(each, stamp=clock_at(each.log_time, log_time, stamp))
    changed = replace(recording, feet=tuple(every[:-1]), base=every[-1])
    names = ("odometry", "feet") if has_own_stamps(recording.base) else ("feet", "odometry")
    words: Words = {"stamped": names[0], "others": names[1], "speed": speed}
    return changed, (found("CLOCK_OFFSET", "little", say="others", where=topic, **words),)


_SENSORS: Final = frozenset(
    {"imu", "camera", "cam", "lidar", "laser", "gps", "gnss", "livox", "velodyne", "ouster"}
    | {"os", "sensor", "t265", "zed", "realsense", "optical", "marker", "antenna"}
)
"""Words of links that are no base."""
_FLOOR: Final = "base_footprint"


def poses_of_base(
    recording: Recording,
    topic: str,
    named: str | None,
    bases: Sequence[str],
) -> tuple[Recording, tuple[Finding, ...]]:
    """Move poses of another link to the base, where static transforms tell how.

    Args:
        recording: the columns of a log.
        topic: of the poses.
        named: the base's frame, if the robot's file tells it.
        bases: usual names of a base's frame, the best first.

    Returns:
        the recording, and what was done, or could not be.
    """
    frames = [name.lstrip("/") for name in recording.base_frames if name.strip("/")]
    if len(frames) != 1:
        return recording, ()
    statics = {
        child: track
        for (parent, child), own in recording.transforms.items()
        if own.static.any() and (track := track_of(parent, own, TimeSource.LOG))
    }
    parents = {child: track.parent for child, track in statics.items()}
    above = [frames[0]]
    while above[-1] in parents and parents[above[-1]] not in above:
        above.append(parents[above[-1]])
    base = _base_of(above, named and named.lstrip("/"), bases, parents)
    if base == above[0]:
        return recording, ()
    now = np.zeros(1, np.int64)
    own, other = (lookup(statics, each, above[-1], now, now) for each in (above[0], base or ""))
    if not (own.known[0] and other.known[0]):
        return recording, (found("POSE_FRAME", "unknown", topic=topic, frame=above[0]),)
    displacement, back = other.translation - own.translation, conjugate(own.rotation)
    moved = replace(
        recording,
        base=_moved(recording.base, rotate(back, displacement), multiply(back, other.rotation)),
        base_frames=(base or "",),
    )
    metres = float(np.linalg.norm(displacement))
    moving = found("POSE_FRAME", topic=topic, frame=above[0], base=base, metres=metres)
    return moved, (moving,)


def _base_of(
    above: Sequence[str], named: str | None, bases: Sequence[str], parents: Mapping[str, str]
) -> str | None:
    """Return the base that a link belongs to; itself, where it may be one; None: not known.

    Args:
        above: the link, its parent, its parent's parent, and so on.
        named: the base's frame by the robot's file.
        bases: usual names of bases.
        parents: by frame.
    """
    child = above[0]
    if named is not None and named != child:
        return named if named in {*parents, *parents.values()} else child
    for base in bases:
        if base in above and base != _FLOOR:
            return base
        if child == _FLOOR and parents.get(base) == child:
            return base
    words = frozenset(re.findall(r"[a-z0-9]+", child.lower()))
    return child if words.isdisjoint(_SENSORS) else None


def _moved(base: Odometry, translation: Floats, rotation: Floats) -> Odometry:
    """Return the poses of a point of the same body, whose own turn is part of it."""
    turned = base.orientation.any(axis=1)
    orientation, position = base.orientation.copy(), base.position.copy()
    unit = normalised(base.orientation[turned])
    position[turned] += rotate(unit, translation)
    orientation[turned] = multiply(unit, rotation)
    return replace(base, position=position, orientation=orientation)
