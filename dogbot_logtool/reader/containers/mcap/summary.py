"""The summary section of an MCAP file, if it is complete and not damaged."""

import struct
import sys
from collections import Counter
from collections.abc import Sequence
from dataclasses import field
from typing import Final

from mcap import records
from mcap.opcode import Opcode
from zlib_ng.zlib_ng import crc32

from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.reader.containers.chunks.records import Heads
from dogbot_logtool.reader.containers.contents import Chunk, Contents, Extra, Schema, SharedCounts
from dogbot_logtool.reader.containers.loss import Loss
from dogbot_logtool.reader.containers.mcap.descriptions import DESCRIBING, DescriptionCheck
from dogbot_logtool.reader.containers.mcap.records import (
    CHUNK_HEAD,
    RECORD_HEAD,
    WHOLE_SMALL_RECORD,
    channel_of,
    decode_record,
    schema_of,
)
from dogbot_logtool.reader.containers.signatures import MCAP_MAGIC
from dogbot_logtool.reader.containers.sources.source import ByteSource

_FOOTER_SIZE: Final = RECORD_HEAD.size + 20
_LARGEST_TIME: Final = 2**63 - 1
_UNSUSPICIOUS_SIZE: Final = 64 << 20
_LARGEST_SHARE: Final = 4
"""A larger summary than `_UNSUSPICIOUS_SIZE` must not be more than this part of the file."""
SUMMARY_CONTRADICTS: Final = (
    "the summary contradicts itself or the chunks; the log was read without it"
)
_MOST_RECORDS_BETWEEN: Final = 100_000
_BETWEEN: Final = (
    Opcode.HEADER,
    Opcode.SCHEMA,
    Opcode.CHANNEL,
    Opcode.MESSAGE_INDEX,
    Opcode.ATTACHMENT,
    Opcode.METADATA,
    Opcode.DATA_END,
)
"""Record types that may stand between the chunks without the summary's naming them."""

DATA_END_SIZE: Final = RECORD_HEAD.size + 4
_PIECE: Final = 1 << 20


def read_summary(source: ByteSource) -> tuple[Contents | None, Loss | None]:
    """Read the summary section.

    Returns:
        the contents, or None where the summary is absent, damaged or incomplete; and the
        damage, if any.
    """
    summary, problem = _read_section(source)
    if summary is None:
        return None, problem
    if not _is_complete(summary):
        return None, None
    contents = _contents(source, summary)
    if contents is None:
        return None, Loss(summary.offset, SUMMARY_CONTRADICTS)
    return contents, None


@dataclass(slots=True)
class _Summary:
    source: ByteSource
    offset: int
    verified: bool
    """Its checksum holds."""
    statistics: records.Statistics | None = None
    schemas: dict[int, Schema] = field(default_factory=dict)
    channels: dict[int, records.Channel] = field(default_factory=dict)
    chunks: list[Chunk] = field(default_factory=list)
    extras: list[Extra] = field(default_factory=list)
    counts: SharedCounts = field(default_factory=SharedCounts)
    contradicts_itself: bool = False
    """It describes an id in two ways."""


def _read_section(source: ByteSource) -> tuple[_Summary | None, Loss | None]:
    """Read the summary section; a loss says why there is none that can be trusted."""
    footer_offset = source.size - len(MCAP_MAGIC) - _FOOTER_SIZE
    tail = source.read(footer_offset, _FOOTER_SIZE + len(MCAP_MAGIC))
    if len(tail) < _FOOTER_SIZE + len(MCAP_MAGIC) or not tail.endswith(MCAP_MAGIC):
        return None, Loss(source.size, "the file has no end mark: its recording was cut off")
    opcode, length = RECORD_HEAD.unpack_from(tail)
    footer = decode_record(records.Footer, tail[RECORD_HEAD.size : _FOOTER_SIZE])
    if opcode != Opcode.FOOTER or length != _FOOTER_SIZE - RECORD_HEAD.size or footer is None:
        return None, Loss(footer_offset, "the footer is damaged")
    damaged = Loss(footer.summary_start, "the summary is damaged; the log was read without it")
    size = footer_offset - footer.summary_start if footer.summary_start else 0
    if size < 0 or size > max(_UNSUSPICIOUS_SIZE, source.size // _LARGEST_SHARE):
        return None, damaged
    section = source.read(footer.summary_start, size)
    crc = crc32(section + tail[: _FOOTER_SIZE - 4])
    if footer.summary_crc and crc != footer.summary_crc:
        return None, damaged
    if not footer.summary_start:
        return None, None
    summary = _Summary(source, footer.summary_start, verified=bool(footer.summary_crc))
    return (summary, None) if _parse_summary(section, summary) else (None, damaged)


def _parse_summary(section: bytes, summary: _Summary) -> bool:
    """Decode the section's records; false if one is malformed."""
    offset = 0
    while offset + RECORD_HEAD.size <= len(section):
        opcode, length = RECORD_HEAD.unpack_from(section, offset)
        offset += RECORD_HEAD.size
        if length > len(section) - offset:
            return False
        body = section[offset : offset + length]
        offset += length
        if not _take(opcode, body, summary):
            return False
    return offset == len(section)


def _take(opcode: int, body: bytes, summary: _Summary) -> bool:
    match opcode:
        case Opcode.SCHEMA:
            if (schema := decode_record(records.Schema, body)) is None:
                return False
            known = summary.schemas.setdefault(schema.id, schema_of(schema))
            summary.contradicts_itself |= known != schema_of(schema)
        case Opcode.CHANNEL:
            if (channel := decode_record(records.Channel, body)) is None:
                return False
            first = summary.channels.setdefault(channel.id, channel)
            summary.contradicts_itself |= first != channel
        case Opcode.STATISTICS:
            summary.statistics = decode_record(records.Statistics, body)
            return summary.statistics is not None
        case Opcode.CHUNK_INDEX:
            if (index := decode_record(records.ChunkIndex, body)) is None:
                return False
            summary.chunks.append(indexed_chunk(index, summary.counts))
        case Opcode.ATTACHMENT_INDEX | Opcode.METADATA_INDEX:
            if len(body) < 16:
                return False
            offset, size = struct.unpack_from("<QQ", body)
            kind = Opcode.ATTACHMENT if opcode == Opcode.ATTACHMENT_INDEX else Opcode.METADATA
            summary.extras.append(Extra(kind, offset, size, summary.source))
    return True


def _is_complete(summary: _Summary) -> bool:
    """Tell whether the summary has all the parts that opening a log needs."""
    statistics = summary.statistics
    schemas = {0, *summary.schemas}
    return (
        statistics is not None
        and statistics.chunk_count == len(summary.chunks)
        and (bool(summary.chunks) or not statistics.message_count)
        and statistics.channel_message_counts.keys() <= summary.channels.keys()
        and all(c.schema_id in schemas for c in summary.channels.values())
        and statistics.attachment_count + statistics.metadata_count == len(summary.extras)
        # Times that do not fit 64 bits with a sign are left to a look at the messages.
        and max(statistics.message_start_time, statistics.message_end_time) <= _LARGEST_TIME
    )


def _contents(source: ByteSource, summary: _Summary) -> Contents | None:
    """Return the contents by a complete summary, or None where it is wrong."""
    statistics = summary.statistics
    assert statistics is not None  # noqa: S101 - it is complete
    chunks = sorted(summary.chunks, key=lambda chunk: chunk.offset)
    extras = sorted(summary.extras, key=lambda extra: extra.offset)
    channels = {c.id: channel_of(c, summary.schemas) for c in summary.channels.values()}
    between = _RecordsBetween(source, DescriptionCheck(channels))
    true = (
        not summary.contradicts_itself
        and sum(statistics.channel_message_counts.values()) == statistics.message_count
        and _chunk_indexes_agree(chunks, statistics)
        and _chunks_are_there(source, chunks, summary, between)
        and between.extras == [extra.offset for extra in extras]
    )
    if not true:
        return None
    empty = statistics.message_count == 0
    start, end = _time_range(chunks, statistics)
    loss = check_data(source, summary.offset - DATA_END_SIZE, thorough=False)
    return Contents(
        channels=channels,
        chunks=chunks,
        counts={**dict.fromkeys(channels, 0), **statistics.channel_message_counts},
        start_time=None if empty else start,
        end_time=None if empty else end,
        extras=extras,
        losses=() if loss is None else (loss,),
    )


def _chunk_indexes_agree(chunks: Sequence[Chunk], statistics: records.Statistics) -> bool:
    """Tell whether the chunk indexes give the statistics, as far as they tell of messages."""
    counts: Counter[int] = Counter()
    for chunk in chunks:
        if chunk.counts is None:
            return True
        counts.update(chunk.counts)
    if counts != Counter(statistics.channel_message_counts):
        return False
    start, end = _time_range(chunks, statistics)
    # A time of 0 is left out of the statistics by a writer that takes it for none.
    return start in {0, statistics.message_start_time} and end == statistics.message_end_time


def _time_range(chunks: Sequence[Chunk], statistics: records.Statistics) -> tuple[int, int]:
    """Return the log times of the first and the last message, by the chunk indexes if known."""
    filled = [chunk for chunk in chunks if chunk.messages]
    starts = [chunk.start_time for chunk in filled if chunk.start_time is not None]
    ends = [chunk.end_time for chunk in filled if chunk.end_time is not None]
    if not starts or not ends or len(filled) < len(chunks):
        return statistics.message_start_time, statistics.message_end_time
    return min(starts), max(ends)


def _chunks_are_there(
    source: ByteSource, chunks: Sequence[Chunk], summary: _Summary, between: "_RecordsBetween"
) -> bool:
    """Tell whether chunks and known other records tile the data section.

    A chunk whose own header is damaged is there nevertheless if a checksum vouches for the
    summary.
    """
    offset = len(MCAP_MAGIC)
    offsets = [chunk.offset for chunk in chunks]
    heads = None if summary.verified else Heads(source, offsets, RECORD_HEAD.size)
    for chunk in chunks:
        if not between.lead(offset, chunk.offset):
            return False
        if chunk.index_end < chunk.end:
            return False
        if heads is not None and not _begins(heads, chunk):
            return False
        if chunk.data_offset + chunk.data_size > chunk.end:
            return False
        offset = chunk.index_end
    return between.lead(offset, summary.offset)


def _begins(heads: Heads, chunk: Chunk) -> bool:
    """Tell whether a chunk's record begins where its index says, and ends there, too."""
    head = heads.read(chunk.offset, RECORD_HEAD.size)
    if len(head) < RECORD_HEAD.size:
        return False
    opcode, length = RECORD_HEAD.unpack(head)
    return bool(opcode == Opcode.CHUNK and chunk.offset + RECORD_HEAD.size + length == chunk.end)


@dataclass(slots=True)
class _RecordsBetween:
    """Follows the records between chunks; schemas and channels must be those of the summary."""

    source: ByteSource
    descriptions: DescriptionCheck
    extras: list[int] = field(default_factory=list)
    """Offsets of attachments and metadata records."""

    def lead(self, offset: int, end: int) -> bool:
        """Tell whether records other than chunks and messages fill the bytes up to an offset."""
        for _ in range(_MOST_RECORDS_BETWEEN):
            if offset >= end:
                break
            head = self.source.read(offset, RECORD_HEAD.size)
            if len(head) < RECORD_HEAD.size:
                return False
            opcode, length = RECORD_HEAD.unpack(head)
            if not self._fits(opcode, offset, length):
                return False
            offset += RECORD_HEAD.size + length
        return offset == end

    def _fits(self, opcode: int, offset: int, length: int) -> bool:
        if opcode in {Opcode.ATTACHMENT, Opcode.METADATA}:
            self.extras.append(offset)
        elif opcode in DESCRIBING:
            body = self.source.read(offset + RECORD_HEAD.size, min(length, WHOLE_SMALL_RECORD))
            return self.descriptions.agrees(opcode, body)
        return opcode in _BETWEEN or opcode > max(Opcode)


def indexed_chunk(index: records.ChunkIndex, shared: SharedCounts) -> Chunk:
    """Return the chunk that an index describes."""
    end = index.chunk_start_offset + index.chunk_length
    index_end = end + index.message_index_length
    counts = None
    if index.message_index_offsets:
        # Each message index record is 15 bytes and 16 for every message.
        offsets = sorted(
            (offset, channel) for channel, offset in index.message_index_offsets.items()
        )
        ends = [offset for offset, _ in offsets[1:]] + [index_end]
        counts = shared.of(
            {
                channel: max(end - offset - 15, 0) // 16
                for (offset, channel), end in zip(offsets, ends, strict=True)
            }
        )
    head = RECORD_HEAD.size + CHUNK_HEAD.size + len(index.compression.encode()) + 8
    return Chunk(
        offset=index.chunk_start_offset,
        data_offset=index.chunk_start_offset + head,
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
    record = source.read(data_end, DATA_END_SIZE)
    if len(record) < DATA_END_SIZE or (data_end > source.cheap_size and not thorough):
        return None
    opcode, length = RECORD_HEAD.unpack_from(record)
    (expected,) = struct.unpack_from("<I", record, RECORD_HEAD.size)
    if opcode != Opcode.DATA_END or length < 4 or not expected:
        return None
    crc = 0
    for offset in range(0, data_end, _PIECE):
        crc = crc32(source.read(offset, min(_PIECE, data_end - offset)), crc)
    if crc == expected:
        return None
    return Loss(data_end, "the checksum over all of the log's data does not hold")
