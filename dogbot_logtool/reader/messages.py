"""From the messages of a batch to decoded tables: all channels of one definition in one go."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.errors import DefinitionError
from dogbot_logtool.reader.columns import Table
from dogbot_logtool.reader.decode import decode
from dogbot_logtool.reader.definition import has_field, parse_definition
from dogbot_logtool.reader.layout import Layout, compile_layout
from dogbot_logtool.reader.log import Batch, Channel


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
    batch: Batch, channels: Sequence[Channel], wanted: tuple[str, ...]
) -> list[DecodedMessages]:
    """Decode the wanted fields of all messages of some channels.

    Args:
        batch: the batch.
        channels: the channels to take.
        wanted: dotted paths, see `compile_layout`.

    Returns:
        one entry a definition that the batch has messages of; nearly always one.

    Raises:
        DefinitionError: a channel's definition is not one that can be read.
    """
    by_layout: dict[int, tuple[Layout, list[int]]] = {}
    for channel in channels:
        layout = layout_of(channel, wanted)
        by_layout.setdefault(id(layout), (layout, []))[1].append(channel.id)
    decoded = [_decode(batch, layout, ids) for layout, ids in by_layout.values()]
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
    result = decode(layout, batch.buffer, messages.start[rows], messages.end[rows])
    if result.sound.all():
        return DecodedMessages(channel, messages.log_time[rows], result.table, {})
    lost, counts = np.unique(channel[~result.sound], return_counts=True)
    malformed = dict(zip(lost.tolist(), counts.tolist(), strict=True))
    sound = result.sound
    return DecodedMessages(channel[sound], messages.log_time[rows][sound], result.table, malformed)


def layout_of(channel: Channel, wanted: tuple[str, ...]) -> Layout:
    """Compile a channel's layout, once for every definition.

    Raises:
        DefinitionError: its definition or its encoding is not one that can be read.
    """
    if channel.schema is None:
        raise DefinitionError(f"{channel.topic} has no message definition")
    schema = channel.schema
    try:
        return _layout(schema.name, schema.encoding, schema.data, channel.message_encoding, wanted)
    except DefinitionError as error:
        raise DefinitionError(f"{channel.topic}: {error}") from error


@lru_cache(maxsize=64)
def _layout(
    name: str, schema_encoding: str, text: bytes, message_encoding: str, wanted: tuple[str, ...]
) -> Layout:
    definition = parse_definition(name, text.decode("utf-8", "replace"), schema_encoding)
    missing = [path for path in wanted if not has_field(definition, path)]
    if missing:
        raise DefinitionError(f"the recorded {name} has no field {missing[0]!r}")
    match message_encoding:
        case "ros1":
            return compile_layout(definition, "ros1", wanted)
        case "cdr":
            return compile_layout(definition, "cdr", wanted)
        case _:
            raise DefinitionError(f"messages encoded as {message_encoding!r} are not decoded")
