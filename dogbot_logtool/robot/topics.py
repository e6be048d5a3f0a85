"""Topics of a log by the names that users write, and what is said of those that cannot be read."""

import re
from collections.abc import Container, Iterable, Iterator
from itertools import islice
from typing import Final

from dogbot_logtool.errors import CallError, DefinitionError, LogError
from dogbot_logtool.io.printable import listed
from dogbot_logtool.io.storage import name_of
from dogbot_logtool.reader.containers.log import Batch, Channel, Log
from dogbot_logtool.reader.decode.paths import Columns
from dogbot_logtool.reader.foot import Foot
from dogbot_logtool.reader.messages.contacts import foot_source
from dogbot_logtool.reader.messages.message_type import Part
from dogbot_logtool.reader.messages.messages import DecodedMessages, decode_channels
from dogbot_logtool.reader.messages.source import Source, source_of

_COMPARED: Final = 2000
"""Topics that a wrong name is compared with."""
_SPAN_NS: Final = 5_000_000_000
"""ns of a log in which a robot has named all of its feet and frames."""
_MOST_CHUNKS: Final = 64


def message_count(log: Log, topic: str) -> int:
    """Return how many messages of a topic the index counts."""
    return sum(log.counts.get(channel.id, 0) for channel in log.channels_by_topic.get(topic, ()))


def most_frequent(log: Log, topics: Iterable[str]) -> str:
    """Return the topic with the most messages; of several, the one with the shortest name."""
    return max(topics, key=lambda topic: (message_count(log, topic), -len(topic), topic))


def is_readable(channel: Channel, part: Part) -> bool:
    """Tell whether a part of a channel's messages is told and can be decoded."""
    source = source_of(channel, part)
    return source is not None and not source.fault


def sources_of(log: Log, topic: str, part: Part) -> list[Source]:
    """Return how a part of a topic's messages is read; faulty ones are left out."""
    sources = [source_of(channel, part) for channel in log.channels_by_topic.get(topic, ())]
    return [source for source in sources if source and not source.fault]


def readable_topics(log: Log, part: Part) -> list[str]:
    """Return the topics that tell of a part and can be decoded, sorted."""
    return sorted(topic for topic in log.channels_by_topic if sources_of(log, topic, part))


def first_batches(log: Log, channel: Channel) -> Iterator[Batch]:
    """Yield the messages of a channel's first seconds, which tell names, wherever they stand."""
    end: int | None = None
    for chunk in islice(log.chunks_of({channel.id}), _MOST_CHUNKS):
        if end is not None and chunk.start_time is not None and chunk.start_time > end:
            return
        batch = log.read((chunk,))
        time = batch.messages.log_time[batch.messages.channel == channel.id]
        if len(time):
            end = int(time.min()) + _SPAN_NS if end is None else end
            yield batch.cropped(None, end)


def first_messages(log: Log, channel: Channel, columns: Columns) -> Iterator[DecodedMessages]:
    """Decode the messages of a channel's first seconds."""
    for batch in first_batches(log, channel):
        yield from decode_channels(batch, [channel], columns)


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
    if name in topics:
        return name, ""
    colons = [match.start() for match in re.finditer(":", name)]
    known = (colon for colon in colons if name[:colon] in topics)
    colon = next(known, colons[0] if colons else len(name))
    return name[:colon], name[colon + 1 :]


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
