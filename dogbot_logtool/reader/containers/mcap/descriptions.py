"""The schemas and channels of an MCAP file, and those that contradict them.

The format wants all records of one id to be identical. Where they differ, the data is believed
before the summary, and what a checksum covers before what none does.
"""

from collections.abc import Iterator, Mapping
from enum import IntEnum
from typing import Final

from mcap import records
from mcap.opcode import Opcode
from zlib_ng.zlib_ng import crc32

from dogbot_logtool.core.arrays import Bytes, Ints
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.reader.containers.contents import Channel
from dogbot_logtool.reader.containers.loss import LONGEST_NAME, Loss, described_twice
from dogbot_logtool.reader.containers.mcap.records import (
    RECORD_HEAD,
    channel_of,
    channel_record,
    decode_record,
    schema_of,
    schema_record,
)

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
        self._bytes = 0

    def add(self, opcode: int, body: bytes, offset: int, trust: Trust) -> None:
        """Add a record; what is malformed is ignored.

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
            return
        self._repeated.add(digest)
        record = decode_description(opcode, body)
        if record is None:
            return
        found = _Described(record, trust, offset)
        if known is None or trust > known.trust:
            self._bytes += len(body)
            if self._bytes > _MOST_BYTES:
                return
            self._chosen[key] = found
            if isinstance(record, records.Channel):
                self.channels[record.id] = record
            if known is not None and known.record != record:
                self._other[key] = known
        elif known.record != record:
            self._other.setdefault(key, found)

    def channels_by_id(self) -> dict[int, Channel]:
        """Return the channels with their schemas."""
        schemas = {
            each.record.id: schema_of(each.record)
            for each in self._chosen.values()
            if isinstance(each.record, records.Schema)
        }
        return {c.id: channel_of(c, schemas) for c in self.channels.values()}

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
            yield contradiction(self._chosen[key].record, other.record, other.offset)


class DescriptionCheck:
    """Compares the schemas and channels in chunks with those by which the log is read."""

    def __init__(self, channels: Mapping[int, Channel]) -> None:
        self._known: dict[_Key, _Description] = {}
        for channel in channels.values():
            self._known[Opcode.CHANNEL, channel.id] = channel_record(channel)
            if channel.schema is not None:
                schema = schema_record(channel.schema)
                self._known[Opcode.SCHEMA, schema.id] = schema
        self._agreed: dict[tuple[int, bytes], int] = {}
        """Hash of the last record that agreed, by opcode and id: most are repeated as they are."""

    def contradictions(self, data: Bytes, others: Ints, offset: int) -> list[Loss]:
        """Compare the records of a chunk.

        Args:
            data: (n,) uint8, the decompressed chunk.
            others: see `ChunkContent.others`.
            offset: of the chunk.

        Returns:
            what to say, once for each id.
        """
        found: dict[_Key, Loss] = {}
        for opcode, start, end in others.tolist():
            if opcode in DESCRIBING:
                body = data[start + RECORD_HEAD.size : end].tobytes()
                record = self._differing(opcode, body)
                if record is not None:
                    key = opcode, record.id
                    found.setdefault(key, contradiction(self._known[key], record, offset))
        return list(found.values())

    def agrees(self, opcode: int, body: bytes) -> bool:
        """Tell whether a record agrees with what is known of its id, if anything is."""
        return self._differing(opcode, body) is None

    def _differing(self, opcode: int, body: bytes) -> _Description | None:
        """Return the record if it contradicts what is known."""
        key, digest = (opcode, body[:2]), hash(body)
        if self._agreed.get(key) == digest:
            return None
        record = decode_description(opcode, body)
        known = None if record is None else self._known.get((opcode, record.id))
        if record is None or known is None or known == record:
            self._agreed[key] = digest
            return None
        return record


def decode_description(opcode: int, body: bytes) -> _Description | None:
    """Decode the content of a schema or channel record, None if it is malformed."""
    if opcode == Opcode.SCHEMA:
        return decode_record(records.Schema, body)
    return decode_record(records.Channel, body)


def _facts(record: _Description) -> dict[str, object]:
    """Return all that a record says besides its id and its name."""
    if isinstance(record, records.Channel):
        return {
            "encoding": record.message_encoding,
            "schema": record.schema_id,
            "metadata": record.metadata,
        }
    return {"encoding": record.encoding, "definition": record.data}


def _name(record: _Description) -> str:
    return record.topic if isinstance(record, records.Channel) else record.name


def contradiction(chosen: _Description, other: _Description, offset: int) -> Loss:
    """Say that two records of one id differ.

    Args:
        chosen: the one that is believed.
        other: the other one.
        offset: where that one stands.
    """
    kind = "channel" if isinstance(chosen, records.Channel) else "schema"
    texts = [_name(chosen), _name(other)]
    if texts[0] == texts[1]:
        facts = zip(_facts(chosen).items(), _facts(other).values(), strict=True)
        key, values = next((key, (one, two)) for (key, one), two in facts if one != two)
        texts = [
            f"{text} with {key} {_shown(value)}" for text, value in zip(texts, values, strict=True)
        ]
    return described_twice(f"{kind} {chosen.id}", texts[0], texts[1], offset)


def _shown(value: object) -> str:
    if isinstance(value, bytes):
        return f"{crc32(value):08x} ({len(value)} bytes)"
    return str(value)
