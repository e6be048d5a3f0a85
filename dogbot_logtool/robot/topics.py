"""Topics of a log by the names that users write, and those that are used beside feet and base."""

from collections.abc import Container, Iterable, Iterator
from itertools import islice
from typing import Final

from dogbot_logtool.errors import CallError, DefinitionError, LogError
from dogbot_logtool.finding import Finding
from dogbot_logtool.io.printable import listed
from dogbot_logtool.io.storage import name_of
from dogbot_logtool.reader.containers.log import Channel, Log
from dogbot_logtool.reader.decode.paths import Columns
from dogbot_logtool.reader.foot import Foot
from dogbot_logtool.reader.messages.contacts import foot_source
from dogbot_logtool.reader.messages.message_type import Part
from dogbot_logtool.reader.messages.messages import DecodedMessages, decode_channels
from dogbot_logtool.reader.messages.others import JOINT_TYPES
from dogbot_logtool.reader.messages.source import Source, source_of
from dogbot_logtool.reader.messages.table import types_of
from dogbot_logtool.reader.part import WantedVectors
from dogbot_logtool.robot.robot import Robot
from dogbot_logtool.robot.words import texts_of, word_set

_COMPARED: Final = 2000
"""Topics that a wrong name is compared with."""
_SPAN_NS: Final = 5_000_000_000
"""ns of a log in which a robot has named all of its feet and frames."""
_MOST_CHUNKS: Final = 64
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


def message_count(log: Log, topic: str) -> int:
    """Return how many messages of a topic the index counts."""
    return sum(log.counts.get(channel.id, 0) for channel in log.channels_by_topic.get(topic, ()))


def most_frequent(log: Log, topics: Iterable[str]) -> str:
    """Return the topic with the most messages; of several, the one with the shortest name."""
    return max(topics, key=lambda topic: (message_count(log, topic), -len(topic), topic))


def readable_source(channel: Channel, part: Part) -> Source | None:
    """Return how a part of a channel's messages is read; None: it is not told, or faulty."""
    source = source_of(channel, part)
    return None if source is None or source.fault else source


def sources_of(log: Log, topic: str, part: Part) -> list[Source]:
    """Return how a part of a topic's messages is read; faulty ones are left out."""
    channels = log.channels_by_topic.get(topic, ())
    return [source for channel in channels if (source := readable_source(channel, part))]


def readable_topics(log: Log, part: Part) -> list[str]:
    """Return the topics that tell of a part and can be decoded, sorted."""
    return sorted(topic for topic in log.channels_by_topic if sources_of(log, topic, part))


def first_messages(log: Log, channel: Channel, columns: Columns) -> Iterator[DecodedMessages]:
    """Decode the messages of a channel's first seconds, which tell names, wherever they stand."""
    end: int | None = None
    for chunk in islice(log.chunks_of({channel.id}), _MOST_CHUNKS):
        if end is not None and chunk.start_time is not None and chunk.start_time > end:
            return
        batch = log.read((chunk,))
        time = batch.messages.log_time[batch.messages.channel == channel.id]
        if len(time):
            end = int(time.min()) + _SPAN_NS if end is None else end
            yield from decode_channels(batch.cropped(None, end), [channel], columns)


def has_field(channel: Channel, foot: Foot) -> bool:
    """Tell whether a foot is a field of a channel's messages."""
    try:
        named = channel.topic == foot.topic and foot.field is not None
        return named and foot_source(channel, [foot]) is not None
    except DefinitionError:
        return False


def split_topic(name: str, topics: Container[str]) -> tuple[str, str]:
    """Split ``/topic:field`` into the topic and what is named in its messages; empty: nothing is.

    Args:
        name: what the user wrote.
        topics: those of the log, whose names may have colons.
    """
    topic, _, field = name.partition(":")
    return (name, "") if name in topics else (topic, field)


def require_topic(
    log: Log, option: str, topic: str, part: Part | None, otherwise: str = ""
) -> None:
    """Check that the topic of an option is in the log, and of a type that can be used.

    Args:
        log: the log.
        option: the option, as sentences name it.
        topic: its topic.
        part: what its messages must tell of; None: any will do.
        otherwise: what can be done with a topic of another type.

    Raises:
        CallError: it is not; with the topics that could be meant.
        LogError: it is, but cannot be decoded.
    """
    channels = log.channels_by_topic.get(topic, ())
    where = f"{name_of(log.source.path)}: {option}"
    sources = [source for c in channels if part and (source := source_of(c, part))]
    if sources and all(source.fault for source in sources):
        raise LogError(f"{where}: {topic} cannot be read: {sources[0].fault}")
    if sources or (channels and part is None):
        return
    usable = readable_topics(log, part) if part else sorted(log.channels_by_topic)
    can_be_used = f"Topics that can be used: {listed(usable) or 'none'}"
    if channels:
        found = ", ".join(sorted({channel.type_name for channel in channels}))
        raise CallError(
            f"{where}: {topic} is of type {found}, which does not fit. {can_be_used}"
            f"{otherwise and '. '}{otherwise}"
        )
    from difflib import get_close_matches  # noqa: PLC0415 - for wrong calls only

    # The slash at the beginning is forgotten most often.
    close = [one for one in usable if one.strip("/") == topic.strip("/")]
    close = close or get_close_matches(topic, usable[:_COMPARED], n=3)
    meant = f"; did you mean {' or '.join(close)}?" if close else "."
    raise CallError(f"{where}: the log has no topic {topic}{meant} {can_be_used}")


def is_planned(channel: Channel) -> bool:
    """Tell whether a channel's messages tell what was planned, not what was measured."""
    source = source_of(channel, "feet")
    return source is not None and source.row.is_planned(channel.topic)


# --- beside feet and base -----------------------------------------------------------------------


def joint_channels(log: Log) -> list[Channel]:
    """Return the first channels of joints' measured states: best type, then shortest topic."""
    found = [
        channel
        for channel in log.channels.values()
        if readable_source(channel, "joints") and log.counts.get(channel.id, 1)
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
    readable = [each for each in log.channels_by_topic[topic] if readable_source(each, part)]
    best = min((channel.type_name for channel in readable), key=types_of(part).index)
    return WantedVectors(topic, tuple(c for c in readable if c.type_name == best), part)
