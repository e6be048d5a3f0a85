"""Topics beside feet and base: joint states, commands, accelerometers."""

from collections.abc import Callable
from typing import Final

from dogbot_logtool.finding import Finding
from dogbot_logtool.io.printable import listed
from dogbot_logtool.reader.containers.log import Channel, Log
from dogbot_logtool.reader.messages.message_type import Part
from dogbot_logtool.reader.messages.others import JOINT_TYPES
from dogbot_logtool.reader.messages.table import types_of
from dogbot_logtool.reader.part import WantedVectors
from dogbot_logtool.robot.robot import Robot
from dogbot_logtool.robot.topics import (
    is_readable,
    message_count,
    readable_topics,
    require_topic,
    topic_words,
)

_TYPES: Final = frozenset((*types_of("commands"), *types_of("accelerations")))
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
_NO_STATES: Final = ("command", "cmd", "desired", "target", "goal", "reference", "foot")
"""Words in topics whose joint states are no positions of joints."""
_MOST_CHANNELS: Final = 16


def joint_channels(log: Log) -> list[Channel]:
    """Return the first channels of joints' measured states: best type, then shortest topic."""
    found = [
        channel
        for channel in log.channels.values()
        if is_readable(channel, "joints") and log.counts.get(channel.id, 1)
        if not any(word in channel.topic.lower() for word in _NO_STATES)
    ]
    found.sort(key=lambda each: (JOINT_TYPES.index(each.type_name), len(each.topic), each.topic))
    return found[:_MOST_CHANNELS]


Side = tuple[WantedVectors | None, WantedVectors | None, tuple[Finding, ...]]
"""Velocity commands, accelerations, and which of several topics they are."""


def side_topics(log: Log, robot: Robot) -> Side:
    """Choose the topics of velocity commands and of the base's inertial unit.

    Raises:
        CallError: the robot names a topic that the log does not have, or one of a wrong type.
        LogError: the robot names a topic that cannot be decoded.
    """
    asked = robot.command_topic, robot.imu_topic
    if not any(asked) and not any(c.type_name in _TYPES for c in log.channels.values()):
        return None, None, ()
    commands = _ranked(log, "commands", _command_rank, asked[0], "command_topic")
    inertial = _ranked(log, "accelerations", _inertial_rank, asked[1], "imu_topic")
    findings = []
    for topic, found, what, option in (
        (asked[0], commands, "velocity commands", "command_topic"),
        (asked[1], inertial, "the base's accelerations", "imu_topic"),
    ):
        if found and topic is None:
            others = [each.topic for each in found[1:]]
            text = f"{what} are taken from {found[0].topic}, found by type and name"
            text += f"; there are also {listed(others)} (--set {option} chooses)" if others else ""
            findings.append(Finding("TOPICS_CHOSEN", text, found[0].topic))
    return next(iter(commands), None), next(iter(inertial), None), tuple(findings)


def _command_rank(topic: str) -> tuple[int, ...] | None:
    """Return how likely a topic's twists are commands, low first; None: they are none."""
    words = topic_words(topic)
    if not words.isdisjoint(_MEASURED):
        return None
    rank = next((row for row, sure in enumerate(_COMMANDS) if words & sure), None)
    last = topic.rpartition("/")[2]
    return None if rank is None else (rank, int(last != "cmd_vel"))


def _inertial_rank(topic: str) -> tuple[int, ...] | None:
    """Return how likely a topic is of the base's inertial unit, low first; None: it is not."""
    words = topic_words(topic)
    if not words.isdisjoint(_ELSEWHERE):
        return None
    return (int("raw" in words),)


def _ranked(
    log: Log, part: Part, rank: Rank, asked: str | None, option: str
) -> list[WantedVectors]:
    """Return the topics that may be meant, the best first; the one that is asked for alone.

    Of equally good ones that of the better type comes first, then that with the most messages.
    """
    if asked is not None:
        require_topic(log, option, asked, part)
        return [_wanted(log, asked, part)]
    found: dict[tuple[tuple[int, ...], int, int, int, str], WantedVectors] = {}
    for topic in readable_topics(log, part):
        if (order := rank(topic)) is not None:
            wanted = _wanted(log, topic, part)
            kind = types_of(part).index(wanted.channels[0].type_name)
            found[order, kind, -message_count(log, topic), len(topic), topic] = wanted
    return [found[key] for key in sorted(found)]


def _wanted(log: Log, topic: str, part: Part) -> WantedVectors:
    """Return the channels of a topic that can be decoded, all of one type."""
    readable = [each for each in log.channels_by_topic[topic] if is_readable(each, part)]
    best = min(types_of(part).index(channel.type_name) for channel in readable)
    own = (channel for channel in readable if channel.type_name == types_of(part)[best])
    return WantedVectors(topic, tuple(own), part)
