"""Topics beside feet and base: joint states, commands, accelerometers."""

from typing import Final

from dogbot_logtool.finding import Finding
from dogbot_logtool.io.printable import listed
from dogbot_logtool.reader.containers.log import Channel, Log
from dogbot_logtool.reader.messages.message_type import Part
from dogbot_logtool.reader.messages.others import JOINT_TYPES
from dogbot_logtool.reader.messages.table import types_of
from dogbot_logtool.reader.part import WantedVectors
from dogbot_logtool.robot.robot import Robot
from dogbot_logtool.robot.topics import is_readable, message_count, readable_topics, require_topic
from dogbot_logtool.robot.words import texts_of, word_set

_MEASURED: Final = word_set(
    "odom odometry measured actual current feedback estimate estimated estimator state est meas "
    "real gt truth groundtruth"
)
"""Words of topics whose twists are no commands."""
_COMMANDS: Final = (
    word_set("cmd"),
    word_set("command commands commanded cmds"),
    word_set("desired des target setpoint reference ref teleop joy"),
)
"""Words of topics whose twists are commands, the surest first."""
_ELSEWHERE: Final = word_set(
    "foot feet leg wrist hand arm head camera cam gripper phone 435 455 265 realsense zed lidar "
    "livox ouster velodyne"
)
"""Words of topics of inertial units that are not the base's; numbers are those of cameras."""
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


def side_topics(
    log: Log, robot: Robot
) -> tuple[WantedVectors | None, WantedVectors | None, tuple[Finding, ...]]:
    """Choose the topics of velocity commands and of the base's inertial unit.

    Returns:
        velocity commands, accelerations, and which of several topics they are.

    Raises:
        CallError: the robot names a topic that the log does not have, or one of a wrong type.
        LogError: the robot names a topic that cannot be decoded.
    """
    chosen: list[WantedVectors | None] = []
    findings = []
    parts: tuple[tuple[Part, str, str | None, str], ...] = (
        ("commands", "command_topic", robot.command_topic, "velocity commands"),
        ("accelerations", "imu_topic", robot.imu_topic, "the base's accelerations"),
    )
    for part, option, asked, what in parts:
        if asked is not None:
            require_topic(log, option, asked, part)
        topics = _ranked(log, part) if asked is None else [asked]
        chosen.append(_wanted(log, topics[0], part) if topics else None)
        if topics and asked is None:
            text, others = f"{what} are taken from {topics[0]}, found by type and name", topics[1:]
            text += f"; there are also {listed(others)} (--set {option} chooses)" if others else ""
            findings.append(Finding("TOPICS_CHOSEN", text, topics[0]))
    commands, accelerations = chosen
    return commands, accelerations, tuple(findings)


def _ranked(log: Log, part: Part) -> list[str]:
    """Return the topics that may be meant, the best first.

    Of equally good ones that of the better type comes first, then that with the most messages.
    """
    found = []
    for topic in readable_topics(log, part):
        rank = _command_rank(topic) if part == "commands" else _inertial_rank(topic)
        if rank is not None:
            kind = types_of(part).index(_wanted(log, topic, part).channels[0].type_name)
            found.append((rank, kind, -message_count(log, topic), len(topic), topic))
    return [topic for *_, topic in sorted(found)]


def _command_rank(topic: str) -> int | None:
    """Return how likely a topic's twists are commands, low first; None: they are none."""
    words = texts_of(topic)
    ranks = [row for row, sure in enumerate(_COMMANDS) if words & sure]
    is_other = topic.rpartition("/")[2] != "cmd_vel"
    return 2 * ranks[0] + is_other if ranks and not words & _MEASURED else None


def _inertial_rank(topic: str) -> int | None:
    """Return how likely a topic is of the base's inertial unit, low first; None: it is not."""
    words = texts_of(topic)
    return None if words & _ELSEWHERE else int("raw" in words)


def _wanted(log: Log, topic: str, part: Part) -> WantedVectors:
    """Return the channels of a topic that can be decoded, all of one type."""
    readable = [each for each in log.channels_by_topic[topic] if is_readable(each, part)]
    best = min((channel.type_name for channel in readable), key=types_of(part).index)
    return WantedVectors(topic, tuple(c for c in readable if c.type_name == best), part)
