"""MCAP's small records, decoded by the mcap library."""

import struct
from io import BytesIO
from typing import Final, TypeVar

from mcap import records
from mcap.data_stream import ReadDataStream
from mcap.exceptions import EndOfFile, McapError
from mcap.opcode import Opcode
from zlib_ng.zlib_ng import crc32

from dogbot_logtool.reader.containers.descriptions import Description
from dogbot_logtool.reader.containers.log import Channel, Extra, Schema

RECORD_HEAD: Final = struct.Struct("<BQ")
"""Opcode and length of the content, before every record."""
CHUNK_HEAD: Final = struct.Struct("<QQQII")
"""Start time, end time, decompressed size, CRC, and length of the compression's name."""
WHOLE_SMALL_RECORD: Final = 16 << 20
"""Larger records that describe something are not believed to be sound."""
LARGEST_PADDING: Final = 64
"""Bytes that a record may have behind the fields that are known: later versions may add some."""
DESCRIBING: Final = frozenset({int(Opcode.SCHEMA), int(Opcode.CHANNEL)})
_MALFORMED: Final = (McapError, struct.error, ValueError, OverflowError)

_Record = TypeVar(
    "_Record",
    records.Header,
    records.Schema,
    records.Channel,
    records.Footer,
    records.Statistics,
    records.ChunkIndex,
    records.Metadata,
    records.Attachment,
    records.AttachmentIndex,
    records.MetadataIndex,
    records.SummaryOffset,
    records.DataEnd,
)


class _Stream(ReadDataStream):
    """The library's stream, but one that does not return less than asked or fail on names."""

    def read(self, length: int) -> bytes:
        data = super().read(length)
        if len(data) < length:
            raise EndOfFile
        return data

    def read_prefixed_string(self) -> str:
        return str(self.read(self.read4()), "utf-8", "replace")


def decode_record(
    kind: type[_Record], body: bytes | memoryview, padding: int = LARGEST_PADDING
) -> _Record | None:
    """Decode a record's content. Names that are no UTF-8 are mended.

    Args:
        kind: what it should be.
        body: the content.
        padding: bytes that may be left over.

    Returns:
        the record, None if it is malformed.
    """
    stream = _Stream(BytesIO(body))
    try:
        record: _Record = kind.read(stream)
    except _MALFORMED:
        return None
    return record if len(body) - stream.count <= padding else None


def described(record: bytes) -> Description | None:
    """Decode the record of a schema or a channel; None: it is malformed."""
    body = record[RECORD_HEAD.size :]
    facts: dict[str, object]
    if record[0] == Opcode.SCHEMA:
        if (schema := decode_record(records.Schema, body)) is None:
            return None
        facts = {"encoding": schema.encoding, "definition": schema.data}
        return Description("schema", schema.id, schema.name, facts)
    if (channel := decode_record(records.Channel, body)) is None:
        return None
    facts = {"encoding": channel.message_encoding, "schema": channel.schema_id}
    facts["metadata"] = channel.metadata
    return Description("channel", channel.id, channel.topic, facts)


def schema_record(schema: Schema) -> records.Schema:
    """Return the record of a schema."""
    return records.Schema(
        id=schema.id, name=schema.name, encoding=schema.encoding, data=schema.data
    )


def channel_record(channel: Channel) -> records.Channel:
    """Return the record of a channel."""
    return records.Channel(
        id=channel.id,
        topic=channel.topic,
        message_encoding=channel.message_encoding,
        metadata=dict(channel.metadata),
        schema_id=channel.schema.id if channel.schema else 0,
    )


def read_extra(extra: Extra) -> tuple[bytes, records.Attachment | records.Metadata] | None:
    """Read a record that is no message.

    Returns:
        its bytes as they stand, and decoded; None if it is damaged.
    """
    record = extra.source.read(extra.offset, extra.size)
    body = record[RECORD_HEAD.size :]
    if extra.opcode == Opcode.METADATA:
        metadata = decode_record(records.Metadata, body)
        return None if metadata is None else (record, metadata)
    attachment = decode_record(records.Attachment, body, padding=0)
    crc = int.from_bytes(record[-4:], "little")
    sound = crc in {0, crc32(body[:-4])}
    return None if attachment is None or not sound else (record, attachment)
