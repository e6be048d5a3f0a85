"""The summary section of an MCAP file, and the checksum over its data."""

import struct
import sys
from typing import Final

from mcap import records
from mcap.opcode import Opcode
from zlib_ng.zlib_ng import crc32

from dogbot_logtool.io.mcap_layout import RECORD_HEAD
from dogbot_logtool.reader.containers.log import Chunk
from dogbot_logtool.reader.containers.loss import Loss
from dogbot_logtool.reader.containers.mcap.records import CHUNK_HEAD, decode_record
from dogbot_logtool.reader.containers.record_log import UnusableIndex
from dogbot_logtool.reader.containers.registry import MCAP_MAGIC
from dogbot_logtool.reader.containers.source import ByteSource

FOOTER_SIZE: Final = RECORD_HEAD.size + 20
_DATA_END_SIZE: Final = RECORD_HEAD.size + 4
_PIECE: Final = 1 << 20
DAMAGED_SUMMARY: Final = "the summary is damaged; the log was read without it"


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
        raise UnusableIndex(Loss(offset, "the footer is damaged"))
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
