"""The channels that we add to an output, and their schemas."""

from collections.abc import Collection, Iterator, Mapping
from itertools import chain
from types import MappingProxyType
from typing import Final

from mcap import records

from dogbot_logtool.errors import LogtoolError
from dogbot_logtool.provenance import ANNOTATION_MARK
from dogbot_logtool.writer.encodings.encoding import MessageType
from dogbot_logtool.writer.topics import FALLBACK_PREFIX

_MAX_ID: Final = 0xFFFF


class AddedChannels:
    """Declares channels; each type of message has one schema."""

    def __init__(
        self,
        schema_ids: Collection[int] = (),
        channel_ids: Collection[int] = (),
        in_use: Mapping[str, tuple[str, str]] = MappingProxyType({}),
        notes: Mapping[str, str] = MappingProxyType({}),
    ) -> None:
        """Begin without channels.

        Args:
            schema_ids: that the log uses.
            channel_ids: likewise.
            in_use: the log's topics, each with its type, without ``/msg``, and encoding.
            notes: stand in the metadata of each channel.
        """
        self._metadata = {**ANNOTATION_MARK, **notes}
        self.schemas: list[records.Schema] = []
        self.channels: list[records.Channel] = []
        self.moved: dict[str, str] = {}
        """New names of topics that the log uses for something else."""
        self._in_use = in_use
        self._schema_ids = _free_ids(schema_ids)
        self._channel_ids = _free_ids(channel_ids)

    def declare(self, topic: str, kind: MessageType) -> int:
        """Add a channel; return its id.

        Raises:
            LogtoolError: all ids are in use.
        """
        schema = next((one for one in self.schemas if one.name == kind.name), None)
        if schema is None:
            schema = records.Schema(
                id=next(self._schema_ids),
                name=kind.name,
                encoding=kind.schema_encoding,
                data=kind.schema,
            )
            self.schemas.append(schema)
        channel = records.Channel(
            id=next(self._channel_ids),
            topic=self._free_topic(topic, kind),
            message_encoding=kind.message_encoding,
            metadata=dict(self._metadata),
            schema_id=schema.id,
        )
        self.channels.append(channel)
        return int(channel.id)

    def _free_topic(self, topic: str, kind: MessageType) -> str:
        """Return a topic that carries no other type or encoding."""
        name = topic
        ours = kind.name.replace("/msg/", "/"), kind.message_encoding
        while self._in_use.get(name, ours) != ours:
            name = self.moved[topic] = FALLBACK_PREFIX + name
        return name

    def topics(self) -> Mapping[int, str]:
        """Return the topic of every added channel."""
        return {channel.id: channel.topic for channel in self.channels}


def _free_ids(used: Collection[int]) -> Iterator[int]:
    """Yield unused schema or channel ids: those above the highest first.

    Raises:
        LogtoolError: all are in use.
    """
    highest = max(used, default=0)
    for number in chain(range(highest + 1, _MAX_ID + 1), range(1, highest)):
        if number not in used:
            yield number
    raise LogtoolError("the log uses all 65535 ids that an MCAP file can have")
