"""Topics of a log by the names that users write, and those that are used beside feet and base."""

from collections.abc import Container, Iterable, Iterator
from itertools import islice
from typing import Final, NamedTuple

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
_NO_STATES: Final = frozenset[str]().union(*_COMMANDS, {"goal", "foot"})
"""Words in topics whose joint states are no positions of joints."""
_MOST_CHANNELS: Final = 16


class Topic(NamedTuple):
    """A topic that tells of a part of a walk, and how its messages are read."""

    name: str
    source: Source
    channels: tuple[Channel, ...]
    """All of one definition."""


def message_count(log: Log, topic: str) -> int:
    """Return how many messages of a topic the index counts."""
    return sum(log.counts.get(channel.id, 0) for channel in log.channels_by_topic.get(topic, ()))


def readable_source(channel: Channel, part: Part) -> Source | None:
    """Return how a part of a channel's messages is read; None: it is not told, or faulty."""
    source = source_of(channel, part)
    return None if source is None or source.fault else source


def topics_of(log: Log, part: Part) -> list[Topic]:
    """Return the topics that tell of a part and can be decoded, the best first.

    These are of the better type, then those with the most messages, then with a shorter name.
    """
    order = types_of(part)
    found: dict[tuple[int, str], list[tuple[Channel, Source]]] = {}
    for channel in log.channels.values():
        if source := readable_source(channel, part):
            key = order.index(source.row.name), channel.topic
            found.setdefault(key, []).append((channel, source))
    topics = [
        Topic(name, told[0][1], tuple(c for c, like in told if like.columns == told[0][1].columns))
        for (_, name), told in found.items()
    ]

    def rank(topic: Topic) -> tuple[int, int, int, str]:
        better = order.index(topic.source.row.name), -message_count(log, topic.name)
        return *better, len(topic.name), topic.name

    return sorted(topics, key=rank)


def names_of(log: Log, part: Part) -> list[str]:
    """Return the names of the topics that tell of a part and can be decoded, sorted."""
    return sorted({each.name for each in topics_of(log, part)})


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
    usable = names_of(log, part) if part else sorted(log.channels_by_topic)
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
    """Return the first channels of joints' measured states, those that name joints first."""
    topics = sorted(topics_of(log, "joints"), key=lambda each: not each.source.row.joint)
    found = [
        channel
        for topic in topics
        for channel in topic.channels
        if log.counts.get(channel.id, 1) and not texts_of(topic.name) & _NO_STATES
    ]
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
        every = topics_of(log, part)
        named = [each for each in every if each.name == asked]
        topics = _likely(every, part) if asked is None else named
        chosen.append(WantedVectors(topics[0].name, topics[0].channels, part) if topics else None)
        if topics and asked is None:
            best, *others = [each.name for each in topics]
            text = f"{what} are taken from {best}, found by type and name"
            text += f"; there are also {listed(others)} (--set {option} chooses)" if others else ""
            findings.append(Finding("TOPICS_CHOSEN", text, best))
    commands, accelerations = chosen
    return commands, accelerations, tuple(findings)


def _likely(topics: Iterable[Topic], part: Part) -> list[Topic]:
    """Return the topics that are named like commands, or the base's inertial unit, best first."""
    ranked: list[tuple[int, Topic]] = []
    for topic in topics:
        words = texts_of(topic.name)
        if part == "accelerations":
            ranks = [] if words & _ELSEWHERE else [int("raw" in words)]
        else:
            is_other = topic.name.rpartition("/")[2] != "cmd_vel"
            ranks = [2 * row + is_other for row, sure in enumerate(_COMMANDS) if words & sure]
            ranks = [] if words & _MEASURED else ranks
        ranked += [(rank, topic) for rank in ranks[:1]]
    return [topic for _, topic in sorted(ranked, key=lambda each: each[0])]
