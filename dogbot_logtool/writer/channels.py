"""The channels that we add to an output, and their schemas."""

from collections.abc import Collection, Iterator, Mapping
from typing import Final

from mcap import records

from dogbot_logtool.errors import LogtoolError
from dogbot_logtool.mcap_layout import ANNOTATION_MARK
from dogbot_logtool.writer.encodings.encoding import MessageType
from dogbot_logtool.writer.topics import FALLBACK_PREFIX

_MAX_ID: Final = 0xFFFF


def added_channels(
    types: Mapping[str, MessageType],
    schema_ids: Collection[int],
    channel_ids: Collection[int],
    in_use: Mapping[str, tuple[str, str]],
) -> tuple[list[records.Schema], dict[str, records.Channel]]:
    """Return the schemas, one for each type of message, and the channels by topic.

    A channel has another topic where the log uses its own for something else.

    Args:
        types: of messages, by topic.
        schema_ids: that the log uses.
        channel_ids: likewise.
        in_use: the log's topics, each with its type, without ``/msg``, and encoding.

    Raises:
        LogtoolError: all ids are in use.
    """
    free_schemas, free_channels = _free_ids(schema_ids), _free_ids(channel_ids)
    schemas: dict[str, records.Schema] = {}
    channels: dict[str, records.Channel] = {}
    for topic, kind in types.items():
        if kind.name not in schemas:
            schemas[kind.name] = records.Schema(
                id=next(free_schemas),
                name=kind.name,
                encoding=kind.schema_encoding,
                data=kind.schema,
            )
        channels[topic] = records.Channel(
            id=next(free_channels),
            topic=_free_topic(topic, kind, in_use),
            message_encoding=kind.message_encoding,
            metadata=ANNOTATION_MARK,
            schema_id=schemas[kind.name].id,
        )
    return list(schemas.values()), channels


def _free_topic(topic: str, kind: MessageType, in_use: Mapping[str, tuple[str, str]]) -> str:
    """Return a topic that carries no other type or encoding."""
    ours = kind.name.replace("/msg/", "/"), kind.message_encoding
    while in_use.get(topic, ours) != ours:
        topic = FALLBACK_PREFIX + topic
    return topic


def _free_ids(used: Collection[int]) -> Iterator[int]:
    """Yield unused schema or channel ids.

    Raises:
        LogtoolError: all are in use.
    """
    yield from (number for number in range(1, _MAX_ID + 1) if number not in used)
    raise LogtoolError("the log uses all 65535 ids that an MCAP file can have")
