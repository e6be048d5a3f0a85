"""`dogbot-logtool info`: what is in a log, what will be used, and what is wrong with it."""

from collections.abc import Sequence
from collections.abc import Set as AbstractSet
from contextlib import closing
from dataclasses import replace
from typing import Final

from dogbot_logtool.conversion.findings import second_tf
from dogbot_logtool.core.checks.recorded import name_findings, stamp_findings
from dogbot_logtool.core.known_frames import KnownFrames, known_frames
from dogbot_logtool.core.quality import mean_rate_hz
from dogbot_logtool.core.recording import Recording
from dogbot_logtool.finding import Finding, by_severity, found
from dogbot_logtool.io.storage import Location
from dogbot_logtool.options.convert import ConvertOptions
from dogbot_logtool.options.info import InfoOptions
from dogbot_logtool.reader.containers.log import Log, damage_of
from dogbot_logtool.reader.messages.bases import ODOMETRY_TYPE
from dogbot_logtool.reader.messages.others import TRANSFORM_TYPES, is_static
from dogbot_logtool.reader.opening import open_joined
from dogbot_logtool.reader.recording import read_recording
from dogbot_logtool.results import LogInfo, TopicInfo
from dogbot_logtool.robot.frames import Frames, frame_findings, read_frames
from dogbot_logtool.robot.measuring.plan import settings_of
from dogbot_logtool.robot.recorded import without_annotations
from dogbot_logtool.robot.selection import Selection, select_topics
from dogbot_logtool.robot.topics import is_planned, joint_channels, side_topic
from dogbot_logtool.run.runner import OnProgress

_FIRST_NS: Final = 2_000_000_000
"""ns of a log that are read for the names and stamps in its messages."""


def describe(
    path: Location,
    options: InfoOptions,
    progress: OnProgress | None = None,
) -> LogInfo:
    """Look at a log: its index, and its first seconds for what an index does not tell.

    Args:
        path: the log.
        options: which topics to use; with `frames`, every transform is read.
        progress: called with bytes done and bytes in all.

    Raises:
        CallError: no such file, or a topic in the options that the log does not have.
        LogError: it is no log.
    """
    with closing(open_joined([path, *options.joined])) as log:
        recorded = without_annotations(log)
        ours = frozenset(log.channels.keys() - recorded.channels.keys())
        selection = select_topics(recorded, options)
        recording, chunks_seen = _first_seconds(recorded, selection)
        settings = settings_of(selection)
        known = known_frames(recording, settings)
        frames = None
        if options.frames:
            added_transforms = [
                channel
                for number, channel in log.channels.items()
                if number in ours and channel.type_name in TRANSFORM_TYPES
            ]
            transforms = [*selection.transforms, *added_transforms]
            frames = read_frames(log, transforms, options.jobs, progress)
            # Frames by every recorded transform instead of the first ones.
            heeded = {channel.id for channel in selection.transforms}
            known = replace(known, parents=frames.parents(heeded))
            slashed = recording.slashed_frames.union(frames.slashed)
            recording = replace(recording, slashed_frames=slashed)
        findings, added = _outlook(selection, known)
        findings += [*name_findings(recording), *stamp_findings(recording, settings)]
        findings = _with_legs(recorded, selection, options, findings)
        if frames is not None:
            findings += frame_findings(frames, added)
        duration_ns = None
        if log.start_time is not None and log.end_time is not None:
            duration_ns = log.end_time - log.start_time
        return LogInfo(
            path=path,
            size=log.source.size,
            container=log.container,
            profile=log.profile,
            compressions=log.compressions,
            start_time=log.start_time,
            duration_s=None if duration_ns is None else duration_ns / 1e9,
            messages=sum(log.counts.values()),
            chunks=len(log.chunks),
            topics=_topics(log, selection, duration_ns or 0, frames, ours),
            robot=selection.robot.name,
            parents=known.parents if frames is None else frames.parents(frames.channels),
            added_transform=added,
            chunks_seen=chunks_seen,
            frames=frames,
            findings=tuple(sorted(findings, key=by_severity)),
            damage=damage_of(log, (*log.losses, *(frames.losses if frames else ()))),
        )


def _with_legs(
    log: Log, selection: Selection, options: InfoOptions, findings: Sequence[Finding]
) -> list[Finding]:
    """Say that joints stand in for feet and poses that the log lacks, where they may."""
    lacking = {"NO_FEET": not selection.contacts, "NO_BASE": not selection.odometry}
    missing = {code for code, lacks in lacking.items() if lacks}
    if not missing or not joint_channels(log):
        return list(findings)
    from dogbot_logtool.robot.description import (  # noqa: PLC0415
        read_model,
        without_legs,
    )

    model = read_model(log, options.urdf)
    if model.robot is None:
        offered = any(each.command for each in findings)
        lacking_legs = without_legs(model.why_none, "" if offered else model.call)
        return [lacking_legs if each.code == "NO_FEET" else each for each in findings]
    stand_in = {"NO_FEET": "CONTACT_ESTIMATED", "NO_BASE": "BASE_FROM_LEGS"}
    kept = [each for each in findings if each.code not in missing]
    return kept + [found(stand_in[code], say="may") for code in sorted(missing)]


def _first_seconds(log: Log, selection: Selection) -> tuple[Recording, int]:
    """Return the first messages, and how many chunks they stand in."""
    used = {c.id for c in (*selection.odometry, *selection.contacts, *selection.transforms)}
    static = {channel.id for channel in selection.transforms if is_static(channel)}
    last = (log.start_time or 0) + _FIRST_NS
    chunks = [
        chunk
        for chunk in log.chunks_of(used)
        if (chunk.start_time or 0) <= last or not static.isdisjoint(chunk.counts or ())
    ]
    read = read_recording(log, selection.wanted(), 1, spans=log.grouped(chunks))
    return read.recording, len(chunks)


def _outlook(
    selection: Selection, known: KnownFrames
) -> tuple[list[Finding], tuple[str, str] | None]:
    """Return the findings, and the transform that `convert` would add.

    What forces tell, only the whole log does: `stats` says that.
    """
    findings = [*selection.findings]
    if not selection.odometry and not selection.contacts:
        return findings, None
    second = second_tf(selection, known, ConvertOptions())
    findings += [second] if second else []
    is_added = selection.has_base and second is None
    return findings, (known.world, known.base) if is_added else None


def _base_use(selection: Selection) -> str:
    """Return what the channels of the base's poses are used for."""
    base = selection.base
    if base is None or (base.source.row.name == ODOMETRY_TYPE and not base.element):
        return "odometry"
    return f"base {base.element}".rstrip()


def _side_uses(log: Log, selection: Selection) -> dict[int, str]:
    """Return what `stats` uses channels beside feet and base for, by id."""
    uses = {channel.id: "joints" for channel in joint_channels(log)}
    commands = side_topic(log, selection.robot, "commands", [])
    uses |= {channel.id: "commands" for channel in commands}
    accelerations = side_topic(log, selection.robot, "accelerations", [])
    return uses | {channel.id: "accelerometer" for channel in accelerations}


def _topics(
    log: Log,
    selection: Selection,
    duration_ns: int,
    frames: Frames | None,
    ours: AbstractSet[int],
) -> tuple[TopicInfo, ...]:
    uses = _side_uses(log, selection) | {channel.id: "frames" for channel in selection.transforms}
    uses |= dict.fromkeys(ours, "annotation")
    uses |= dict.fromkeys(frames.channels if frames else (), "frames")
    uses |= {channel.id: _base_use(selection) for channel in selection.odometry}
    for channel, feet in selection.feet_of.items():
        names = ", ".join(selection.robot.feet[foot].name for foot in feet)
        planned = "planned " if is_planned(channel) else ""
        uses[channel.id] = f"{planned}{'foot' if len(feet) == 1 else 'feet'} {names}"
    groups: dict[tuple[str, str, str], list[int]] = {}
    for channel in log.channels.values():
        key = (channel.topic, channel.type_name, channel.message_encoding)
        groups.setdefault(key, []).append(channel.id)
    return tuple(
        TopicInfo(
            topic=topic,
            type_name=type_name,
            encoding=encoding,
            messages=(count := sum(log.counts.get(number, 0) for number in ids)),
            rate_hz=mean_rate_hz(count, duration_ns),
            senders=len(ids),
            use=uses.get(ids[0], ""),
        )
        for (topic, type_name, encoding), ids in sorted(groups.items())
    )
