"""From the messages of a batch to decoded tables: all channels of one definition in one go."""

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from itertools import chain
from typing import Final, NamedTuple

import numpy as np

from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.errors import DefinitionError
from dogbot_logtool.reader.containers.log import Batch, Channel
from dogbot_logtool.reader.decode.columns import Table
from dogbot_logtool.reader.decode.decode import decode
from dogbot_logtool.reader.decode.definition import (
    Serialisation,
    Struct,
    known_definition,
    parse_definition,
)
from dogbot_logtool.reader.decode.message_layout import Layout, compile_layout
from dogbot_logtool.reader.decode.objects import OBJECT_ENCODINGS, as_ros1, object_definition
from dogbot_logtool.reader.decode.paths import Columns

SERIALISATIONS: Final[Mapping[str, Serialisation]] = {"ros1": "ros1", "cdr": "cdr"}
"""By the names of messages' encodings."""


class DecodedMessages(NamedTuple):
    """Sound messages of one definition, in file order."""

    channel: Ints
    """(n,) channel id."""
    log_time: Ints
    """(n,) ns."""
    table: Table
    """n rows."""
    malformed: Mapping[int, int]
    """Messages that could not be decoded, by channel id."""


@dataclass(frozen=True, slots=True, eq=False)
class _Decoder:
    """How the messages of a type are decoded. It is a key of caches, by its identity."""

    layout: Layout
    as_ros1: Callable[[bytes], bytes | None] | None = None
    """Writes a message as the layout's definition has it; None: it is as it stands."""


def decode_channels(
    batch: Batch, channels: Sequence[Channel], columns: Columns
) -> list[DecodedMessages]:
    """Decode some fields of all messages of some channels; a batch keeps them for the next call.

    Args:
        batch: the batch.
        channels: the channels to take.
        columns: what is read of them.

    Returns:
        one entry a definition that the batch has messages of; nearly always one.

    Raises:
        DefinitionError: a channel's messages cannot be decoded, see `described`.
    """
    wanted = (columns, *(channel.id for channel in channels))
    if wanted not in batch.decoded:
        by_decoder: dict[_Decoder, list[int]] = {}
        for channel in channels:
            by_decoder.setdefault(_decoder(without_sender(channel), columns), []).append(channel.id)
        decoded = [_decode(batch, decoder, ids) for decoder, ids in by_decoder.items()]
        batch.decoded[wanted] = [messages for messages in decoded if messages is not None]
    return list(batch.decoded[wanted])


def malformed_in(batch: Batch) -> Counter[int]:
    """Return how many messages could not be decoded, by channel id; once, however often read."""
    found: Counter[int] = Counter()
    for messages in chain.from_iterable(batch.decoded.values()):
        found |= Counter(messages.malformed)
    return found


def _decode(batch: Batch, decoder: _Decoder, ids: list[int]) -> DecodedMessages | None:
    messages = batch.messages
    rows = np.flatnonzero(np.isin(messages.channel, ids))
    if not len(rows):
        return None
    channel = messages.channel[rows]
    buffer, start, end = batch.buffer, messages.start[rows], messages.end[rows]
    if decoder.as_ros1 is not None:
        recorded = (buffer[a:b].tobytes() for a, b in zip(start, end, strict=True))
        # A single byte is no message of ROS 1.
        written = [decoder.as_ros1(payload) or b"\0" for payload in recorded]
        buffer = np.frombuffer(b"".join(written), np.uint8)
        end = np.cumsum([len(each) for each in written])
        start = np.append(0, end[:-1])
    table, sound = decode(decoder.layout, buffer, start, end)
    if sound.all():
        return DecodedMessages(channel, messages.log_time[rows], table, {})
    lost, counts = np.unique(channel[~sound], return_counts=True)
    malformed = dict(zip(lost.tolist(), counts.tolist(), strict=True))
    return DecodedMessages(channel[sound], messages.log_time[rows][sound], table, malformed)


def definition_of(channel: Channel) -> Struct:
    """Return the definition that a log of ROS has of a channel's messages.

    Raises:
        DefinitionError: there is none; the sentence does not name the topic.
    """
    if channel.message_encoding in OBJECT_ENCODINGS:
        raise DefinitionError("its messages are objects")
    return described(channel)[0]


def without_sender(channel: Channel) -> Channel:
    """Return what the channels of one definition have in common: a key of caches."""
    schema = channel.schema and channel.schema._replace(id=0)
    return replace(channel, id=0, topic="", schema=schema, metadata={})


@lru_cache(maxsize=256)
def _decoder(channel: Channel, columns: Columns) -> _Decoder:
    """Compile what decodes the messages of a channel, which has no sender.

    Raises:
        DefinitionError: they cannot be decoded.
    """
    definition, _ = _described(channel)
    encoding = channel.message_encoding
    if encoding not in OBJECT_ENCODINGS:
        return _Decoder(compile_layout(definition, SERIALISATIONS[encoding], columns))
    layout = compile_layout(definition, "ros1", columns)
    return _Decoder(layout, partial(as_ros1, channel.type_name, encoding, definition=definition))


def described(channel: Channel) -> tuple[Struct, str]:
    """Return the definition by which a channel's messages are decoded.

    Returns:
        it, and why it comes with this program and is not the log's; empty: it is the log's.

    Raises:
        DefinitionError: there is none; the sentence does not name the topic.
    """
    return _described(without_sender(channel))


@lru_cache(maxsize=256)
def _described(channel: Channel) -> tuple[Struct, str]:
    encoding, schema = channel.message_encoding, channel.schema
    if encoding in OBJECT_ENCODINGS:
        return object_definition(channel.type_name, encoding), ""
    if schema is None:
        raise DefinitionError("its messages have no type")
    if encoding not in SERIALISATIONS:
        raise DefinitionError(
            f"messages encoded as {encoding!r} are not read, only ROS 1's and CDR"
        )
    text = schema.data.decode("utf-8", "replace")
    try:
        # A definition has a line that is no comment.
        if not any(line.partition("#")[0].strip() for line in text.splitlines()):
            raise DefinitionError(f"the log has no definition of {channel.type_name}")
        return parse_definition(schema.name, text, schema.encoding), ""
    except DefinitionError as error:
        own = known_definition(schema.name, serialisation=SERIALISATIONS[encoding])
        if own is None:
            raise
        form = "ros1msg" if encoding == "ros1" else "ros2msg"
        return parse_definition(schema.name, own, form), str(error)
