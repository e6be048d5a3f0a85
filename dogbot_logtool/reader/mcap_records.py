"""MCAP's small records, decoded by the mcap library."""

import struct
from collections.abc import Iterator
from io import BytesIO
from typing import Final, TypeVar

from mcap import records
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError

from dogbot_logtool.reader.log import Channel, Schema

MAGIC: Final = b"\x89MCAP0\r\n"
RECORD_HEAD: Final = struct.Struct("<BQ")
"""Opcode and length of the content, before every record."""
_MALFORMED: Final = (McapError, struct.error, UnicodeDecodeError, ValueError, OverflowError)

_Record = TypeVar(
    "_Record",
    records.Header,
    records.Schema,
    records.Channel,
    records.Footer,
    records.Statistics,
    records.ChunkIndex,
    records.Attachment,
    records.Metadata,
)


def decode_record(kind: type[_Record], body: bytes | memoryview) -> _Record | None:
    """Decode a record's content, None if it is malformed."""
    try:
        record: _Record = kind.read(ReadDataStream(BytesIO(body)))
    except _MALFORMED:
        return None
    return record


def records_in(section: bytes) -> Iterator[tuple[int, int, int]]:
    """Yield opcode, and first and last byte of the content, of whole records in a row."""
    place = 0
    while place + RECORD_HEAD.size <= len(section):
        opcode, length = RECORD_HEAD.unpack_from(section, place)
        place += RECORD_HEAD.size
        if length > len(section) - place:
            return
        yield opcode, place, place + length
        place += length


def schema_of(schema: records.Schema) -> Schema:
    """Convert the mcap library's schema."""
    return Schema(schema.id, schema.name, schema.encoding, schema.data)


def channel_of(channel: records.Channel, schemas: dict[int, Schema]) -> Channel:
    """Convert the mcap library's channel."""
    return Channel(
        channel.id,
        channel.topic,
        channel.message_encoding,
        schemas.get(channel.schema_id),
        channel.metadata,
    )


def read_attachment(record: bytes) -> records.Attachment | None:
    """Decode a whole attachment record, None if it is malformed."""
    return decode_record(records.Attachment, record[RECORD_HEAD.size :])


def read_metadata(record: bytes) -> records.Metadata | None:
    """Decode a whole metadata record, None if it is malformed."""
    return decode_record(records.Metadata, record[RECORD_HEAD.size :])
