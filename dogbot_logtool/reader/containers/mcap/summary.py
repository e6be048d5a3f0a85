"""The summary section of an MCAP file, and the checksum over its data."""

import struct
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from mcap import records
from mcap.opcode import Opcode
from zlib_ng.zlib_ng import crc32

from dogbot_logtool.reader.containers.contents import Chunk
from dogbot_logtool.reader.containers.loss import Loss
from dogbot_logtool.reader.containers.mcap.records import CHUNK_HEAD, RECORD_HEAD, decode_record
from dogbot_logtool.reader.containers.signatures import MCAP_MAGIC
from dogbot_logtool.reader.containers.sources.source import ByteSource

_FOOTER_SIZE: Final = RECORD_HEAD.size + 20
_UNSUSPICIOUS_SIZE: Final = 64 << 20
_LARGEST_SHARE: Final = 4
"""A larger summary than `_UNSUSPICIOUS_SIZE` must not be more than this part of the file."""
DATA_END_SIZE: Final = RECORD_HEAD.size + 4
_PIECE: Final = 1 << 20


@dataclass(frozen=True, slots=True)
class Section:
    """A summary section."""

    offset: int
    verified: bool
    """Its checksum holds."""
    records: Sequence[tuple[int, bytes]]
    """Opcode and content of each."""


def read_section(source: ByteSource) -> tuple[Section | None, Loss | None]:
    """Read the summary section; a loss says why there is none that can be trusted."""
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
    found = _split(data)
    crc = crc32(data + tail[: _FOOTER_SIZE - 4]) if footer.summary_crc else 0
    if not honest or found is None or crc != footer.summary_crc:
        return None, damaged_summary(start)
    return (Section(start, bool(crc), found) if start else None), None


def _split(data: bytes) -> list[tuple[int, bytes]] | None:
    """Return opcode and content of the records in a section; None if they do not fill it."""
    found: list[tuple[int, bytes]] = []
    offset = 0
    while offset + RECORD_HEAD.size <= len(data):
        opcode, length = RECORD_HEAD.unpack_from(data, offset)
        content = offset + RECORD_HEAD.size
        offset = content + length
        found.append((opcode, data[content:offset]))
    return found if offset == len(data) else None


def damaged_summary(offset: int) -> Loss:
    """Say that the summary at an offset cannot be read."""
    return Loss(offset, "the summary is damaged; the log was read without it")


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
