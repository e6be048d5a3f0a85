"""From the messages of a batch to decoded tables: all channels of one definition in one go."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.errors import DefinitionError
from dogbot_logtool.reader.containers.batch import Batch
from dogbot_logtool.reader.containers.contents import Channel
from dogbot_logtool.reader.decode.columns import Table
from dogbot_logtool.reader.decode.decode import decode
from dogbot_logtool.reader.decode.definition import Struct, parse_definition, short_type_name
from dogbot_logtool.reader.decode.fields import Fields, check_fields, column_paths
from dogbot_logtool.reader.decode.known_definitions import known_definition
from dogbot_logtool.reader.decode.message_layout import Layout, Serialisation, compile_layout
from dogbot_logtool.reader.decode.objects import (
    OBJECT_ENCODINGS,
    check_object_type,
    decode_object,
    table_of_rows,
)

SERIALISATIONS: Final[Mapping[str, Serialisation]] = {"ros1": "ros1", "cdr": "cdr"}
"""By the names of messages' encodings."""


@dataclass(frozen=True, slots=True)
class DecodedMessages:
    """Sound messages of one definition, in file order."""

    channel: Ints
    """(n,) channel id."""
    log_time: Ints
    """(n,) ns."""
    table: Table
    """n rows."""
    malformed: Mapping[int, int]
    """Messages that could not be decoded, by channel id."""


def decode_channels(
    batch: Batch, channels: Sequence[Channel], fields: Fields
) -> list[DecodedMessages]:
    """Decode some fields of all messages of some channels; a batch keeps them for the next call.

    Args:
        batch: the batch.
        channels: the channels to take.
        fields: what is read of them.

    Returns:
        one entry a definition that the batch has messages of; nearly always one.

    Raises:
        DefinitionError: a channel's messages cannot be decoded, see `check_channel`.
    """
    wanted = (fields, *(channel.id for channel in channels))
    if wanted not in batch.decoded:
        batch.decoded[wanted] = _decoded(batch, channels, fields)
    return list(batch.decoded[wanted])


def _decoded(batch: Batch, channels: Sequence[Channel], fields: Fields) -> list[DecodedMessages]:
    by_layout: dict[int, tuple[Layout, list[int]]] = {}
    decoded: list[DecodedMessages | None] = []
    for channel in channels:
        if channel.message_encoding in OBJECT_ENCODINGS:
            decoded.append(_decode_objects(batch, channel, fields))
            continue
        layout, _ = _layout_of(channel, fields)
        by_layout.setdefault(id(layout), (layout, []))[1].append(channel.id)
    decoded += [_decode(batch, layout, ids) for layout, ids in by_layout.values()]
    return [messages for messages in decoded if messages is not None]


def malformed_in(decoded: Iterable[DecodedMessages]) -> dict[int, int]:
    """Return the number of messages that could not be decoded, by channel id.

    Args:
        decoded: messages of different channels.
    """
    return {channel: count for messages in decoded for channel, count in messages.malformed.items()}


def _decode(batch: Batch, layout: Layout, ids: list[int]) -> DecodedMessages | None:
    messages = batch.messages
    rows = np.flatnonzero(np.isin(messages.channel, ids))
    if not len(rows):
        return None
    channel = messages.channel[rows]
    table, sound = decode(layout, batch.buffer, messages.start[rows], messages.end[rows])
    if sound.all():
        return DecodedMessages(channel, messages.log_time[rows], table, {})
    lost, counts = np.unique(channel[~sound], return_counts=True)
    malformed = dict(zip(lost.tolist(), counts.tolist(), strict=True))
    return DecodedMessages(channel[sound], messages.log_time[rows][sound], table, malformed)


def _decode_objects(batch: Batch, channel: Channel, fields: Fields) -> DecodedMessages | None:
    """Decode the messages of a channel one by one."""
    messages = batch.messages
    rows = np.flatnonzero(messages.channel == channel.id)
    if not len(rows):
        return None
    kind, encoding = channel.type_name, channel.message_encoding
    payloads = (
        batch.buffer[messages.start[row] : messages.end[row]].tobytes() for row in rows.tolist()
    )
    decoded = [decode_object(kind, encoding, payload, fields) for payload in payloads]
    sound = rows[[row is not None for row in decoded]]
    table = table_of_rows([row for row in decoded if row is not None], fields)
    lost = len(rows) - len(sound)
    malformed = {channel.id: lost} if lost else {}
    return DecodedMessages(messages.channel[sound], messages.log_time[sound], table, malformed)


def check_channel(channel: Channel, fields: Fields) -> str:
    """Check that a channel's messages can be decoded, and their fields are as declared.

    Returns:
        why the definition that comes with this program is used, not the log's; empty: the log's is.

    Raises:
        DefinitionError: they cannot; the sentence does not name the topic.
    """
    if channel.message_encoding in OBJECT_ENCODINGS:
        check_object_type(channel.type_name, channel.message_encoding)
        return ""
    return _layout_of(channel, fields)[1]


def definition_of(channel: Channel) -> Struct:
    """Return the definition by which a channel's messages are decoded.

    Raises:
        DefinitionError: there is none; the sentence does not name the topic.
    """
    return _definition(*_declared(channel))[0]


def _declared(channel: Channel) -> tuple[str, str, bytes, Serialisation]:
    """Return a type's name, the definition's encoding and text, and how messages are encoded."""
    if channel.schema is None:
        raise DefinitionError("its messages have no type")
    schema, encoding = channel.schema, channel.message_encoding
    if encoding not in SERIALISATIONS:
        raise DefinitionError(
            f"messages encoded as {encoding!r} are not read, only ROS 1's and CDR"
        )
    return schema.name, schema.encoding, schema.data, SERIALISATIONS[encoding]


def _layout_of(channel: Channel, fields: Fields) -> tuple[Layout, str]:
    """Return what decodes a channel's messages, and why it is not the log's definition.

    Raises:
        DefinitionError: they cannot be decoded.
    """
    found = _compiled(_declared(channel), fields)
    if isinstance(found, str):
        raise DefinitionError(found)
    return found


@lru_cache(maxsize=256)
def _compiled(
    declared: tuple[str, str, bytes, Serialisation], fields: Fields
) -> tuple[Layout, str] | str:
    """Compile a layout once for every definition; why it cannot be compiled is remembered, too."""
    try:
        definition, own_because = _definition(*declared)
        check_fields(definition, fields, short_type_name(declared[0]))
    except DefinitionError as error:
        return str(error)
    return compile_layout(definition, declared[-1], column_paths(fields)), own_because


def _definition(
    name: str, schema_encoding: str, data: bytes, serialisation: Serialisation
) -> tuple[Struct, str]:
    """Return a type's definition: the log's, else our own and why."""
    text = data.decode("utf-8", "replace")
    try:
        # A definition has a line that is no comment.
        if not any(line.partition("#")[0].strip() for line in text.splitlines()):
            raise DefinitionError(f"the log has no definition of {short_type_name(name)}")
        return parse_definition(name, text, schema_encoding), ""
    except DefinitionError as error:
        own = known_definition(name, serialisation=serialisation)
        if own is None:
            raise
        encoding = "ros1msg" if serialisation == "ros1" else "ros2msg"
        return parse_definition(name, own, encoding), str(error)
