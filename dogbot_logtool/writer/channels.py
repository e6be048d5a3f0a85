"""The channels that we add to an output, and their schemas."""

from collections.abc import Callable, Mapping
from collections.abc import Set as AbstractSet
from types import MappingProxyType
from typing import Final

from mcap import records

from dogbot_logtool.errors import LogtoolError
from dogbot_logtool.provenance import ANNOTATION_MARK
from dogbot_logtool.writer.encodings.encoding import MessageType

_MAX_ID: Final = 0xFFFF

ResolveTopic = Callable[[str, MessageType], str]
"""Returns the topic under which messages of a type are written."""


class IdSource:
    """Unused schema or channel ids: those above the input's highest first."""

    def __init__(self, used: AbstractSet[int]) -> None:
        self._used = used
        highest = max(used, default=0)
        self._candidates = iter(range(highest + 1, _MAX_ID + 1)), iter(range(1, highest))

    def take(self) -> int:
        """Return a free id.

        Raises:
            LogtoolError: all are in use.
        """
        for candidates in self._candidates:
            for number in candidates:
                if number not in self._used:
                    return number
        raise LogtoolError("the log uses all 65535 ids that an MCAP file can have")


class AddedChannels:
    """Declares channels; each type of message has one schema."""

    def __init__(
        self,
        schema_ids: IdSource,
        channel_ids: IdSource,
        resolve_topic: ResolveTopic,
        notes: Mapping[str, str] = MappingProxyType({}),
    ) -> None:
        """Begin without channels; notes stand in the metadata of each."""
        self._metadata = {**ANNOTATION_MARK, **notes}
        self.schemas: list[records.Schema] = []
        self.channels: list[records.Channel] = []
        self._schema_ids = schema_ids
        self._channel_ids = channel_ids
        self._resolve = resolve_topic

    def declare(self, topic: str, kind: MessageType) -> int:
        """Add a channel; return its id.

        Raises:
            LogtoolError: all ids are in use.
        """
        schema = next((one for one in self.schemas if one.name == kind.name), None)
        if schema is None:
            schema = records.Schema(
                id=self._schema_ids.take(),
                name=kind.name,
                encoding=kind.schema_encoding,
                data=kind.schema,
            )
            self.schemas.append(schema)
        channel = records.Channel(
            id=self._channel_ids.take(),
            topic=self._resolve(topic, kind),
            message_encoding=kind.message_encoding,
            metadata=dict(self._metadata),
            schema_id=schema.id,
        )
        self.channels.append(channel)
        return int(channel.id)

    def topics(self) -> Mapping[int, str]:
        """Return the topic of every added channel."""
        return {channel.id: channel.topic for channel in self.channels}
