"""The summary section of an MCAP file, and the checksum over its data."""

import struct
import sys
from collections import Counter
from collections.abc import Iterator
from collections.abc import Set as AbstractSet
from dataclasses import dataclass, field
from typing import Final

from mcap import records
from mcap.opcode import Opcode
from zlib_ng.zlib_ng import crc32

from dogbot_logtool.reader.containers.contents import Chunk, time_range
from dogbot_logtool.reader.containers.descriptions import Descriptions
from dogbot_logtool.reader.containers.loss import Loss
from dogbot_logtool.reader.containers.mcap.records import (
    CHUNK_HEAD,
    DESCRIBING,
    RECORD_HEAD,
    decode_record,
)
from dogbot_logtool.reader.containers.registry import MCAP_MAGIC
from dogbot_logtool.reader.containers.sources.source import ByteSource

_FOOTER_SIZE: Final = RECORD_HEAD.size + 20
_UNSUSPICIOUS_SIZE: Final = 64 << 20
_LARGEST_SHARE: Final = 4
"""A larger summary than `_UNSUSPICIOUS_SIZE` must not be more than this part of the file."""
DATA_END_SIZE: Final = RECORD_HEAD.size + 4
_PIECE: Final = 1 << 20
_LARGEST_TIME: Final = 2**63 - 1


@dataclass(slots=True)
class Summary:
    """What a summary section says, beside the descriptions in it."""

    offset: int
    verified: bool
    """Its checksum holds."""
    statistics: records.Statistics | None = None
    chunks: list[Chunk] = field(default_factory=list)
    """In the order of the file."""
    extras: list[int] = field(default_factory=list)
    """Offsets of attachments and metadata records, in the order of the file."""

    def take(self, opcode: int, body: bytes) -> bool:
        """Take a record that describes no channel; tell whether it is well-formed."""
        match opcode:
            case Opcode.STATISTICS:
                self.statistics = decode_record(records.Statistics, body)
                return self.statistics is not None
            case Opcode.CHUNK_INDEX:
                index = decode_record(records.ChunkIndex, body)
                self.chunks += [indexed_chunk(index)] if index else []
                return index is not None
            case Opcode.ATTACHMENT_INDEX | Opcode.METADATA_INDEX:
                self.extras.append(int.from_bytes(body[:8], "little"))
                return len(body) >= 16
        return True

    def is_complete(self, statistics: records.Statistics, channels: AbstractSet[int]) -> bool:
        """Tell whether it has all the parts that opening a log needs.

        Args:
            statistics: its own.
            channels: those that it describes.
        """
        return (
            statistics.chunk_count == len(self.chunks)
            and (bool(self.chunks) or not statistics.message_count)
            and statistics.channel_message_counts.keys() <= channels
            and statistics.attachment_count + statistics.metadata_count == len(self.extras)
            # Times that do not fit 64 bits with a sign are left to a look at the messages.
            and max(statistics.message_start_time, statistics.message_end_time) <= _LARGEST_TIME
        )

    def agrees(self, statistics: records.Statistics) -> bool:
        """Tell whether its parts agree with each other, its own statistics among them."""
        stated = Counter(statistics.channel_message_counts)
        known = [chunk.counts for chunk in self.chunks if chunk.counts is not None]
        counts: Counter[int] = Counter()
        for each in known:
            counts.update(each)
        return (
            stated.total() == statistics.message_count
            and (len(known) < len(self.chunks) or counts == stated)
            and all(each.data_offset + each.data_size <= each.end for each in self.chunks)
            and all(each.end <= each.index_end for each in self.chunks)
        )

    def times(self, statistics: records.Statistics) -> tuple[int | None, int | None]:
        """Return the log times of the first and the last message, by the chunks if they tell."""
        if not statistics.message_count:
            return None, None
        if self.chunks and all(chunk.messages for chunk in self.chunks):
            return time_range(self.chunks)
        return statistics.message_start_time, statistics.message_end_time


def read_summary(
    source: ByteSource, descriptions: Descriptions
) -> tuple[Summary | None, Loss | None]:
    """Read the summary section; a loss says why there is none that can be trusted.

    Args:
        source: the file.
        descriptions: receives the schemas and channels in it.
    """
    footer_offset = source.size - len(MCAP_MAGIC) - _FOOTER_SIZE
    tail = source.read(footer_offset, _FOOTER_SIZE + len(MCAP_MAGIC))
    if len(tail) < _FOOTER_SIZE + len(MCAP_MAGIC) or not tail.endswith(MCAP_MAGIC):
        return None, Loss(source.size, "the file has no end mark: its recording was cut off")
    opcode, length = RECORD_HEAD.unpack_from(tail)
    footer = decode_record(records.Footer, tail[RECORD_HEAD.size : _FOOTER_SIZE])
    if opcode != Opcode.FOOTER or length != _FOOTER_SIZE - RECORD_HEAD.size or footer is None:
        return None, Loss(footer_offset, "the footer is damaged")
    start = footer.summary_start
    size = footer_offset - start if start else 0
    honest = 0 <= size <= max(_UNSUSPICIOUS_SIZE, source.size // _LARGEST_SHARE)
    data = source.read(start, size) if honest else b""
    crc = crc32(data + tail[: _FOOTER_SIZE - 4]) if footer.summary_crc else 0
    summary = Summary(start, bool(crc))
    sound = honest and crc == footer.summary_crc
    described: list[bytes] = []
    for opcode, record in _split(data) if sound else ():
        if opcode in DESCRIBING:
            described.append(record)
        else:
            sound &= opcode > 0 and summary.take(opcode, record[RECORD_HEAD.size :])
    sound &= not descriptions.add(described, start)
    if not sound:
        return None, Loss(start, "the summary is damaged; the log was read without it")
    summary.chunks.sort(key=lambda chunk: chunk.offset)
    summary.extras.sort()
    return (summary if start else None), None


def _split(data: bytes) -> Iterator[tuple[int, bytes]]:
    """Yield opcode and bytes of the records in a section; the opcode 0 if they do not fill it."""
    offset = 0
    while offset + RECORD_HEAD.size <= len(data):
        start = offset
        opcode, length = RECORD_HEAD.unpack_from(data, start)
        offset += RECORD_HEAD.size + length
        yield opcode, data[start:offset]
    if offset != len(data):
        yield 0, b""


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
