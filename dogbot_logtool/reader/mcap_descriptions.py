"""The schemas and channels that a walk over an MCAP file meets."""

from typing import Final

from mcap import records
from mcap.opcode import Opcode

from dogbot_logtool.reader.log import Channel, Loss
from dogbot_logtool.reader.losses import Losses
from dogbot_logtool.reader.mcap_records import channel_of, decode_record, schema_of

_MOST_BYTES: Final = 64 << 20
"""A log that describes its channels in more words is not honest."""
_MOST_REPETITIONS: Final = 1 << 16
"""So many repetitions of what is known are compared with it; a million are not worth it."""


class Descriptions:
    """Schemas and channels by their numbers.

    Where two records of one number differ, one from a chunk whose checksum holds is chosen, else
    the first.
    """

    def __init__(self, losses: Losses) -> None:
        self._losses = losses
        self.schemas: dict[int, records.Schema] = {}
        self.channels: dict[int, records.Channel] = {}
        self._verified: set[tuple[int, int]] = set()
        self._contradictions: set[int] = set()
        self._bytes = 0
        self._repetitions = 0

    def take(self, opcode: int, body: bytes, *, verified: bool) -> bool:
        """Take a record's content.

        Args:
            opcode: ``Opcode.SCHEMA`` or ``Opcode.CHANNEL``.
            body: the content.
            verified: a checksum vouches for it.

        Returns:
            whether it is one.
        """
        known = self.schemas if opcode == Opcode.SCHEMA else self.channels
        if int.from_bytes(body[:2], "little") in known:
            self._repetitions += 1
            if self._repetitions > _MOST_REPETITIONS:
                return True
        if opcode == Opcode.SCHEMA:
            schema = decode_record(records.Schema, body)
            if schema is not None and self._replaces(
                opcode, self.schemas.get(schema.id), schema, len(body), verified=verified
            ):
                self.schemas[schema.id] = schema
            return schema is not None
        channel = decode_record(records.Channel, body)
        if channel is not None and self._replaces(
            opcode, self.channels.get(channel.id), channel, len(body), verified=verified
        ):
            self.channels[channel.id] = channel
        return channel is not None

    def _replaces(
        self,
        opcode: int,
        known: records.Schema | records.Channel | None,
        found: records.Schema | records.Channel,
        size: int,
        *,
        verified: bool,
    ) -> bool:
        key = (opcode, found.id)
        better = known is None or (verified and key not in self._verified)
        if known is not None and known != found and opcode not in self._contradictions:
            self._contradictions.add(opcode)
            kind = type(found).__name__.lower()
            what = f"{kind} {found.id} is described in two ways, of which one was chosen"
            self._losses.add(Loss(0, what))
        if better:
            self._bytes += size
            if self._bytes > _MOST_BYTES:
                return False
            if verified:
                self._verified.add(key)
        return better

    def channels_by_id(self) -> dict[int, Channel]:
        """Return the channels with their schemas."""
        schemas = {schema.id: schema_of(schema) for schema in self.schemas.values()}
        return {c.id: channel_of(c, schemas) for c in self.channels.values()}
