"""`dogbot-logtool info`: what is in a log, what will be used, and what is wrong with it."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from dogbot_logtool.evidence import Evidence, look_into
from dogbot_logtool.findings import Finding
from dogbot_logtool.plan import ConvertOptions, evidence_findings, make_plan
from dogbot_logtool.reader.log import Log, Loss
from dogbot_logtool.reader.opening import open_log
from dogbot_logtool.selection import Selection, TopicOptions, select_topics


@dataclass(frozen=True, slots=True)
class TopicInfo:
    """One topic as one type and encoding."""

    topic: str
    type_name: str
    encoding: str
    messages: int
    rate_hz: float | None
    """Messages a second over the log's duration; None for a log of no duration."""
    senders: int
    use: str
    """What it is used for: ``odometry``, ``foot front_left``, ``frames``, or nothing."""


@dataclass(frozen=True, slots=True)
class LogInfo:
    """What a log holds."""

    path: Path
    size: int
    """Bytes."""
    container: str
    profile: str
    compressions: tuple[str, ...]
    start_time: int | None
    """ns, log time of the first message; None for an empty log."""
    duration_s: float | None
    messages: int
    chunks: int
    topics: tuple[TopicInfo, ...]
    robot: str
    parents: Mapping[str, frozenset[str]]
    """Parents of each frame, by the log's own transforms in the chunks that were looked at."""
    added_transform: tuple[str, str] | None
    """Parent and child of the transform that `convert` adds."""
    chunks_seen: int
    """Chunks that were looked at for frames and stamps; the rest was not read."""
    findings: tuple[Finding, ...]
    losses: tuple[Loss, ...]

    @property
    def exit_code(self) -> int:
        """0: sound; 3: damaged."""
        return 3 if self.losses else 0


def describe(path: Path, options: TopicOptions) -> LogInfo:
    """Look at a log: its index, and a few chunks for what an index does not tell.

    Raises:
        CallError: no such file, or a topic in the options that the log does not have.
        LogError: it is no log.
    """
    log = open_log(path)
    try:
        selection = select_topics(log, options)
        evidence = look_into(log, selection)
        findings, added = _outlook(log, selection, evidence)
        duration = None
        if log.start_time is not None and log.end_time is not None:
            duration = (log.end_time - log.start_time) / 1e9
        return LogInfo(
            path=path,
            size=log.source.size,
            container=log.container,
            profile=log.profile,
            compressions=log.compressions,
            start_time=log.start_time,
            duration_s=duration,
            messages=sum(log.counts.values()),
            chunks=len(log.chunks),
            topics=_topics(log, selection, duration),
            robot=selection.robot.name,
            parents=evidence.parents,
            added_transform=added,
            chunks_seen=evidence.chunks_seen,
            findings=tuple(sorted(findings)),
            losses=tuple(log.losses),
        )
    finally:
        log.close()


def _outlook(
    log: Log, selection: Selection, evidence: Evidence
) -> tuple[list[Finding], tuple[str, str] | None]:
    """Return the findings, and the transform that `convert` would add."""
    if not selection.odometry and not selection.contacts:
        return [*selection.findings, *evidence_findings(selection, evidence)], None
    plan = make_plan(log, selection, evidence, ConvertOptions())
    added = (plan.world_frame, plan.base_frame) if plan.write_tf else None
    return list(plan.findings), added


def _topics(log: Log, selection: Selection, duration_s: float | None) -> tuple[TopicInfo, ...]:
    uses = {channel.id: "odometry" for channel in selection.odometry}
    uses |= {channel.id: "frames" for channel in selection.transforms}
    for number, feet in selection.feet_of.items():
        names = ", ".join(selection.robot.feet[foot].name for foot in feet)
        uses[number] = f"{'foot' if len(feet) == 1 else 'feet'} {names}"
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
            rate_hz=count / duration_s if duration_s else None,
            senders=len(ids),
            use=uses.get(ids[0], ""),
        )
        for (topic, type_name, encoding), ids in sorted(groups.items())
    )
