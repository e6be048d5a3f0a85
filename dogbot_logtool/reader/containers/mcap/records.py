"""MCAP's records: small ones decoded by the mcap library, messages by their columns."""

import re
import struct
import sys
from collections.abc import Callable
from io import BytesIO
from typing import Final, TypeVar

import numpy as np
from mcap import records
from mcap.data_stream import ReadDataStream
from mcap.exceptions import EndOfFile, McapError
from mcap.opcode import Opcode
from zlib_ng.zlib_ng import crc32

from dogbot_logtool.core.arrays import Bytes, Ints
from dogbot_logtool.mcap_layout import MESSAGE_HEAD, RECORD_HEAD
from dogbot_logtool.reader.containers.descriptions import Description
from dogbot_logtool.reader.containers.log import Channel, Chunk, Extra, Schema
from dogbot_logtool.reader.containers.loss import Loss
from dogbot_logtool.reader.containers.record_log import UnusableIndex
from dogbot_logtool.reader.containers.registry import MCAP_MAGIC
from dogbot_logtool.reader.containers.salvage import Read, Records
from dogbot_logtool.reader.containers.source import ByteSource
from dogbot_logtool.reader.decode.columns import gather

FOOTER_SIZE: Final = RECORD_HEAD.size + 20
_DATA_END_SIZE: Final = RECORD_HEAD.size + 4
_PIECE: Final = 1 << 20
DAMAGED_SUMMARY: Final = "the summary is damaged or wrong; the log was read without it"
CHUNK_HEAD: Final = struct.Struct("<QQQII")
"""Start time, end time, decompressed size, CRC, and length of the compression's name."""
_LONGEST_NAME: Final = 16
"""Bytes of the name of a compression."""
CHUNK_HEAD_SIZE: Final = RECORD_HEAD.size + CHUNK_HEAD.size + _LONGEST_NAME + 8
"""Bytes in which a chunk's header ends."""
WHOLE_SMALL_RECORD: Final = 16 << 20
"""Larger records that describe something are not believed to be sound."""
LARGEST_PADDING: Final = 64
"""Bytes that a record may have behind the fields that are known: later versions may add some."""
_MALFORMED: Final = (McapError, struct.error, ValueError, OverflowError)

_Record = TypeVar("_Record", bound=records.McapRecord)
_MESSAGE_COLUMNS: Final = ("channel", "log_time", "publish_time", "sequence")
MESSAGE_CONTENT_SIZE: Final = 22
"""Bytes of a message record's content before its payload."""
FIRST_PRIVATE_OPCODE: Final = 0x80
"""Opcodes from here on belong to applications, and are passed over."""
_MOST_FOLLOWING: Final = 2
"""Records that are looked at to be sure of the one before them."""
LARGEST_OPCODE: Final = int(max(Opcode))
_HEAD: Final = np.dtype([("opcode", "u1"), ("length", "<u8")])
_MAY_STAND_IN_CHUNK: Final = np.arange(256) > LARGEST_OPCODE
"""(256,) by opcode; of those that are known, only three."""
_MAY_STAND_IN_CHUNK[[Opcode.SCHEMA, Opcode.CHANNEL, Opcode.MESSAGE]] = True
_KINDS: Final[dict[int, type[records.McapRecord]]] = {
    opcode: getattr(records, opcode.name.title().replace("_", "")) for opcode in Opcode
}
"""The mcap library's record of each opcode, such as `ChunkIndex` of CHUNK_INDEX."""


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
        record: _Record = kind.read(stream)  # type: ignore[attr-defined]  # the base alone has none
    except _MALFORMED:
        return None
    return record if len(body) - stream.count <= padding else None


def described(record: bytes) -> Description | None:
    """Decode the record of a schema or a channel; None: it is malformed."""
    kind = records.Schema if record[0] == Opcode.SCHEMA else records.Channel
    match found := decode_record(kind, record[RECORD_HEAD.size :]):
        case records.Schema():
            return Description("schema", found.id, found.name, found)
        case records.Channel():
            return Description("channel", found.id, found.topic, found)
    return None


def schema_record(schema: Schema) -> records.Schema:
    """Return the record of a schema."""
    return records.Schema(**schema._asdict())


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


class McapFormat:
    """How MCAP writes records; see `RecordFormat`."""

    message = int(Opcode.MESSAGE)
    describing = frozenset({int(Opcode.SCHEMA), int(Opcode.CHANNEL)})
    record_start = re.compile(rb"(?s)(?=[\x01-\x0f].{4}\0{4})")
    """Every known opcode, with a length below 4 GiB."""

    def __init__(self, may_be_channel: Callable[[int], bool]) -> None:
        """Prepare.

        Args:
            may_be_channel: tells whether a channel is described; a message of another is not
                taken for a sound one when looking for the next sound record.
        """
        self._may_be_channel = may_be_channel

    def chain(self, data: memoryview, offset: int, end: int, limit: int) -> list[int]:
        """See `RecordFormat.chain`."""
        bounds = [offset]
        unpack, last = RECORD_HEAD.unpack_from, end - RECORD_HEAD.size
        while offset <= last and limit:
            opcode, length = unpack(data, offset)
            if not opcode or length > last - offset:
                break
            offset += length + RECORD_HEAD.size
            bounds.append(offset)
            limit -= 1
        return bounds

    def decode(self, records: Bytes, offset: Ints) -> Records:
        """See `RecordFormat.decode`."""
        op, end = 0 * offset, offset.copy()
        if len(offset) and offset[0] >= 0 and offset[-1] <= len(records) - RECORD_HEAD.size:
            lengths = gather(records, offset, RECORD_HEAD.size).view(_HEAD)
            # Lengths beyond the buffer stay too large, but become no negative numbers.
            length = np.minimum(lengths["length"], np.uint64(len(records))).astype(np.int64)
            end = offset + RECORD_HEAD.size + length
            op = lengths["opcode"].astype(np.int64)
            is_short = (op == Opcode.MESSAGE) & (length < MESSAGE_CONTENT_SIZE)
            op[is_short | (end > len(records)) | ~_MAY_STAND_IN_CHUNK[op]] = 0
        rows = np.flatnonzero(op == Opcode.MESSAGE)
        size = MESSAGE_HEAD.itemsize
        start, head = offset + size, np.zeros(0, MESSAGE_HEAD)
        if len(rows):
            head = gather(records, offset[rows], size).view(MESSAGE_HEAD)
        if len(rows) < len(op):
            of_messages, head = head, np.zeros(len(op), MESSAGE_HEAD)
            head[rows] = of_messages
            start = offset + np.where(op == Opcode.MESSAGE, size, RECORD_HEAD.size)
        channel, log_time, publish_time, sequence = (
            head[name].astype(np.int64) for name in _MESSAGE_COLUMNS
        )
        return Records(channel, log_time, publish_time, sequence, start, end, op, offset)

    def sound(self, read: Read, offset: int, end: int) -> bool:
        """See `RecordFormat.sound`."""
        return self._sound(read, offset, end, _MOST_FOLLOWING)

    def _sound(self, read: Read, offset: int, end: int, more: int) -> bool:
        """Check a record and, as its own structure may say little, some that follow it."""
        head = read(offset, min(CHUNK_HEAD_SIZE, end - offset))
        if len(head) < RECORD_HEAD.size:
            # The end of the file cuts it off, or it is the end of a chunk.
            return not head or 1 <= head[0] <= LARGEST_OPCODE or MCAP_MAGIC.startswith(head)
        opcode, length = RECORD_HEAD.unpack_from(head)
        if opcode == Opcode.CHUNK:
            return is_chunk(head)
        following = offset + RECORD_HEAD.size + length
        is_known = opcode in _KINDS
        may_be_later = opcode > LARGEST_OPCODE and following < end
        if following > end or not (is_known or may_be_later):
            # A following record that the end cuts off says nothing against those before it.
            return is_known and more < _MOST_FOLLOWING
        if opcode == Opcode.FOOTER:
            return read(following, len(MCAP_MAGIC)) == MCAP_MAGIC
        content = offset + RECORD_HEAD.size
        if is_known and self.content(read, content, opcode, length) is None:
            return False
        # Of a kind that only later versions have, what follows is all that can be looked at.
        return (is_known and (following == end or not more)) or (
            more > 0 and self._sound(read, following, end, more - 1)
        )

    def content(
        self, read: Read, start: int, opcode: int, length: int
    ) -> records.McapRecord | bool | None:
        """Decode a record's content.

        Args:
            read: reads the bytes.
            start: where the content begins.
            opcode: of the record.
            length: of the content, which is known to be there.

        Returns:
            what is in it; True for the kinds that are not decoded; None where the content is not
            what its opcode says.
        """
        if opcode == Opcode.MESSAGE:
            channel = int.from_bytes(read(start, 2), "little")
            is_message = length >= MESSAGE_CONTENT_SIZE and self._may_be_channel(channel)
            return is_message or None
        if opcode in {Opcode.MESSAGE_INDEX, Opcode.ATTACHMENT}:
            padding = length - _content_size(read, start, opcode)
            return 0 <= padding <= LARGEST_PADDING or None
        kind = _KINDS.get(opcode)
        if kind is None or length > WHOLE_SMALL_RECORD:
            return None
        return decode_record(kind, read(start, length))


def _content_size(read: Read, content: int, opcode: int) -> int:
    """Return how long a message index or an attachment is by what it says itself."""
    if opcode == Opcode.MESSAGE_INDEX:
        entries = int.from_bytes(read(content + 2, 4), "little")
        # Such that it is not as long as it is, if the entries are not whole.
        return 6 + entries if entries % 16 == 0 else 1 << 64
    size = 16
    for _ in ("name", "media type"):
        size += 4 + int.from_bytes(read(content + size, 4), "little")
    return size + 8 + int.from_bytes(read(content + size, 8), "little") + 4


def chunk_at(offset: int, head: bytes) -> Chunk | None:
    """Read a chunk record's own header, whose two lengths may disagree.

    Args:
        offset: where the record begins.
        head: its first bytes.

    Returns:
        the chunk; None if the header makes no sense.
    """
    name_start = RECORD_HEAD.size + CHUNK_HEAD.size
    if len(head) < name_start + 8:
        return None
    _, length = RECORD_HEAD.unpack_from(head)
    start, end, size, crc, name_size = CHUNK_HEAD.unpack_from(head, RECORD_HEAD.size)
    name = head[name_start : name_start + name_size]
    data_start = name_start + name_size + 8
    is_name = name_size <= _LONGEST_NAME and (not name or name.isalnum())
    record_size = RECORD_HEAD.size + length
    if not is_name or data_start > min(len(head), record_size):
        return None
    (data_size,) = struct.unpack_from("<Q", head, data_start - 8)
    return Chunk(
        offset=offset,
        data_offset=offset + data_start,
        data_size=data_size,
        end=offset + record_size,
        index_end=offset + record_size,
        compression=str(name, "utf-8", "replace"),
        size=size,
        crc=crc,
        start_time=start,
        end_time=end,
    )


def is_chunk(head: bytes) -> bool:
    """Tell whether a chunk record begins here, by the agreement of its lengths."""
    chunk = chunk_at(0, head)
    return chunk is not None and chunk.data_offset + chunk.data_size <= chunk.end


# The summary section, and the checksum over the data


def read_footer(source: ByteSource) -> records.Footer:
    """Read the footer of a file with a summary whose checksum, if it has one, holds.

    Raises:
        UnusableIndex: there is none that can be trusted.
    """
    offset = source.size - len(MCAP_MAGIC) - FOOTER_SIZE
    tail = source.read(offset, FOOTER_SIZE + len(MCAP_MAGIC))
    if len(tail) < FOOTER_SIZE + len(MCAP_MAGIC) or not tail.endswith(MCAP_MAGIC):
        what = "the file has no end mark: its recording was cut off"
        raise UnusableIndex(Loss(source.size, what))
    opcode, length = RECORD_HEAD.unpack_from(tail)
    footer = decode_record(records.Footer, tail[RECORD_HEAD.size : FOOTER_SIZE])
    if opcode != Opcode.FOOTER or length != FOOTER_SIZE - RECORD_HEAD.size or footer is None:
        raise UnusableIndex(Loss(offset, DAMAGED_SUMMARY))
    start = footer.summary_start
    crc = _checksum(source, start or offset, offset + FOOTER_SIZE - 4) if footer.summary_crc else 0
    if crc != footer.summary_crc:
        raise UnusableIndex(Loss(start, DAMAGED_SUMMARY))
    if not start:
        raise UnusableIndex
    return footer


def indexed_chunk(index: records.ChunkIndex) -> Chunk:
    """Return the chunk that an index describes."""
    start = index.chunk_start_offset
    end = start + index.chunk_length
    index_end = end + index.message_index_length
    counts = None
    if index.message_index_offsets:
        # Each message index record is 15 bytes and 16 for every message.
        offsets = sorted((at, channel) for channel, at in index.message_index_offsets.items())
        ends = [*(at for at, _ in offsets[1:]), index_end]
        counts = {
            channel: max(behind - at - 15, 0) // 16
            for (at, channel), behind in zip(offsets, ends, strict=True)
        }
    head = RECORD_HEAD.size + CHUNK_HEAD.size + len(index.compression.encode()) + 8
    return Chunk(
        offset=start,
        data_offset=start + head,
        data_size=index.compressed_size,
        end=end,
        index_end=index_end,
        compression=sys.intern(index.compression),
        size=index.uncompressed_size,
        start_time=index.message_start_time,
        end_time=index.message_end_time,
        counts=counts,
    )


def check_data(source: ByteSource, data_end: int, *, thorough: bool) -> Loss | None:
    """Verify the data section's checksum, if there is one.

    It covers what chunks' checksums do not: the header, messages outside chunks, attachments and
    metadata.

    Args:
        source: the file.
        data_end: where the DataEnd record begins.
        thorough: read a data section that is not cheap to read, too.
    """
    record = source.read(data_end, _DATA_END_SIZE)
    if len(record) < _DATA_END_SIZE or (data_end > source.cheap_size and not thorough):
        return None
    opcode, length = RECORD_HEAD.unpack_from(record)
    (expected,) = struct.unpack_from("<I", record, RECORD_HEAD.size)
    if opcode != Opcode.DATA_END or length < 4 or not expected:
        return None
    if _checksum(source, 0, data_end) == expected:
        return None
    return Loss(data_end, "the checksum over all of the log's data does not hold")


def _checksum(source: ByteSource, start: int, end: int) -> int:
    """Return the CRC-32 of some of the file's bytes."""
    crc = 0
    for offset in range(start, end, _PIECE):
        crc = crc32(source.read(offset, min(_PIECE, end - offset)), crc)
    return crc
