"""The connections of a ROS 1 bag, as channels."""

from typing import Final

from dogbot_logtool.reader.containers.bag.records import Fields, MalformedRecord, record_at
from dogbot_logtool.reader.containers.contents import Channel, Schema
from dogbot_logtool.reader.containers.loss import Loss, described_twice

_MOST_CONNECTIONS: Final = 1 << 16
_MOST_BYTES: Final = 64 << 20
"""A bag that describes more connections, or in more words, is not honest."""


class Connections:
    """The bag's connections as channels, numbered from 1 in the order in which they are met."""

    def __init__(self) -> None:
        self.channels: dict[int, Channel] = {}
        self.channel_ids: dict[int, int] = {}
        """Channel id by connection number."""
        self._schemas: dict[tuple[str, str], Schema] = {}
        self._bytes = 0

    def add(self, record: bytes) -> None:
        """Take a connection record; one that is known already changes nothing.

        Raises:
            MalformedRecord: it does not describe a connection.
        """
        connection = record_at(record, 0, len(record)).fields.u32("conn")
        if connection in self.channel_ids:
            return
        self._bytes += len(record)
        if len(self.channels) >= _MOST_CONNECTIONS or self._bytes > _MOST_BYTES:
            raise MalformedRecord("it describes too many connections")
        number = len(self.channels) + 1
        self.channels[number] = _channel(number, record, self._schemas)
        self.channel_ids[connection] = number

    def contradiction(self, record: bytes, offset: int) -> Loss | None:
        """Compare a connection record with what is known of the connection.

        Args:
            record: the whole record.
            offset: of the chunk that holds it.

        Returns:
            what to say if they differ.
        """
        try:
            connection = record_at(record, 0, len(record)).fields.u32("conn")
            number = self.channel_ids.get(connection)
            if number is None:
                return None
            described = _channel(number, record, {})
        except MalformedRecord as fault:
            what = f"a connection's description in the chunk at byte {offset} is damaged ({fault})"
            return Loss(offset, what)
        known = self.channels[number]
        if _facts(described) == _facts(known):
            return None
        one, other = (f"{each.topic} of type {each.type_name}" for each in (known, described))
        if one == other:
            other += " with another definition or header"
        return described_twice(f"connection {connection}", one, other, offset)


def _facts(channel: Channel) -> tuple[object, ...]:
    """Return what a record says; schemas are numbered as they are met."""
    schema = channel.schema
    return channel.topic, channel.metadata, schema and (schema.name, schema.data)


def _channel(number: int, record: bytes, schemas: dict[tuple[str, str], Schema]) -> Channel:
    """Build a channel from a connection record.

    Args:
        number: the channel's id.
        record: its data is the header that the publisher sent when it connected.
        schemas: those met so far, by type and definition; a new one is added.

    Raises:
        MalformedRecord: the type is missing.
    """
    found = record_at(record, 0, len(record))
    texts = Fields(record[found.data : found.end]).texts()
    name, definition = texts.pop("type", ""), texts.pop("message_definition", "")
    if not name:
        raise MalformedRecord("a connection has no type")
    texts.pop("topic", None)
    # The topic of the record is the one under which it was recorded, after any remapping.
    topic = found.fields.raw("topic").decode("utf-8", "replace")
    new = Schema(len(schemas) + 1, name, "ros1msg", definition.encode())
    return Channel(number, topic, "ros1", schemas.setdefault((name, definition), new), texts)
