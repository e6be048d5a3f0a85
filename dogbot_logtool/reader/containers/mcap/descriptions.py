"""The schemas and channels of an MCAP file, and those that contradict them.

The format wants all records of one id to be identical. Where they differ, the data is believed
before the summary, and what a checksum covers before what none does.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from enum import IntEnum
from typing import Final

from mcap import records
from mcap.opcode import Opcode
from zlib_ng.zlib_ng import crc32

from dogbot_logtool.core.arrays import Bytes, Ints
from dogbot_logtool.reader.containers.contents import Channel, Schema
from dogbot_logtool.reader.containers.loss import LONGEST_NAME, Loss, described_twice
from dogbot_logtool.reader.containers.mcap.records import RECORD_HEAD, decode_record

_MOST_BYTES: Final = 64 << 20
"""A log that describes its channels in more words is not honest."""
_MOST_VARIANTS: Final = 1 << 16
"""So many records that differ from those known are decoded; a million are not worth it."""
DESCRIBING: Final = (int(Opcode.SCHEMA), int(Opcode.CHANNEL))

_Description = records.Schema | records.Channel
_Key = tuple[int, int]
"""Opcode and id."""


class Trust(IntEnum):
    """How far a description is believed."""

    SUMMARY = 0
    DATA = 1
    VERIFIED = 2
    """It stands in a chunk whose checksum holds."""


@dataclass(frozen=True, slots=True)
class _Described:
    record: _Description
    trust: Trust
    offset: int


class Descriptions:
    """Schemas and channels by their ids, as a walk over the file meets them.

    Of records that differ, the first one of those believed most is chosen.
    """

    def __init__(self) -> None:
        self.channels: dict[int, records.Channel] = {}
        self._chosen: dict[_Key, _Described] = {}
        self._other: dict[_Key, _Described] = {}
        """One of those that differ from the chosen one."""
        self._repeated: set[tuple[int, int, Trust]] = set()
        """Opcode, hash and trust of the records met so far."""
        self._agreed: set[tuple[int, int]] = set()
        """Opcode and hash of records that agreed later: most are repeated as they are."""
        self._bytes = 0

    def add(self, opcode: int, body: bytes, offset: int, trust: Trust) -> bool:
        """Add a record; tell whether it is well-formed.

        Args:
            opcode: ``Opcode.SCHEMA`` or ``Opcode.CHANNEL``.
            body: its content.
            offset: byte in the file, of the chunk if it stands in one.
            trust: how far it is believed.
        """
        key, digest = (opcode, int.from_bytes(body[:2], "little")), (opcode, hash(body), trust)
        known = self._chosen.get(key)
        full = known is not None and len(self._repeated) > _MOST_VARIANTS
        if full or digest in self._repeated:
            return True
        record = _decoded(opcode, body)
        if record is None:
            return False
        self._repeated.add(digest)
        found = _Described(record, trust, offset)
        if known is None or trust > known.trust:
            self._bytes += len(body)
            if self._bytes > _MOST_BYTES:
                return True
            self._chosen[key] = found
            if isinstance(record, records.Channel):
                self.channels[record.id] = record
            if known is not None and known.record != record:
                self._other[key] = known
        elif known.record != record:
            self._other.setdefault(key, found)
        return True

    def channels_by_id(self) -> dict[int, Channel]:
        """Return the channels with their schemas."""
        schemas = {
            one.id: Schema(one.id, one.name, one.encoding, one.data)
            for one in (each.record for each in self._chosen.values())
            if isinstance(one, records.Schema)
        }
        return {
            c.id: Channel(c.id, c.topic, c.message_encoding, schemas.get(c.schema_id), c.metadata)
            for c in self.channels.values()
        }

    def without_schema(self) -> Iterator[Loss]:
        """Yield what to say of channels whose schema is nowhere described."""
        for each in self._chosen.values():
            channel = each.record
            if not isinstance(channel, records.Channel) or not channel.schema_id:
                continue
            if (Opcode.SCHEMA, channel.schema_id) not in self._chosen:
                what = f"schema {channel.schema_id} of {channel.topic[:LONGEST_NAME]}"
                what += " is nowhere described: its messages can be copied, but not read"
                yield Loss(each.offset, what)

    def contradictions(self) -> Iterator[Loss]:
        """Yield what to say of ids that are described in two ways."""
        for key, other in sorted(self._other.items(), key=lambda item: item[0]):
            yield _contradiction(self._chosen[key].record, other.record, other.offset)

    def contradictions_in(self, data: Bytes, others: Ints, offset: int) -> list[Loss]:
        """Compare the records of a chunk with what is known; say it once for each id.

        Args:
            data: (n,) uint8, the decompressed chunk.
            others: see `ChunkContent.others`.
            offset: of the chunk.
        """
        found: dict[_Key, Loss] = {}
        for opcode, start, end in others.tolist():
            if opcode not in DESCRIBING:
                continue
            body = data[start + RECORD_HEAD.size : end].tobytes()
            digest = opcode, hash(body)
            if digest in self._agreed:
                continue
            record = _decoded(opcode, body)
            known = None if record is None else self._chosen.get((opcode, record.id))
            if record is None or known is None or known.record == record:
                self._agreed.add(digest)
            else:
                loss = _contradiction(known.record, record, offset)
                found.setdefault((opcode, record.id), loss)
        return list(found.values())


def _decoded(opcode: int, body: bytes) -> _Description | None:
    """Decode the content of a schema or channel record, None if it is malformed."""
    if opcode == Opcode.SCHEMA:
        return decode_record(records.Schema, body)
    return decode_record(records.Channel, body)


def _contradiction(chosen: _Description, other: _Description, offset: int) -> Loss:
    """Say that two records of one id differ.

    Args:
        chosen: the one that is believed.
        other: the other one.
        offset: where that one stands.
    """
    kind = "channel" if isinstance(chosen, records.Channel) else "schema"
    (one, facts), (two, others) = _facts(chosen), _facts(other)
    if one == two:
        key = next(key for key, value in facts.items() if value != others[key])
        one += f" with {key} {_shown(facts[key])}"
        two += f" with {key} {_shown(others[key])}"
    return described_twice(f"{kind} {chosen.id}", one, two, offset)


def _facts(record: _Description) -> tuple[str, dict[str, object]]:
    """Return the name that a record has, and all that it says besides its id and its name."""
    if isinstance(record, records.Channel):
        facts = {"schema": record.schema_id, "metadata": record.metadata}
        return record.topic, {"encoding": record.message_encoding, **facts}
    return record.name, {"encoding": record.encoding, "definition": record.data}


def _shown(value: object) -> str:
    if isinstance(value, bytes):
        return f"{crc32(value):08x} ({len(value)} bytes)"
    return str(value)
