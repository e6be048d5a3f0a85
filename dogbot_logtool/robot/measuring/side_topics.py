"""Topics beside feet and base that `stats` compares with them: commands, accelerometers."""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Final

from dogbot_logtool.errors import CallError, DefinitionError, LogError
from dogbot_logtool.finding import Finding
from dogbot_logtool.io.printable import listed
from dogbot_logtool.io.storage import shown
from dogbot_logtool.reader.containers.log import Channel, Log
from dogbot_logtool.reader.messages.message_type import MessageType
from dogbot_logtool.reader.messages.vectors import (
    COMMANDS,
    INERTIAL_UNITS,
    check_vectors,
)
from dogbot_logtool.reader.wanted import WantedVectors
from dogbot_logtool.robot.robot import Robot

_ROWS: Final = {**COMMANDS, **INERTIAL_UNITS}
Rank = Callable[[str], "tuple[int, ...] | None"]
"""Returns how likely a topic is meant, low first; None: it is not."""
_MEASURED: Final = frozenset(
    {"odom", "odometry", "measured", "actual", "current", "feedback", "estimate", "estimated"}
    | {"estimator", "state", "est", "meas", "real", "gt", "truth", "groundtruth"}
)
"""Words of topics whose twists are no commands."""
_COMMANDS: Final = (
    frozenset({"cmd"}),
    frozenset({"command", "commands", "commanded", "cmds"}),
    frozenset({"desired", "des", "target", "setpoint", "reference", "ref", "teleop", "joy"}),
)
"""Words of topics whose twists are commands, the surest first."""
_ELSEWHERE: Final = frozenset(
    {"foot", "feet", "leg", "wrist", "hand", "arm", "head", "camera", "cam", "gripper", "phone"}
    | {"d435i", "d455", "t265", "realsense", "zed", "lidar", "livox", "ouster", "velodyne"}
)
"""Words of topics of inertial units that are not the base's."""


@dataclass(frozen=True, slots=True)
class SideTopics:
    """Topics beside feet and base."""

    commands: WantedVectors | None
    inertial: WantedVectors | None
    findings: tuple[Finding, ...]
    """Which of several topics they are."""


def side_topics(log: Log, robot: Robot) -> SideTopics:
    """Choose the topics of velocity commands and of the base's inertial unit.

    Raises:
        CallError: the robot names a topic that the log does not have, or one of a wrong type.
        LogError: the robot names a topic that cannot be decoded.
    """
    asked = robot.command_topic, robot.imu_topic
    if not any(asked) and not any(c.type_name in _ROWS for c in log.channels.values()):
        return SideTopics(None, None, ())
    findings: list[Finding] = []
    found: list[WantedVectors | None] = []
    for topic, rows, rank, what, option in (
        (asked[0], COMMANDS, _command_rank, "velocity commands", "command_topic"),
        (asked[1], INERTIAL_UNITS, _inertial_rank, "the base's accelerations", "imu_topic"),
    ):
        if topic is not None:
            found.append(_named(log, topic, rows, option))
            continue
        ranked = _ranked(log, rows, rank)
        found.append(ranked[0] if ranked else None)
        if ranked:
            others = [each.topic for each in ranked[1:]]
            text = f"{what} are taken from {ranked[0].topic}, found by type and name"
            text += f"; there are also {listed(others)} (--set {option} chooses)" if others else ""
            findings.append(Finding("TOPICS_CHOSEN", text, ranked[0].topic))
    return SideTopics(found[0], found[1], tuple(findings))


def _words(topic: str) -> frozenset[str]:
    return frozenset(re.findall(r"[a-z0-9]+", topic.lower()))


def _command_rank(topic: str) -> tuple[int, ...] | None:
    """Return how likely a topic's twists are commands, low first; None: they are none."""
    words = _words(topic)
    if not words.isdisjoint(_MEASURED):
        return None
    rank = next((row for row, sure in enumerate(_COMMANDS) if words & sure), None)
    last = topic.rpartition("/")[2]
    return None if rank is None else (rank, int(last != "cmd_vel"))


def _inertial_rank(topic: str) -> tuple[int, ...] | None:
    """Return how likely a topic is of the base's inertial unit, low first; None: it is not."""
    words = _words(topic)
    if not words.isdisjoint(_ELSEWHERE):
        return None
    return (int("raw" in words),)


def _ranked(log: Log, rows: Mapping[str, MessageType], rank: Rank) -> list[WantedVectors]:
    """Return the topics of some types that may be meant, the best first.

    Of equally good ones that of the better type comes first, then that with the most messages.
    """
    found: dict[tuple[tuple[int, ...], int, int, int, str], WantedVectors] = {}
    for topic in {c.topic for c in log.channels.values() if c.type_name in rows}:
        readable = _readable(log, topic, rows)
        order = rank(topic)
        if readable and order is not None:
            kind = list(rows).index(readable[0].type_name)
            count = sum(log.counts.get(channel.id, 0) for channel in readable)
            key = (order, kind, -count, len(topic), topic)
            found[key] = WantedVectors(topic, readable, rows)
    return [found[key] for key in sorted(found)]


def _readable(log: Log, topic: str, rows: Mapping[str, MessageType]) -> tuple[Channel, ...]:
    """Return the channels of a topic that can be decoded, all of one type."""
    channels = log.channels_by_topic.get(topic, ())
    for type_name in rows:
        found = [c for c in channels if c.type_name == type_name and not _unreadable(c, rows)]
        if found:
            return tuple(found)
    return ()


def _unreadable(channel: Channel, rows: Mapping[str, MessageType]) -> str:
    """Return why a channel's messages cannot be decoded; empty if they can be."""
    try:
        check_vectors(channel, rows)
    except DefinitionError as reason:
        return str(reason)
    return ""


def _named(log: Log, topic: str, rows: Mapping[str, MessageType], option: str) -> WantedVectors:
    """Return the topic that the user names."""
    where = f"{shown(log.source.path)}: {option}"
    channels = [c for c in log.channels_by_topic.get(topic, ()) if c.type_name in rows]
    readable = _readable(log, topic, rows)
    if readable:
        return WantedVectors(topic, readable, rows)
    if channels:
        raise LogError(f"{where}: {topic} cannot be read: {_unreadable(channels[0], rows)}")
    usable = sorted({c.topic for c in log.channels.values() if c.type_name in rows})
    is_there = topic in log.channels_by_topic
    problem = "is of another type" if is_there else "is not in the log"
    raise CallError(
        f"{where}: {topic} {problem}. Topics that can be used: {listed(usable) or 'none'}"
    )
