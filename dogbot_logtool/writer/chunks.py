"""Finished MCAP chunks: compressed records and the message index that belongs to them."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final, Literal

import lz4.frame
import numpy as np
import zstandard
from mcap import records
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from zlib_ng.zlib_ng import crc32

from dogbot_logtool.core.arrays import Bytes, Ints, rows_by_group
from dogbot_logtool.io.mcap_layout import INDEX_ENTRY, INDEX_HEAD, RECORD_HEAD
from dogbot_logtool.writer.message_records import MessageRecords

Compression = Literal["zstd", "lz4", "none"]
CHUNK_SIZE: Final = 1 << 20
"""Bytes of records in a chunk, before compression; a record is never split."""
ZSTD: Final = zstandard.ZstdCompressionParameters.from_level(1, window_log=18)
"""Level 1, looking back over 256 KiB, which stay in a processor's cache, instead of 512: it takes
a twelfth less time, for files of the same size. Level -1 would take another quarter less, for files
that are 2 to 3 % larger."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class FinishedChunk:
    """A chunk record and its message index records, ready to be written."""

    record: Bytes
    """The whole chunk record; an array, which is sent between processes without a copy."""
    index: Bytes
    """The message index records that follow it."""
    start_time: int
    """ns, earliest log time; also `end_time`."""
    end_time: int
    compression: str
    compressed_size: int
    size: int


def finish_chunks(messages: MessageRecords, compression: Compression) -> Iterator[FinishedChunk]:
    """Split messages into chunks and compress these."""
    bounds, first, count = messages.bounds, 0, len(messages.log_time)
    while first < count:
        last = int(np.searchsorted(bounds, bounds[first] + CHUNK_SIZE, "left"))
        last = min(max(last, first + 1), count)
        yield finish_chunk(messages.part(slice(first, last)), compression)
        first = last


def finish_chunk(messages: MessageRecords, compression: Compression) -> FinishedChunk:
    """Compress the messages of one chunk, at least one, and index them."""
    data = messages.data
    start, end = int(messages.log_time.min()), int(messages.log_time.max())
    compressed = _compress(data, compression)
    name = "" if compression == "none" else compression
    builder = RecordBuilder()
    records.Chunk(
        compression=name,
        data=compressed,
        message_end_time=end,
        message_start_time=start,
        uncompressed_crc=crc32(data.data),
        uncompressed_size=len(data),
    ).write(builder)
    record = np.frombuffer(builder.end(), np.uint8)
    index = message_index(messages.channel, messages.log_time, messages.bounds[:-1])
    return FinishedChunk(record, index, start, end, name, len(compressed), len(data))


def message_index(channel: Ints, log_time: Ints, offset: Ints) -> Bytes:
    """Return the message index records of a chunk.

    Args:
        channel: (n,) channel ids of its messages.
        log_time: (n,) ns.
        offset: (n,) of each message's record in the chunk's records.
    """
    pieces: list[bytes] = []
    for number, rows in rows_by_group(channel):
        entries = np.empty(len(rows), INDEX_ENTRY)
        entries["log_time"], entries["offset"] = log_time[rows], offset[rows]
        pieces.append(
            INDEX_HEAD.pack(Opcode.MESSAGE_INDEX, entries.nbytes + 6, number, entries.nbytes)
        )
        pieces.append(entries.tobytes())
    return np.frombuffer(b"".join(pieces), np.uint8)


def indexed_channels(index: Bytes) -> Iterator[tuple[int, int, int]]:
    """Yield channel, offset and messages of each message index record that lists any."""
    first = 0
    while first < len(index):
        opcode, length, channel, entries = INDEX_HEAD.unpack_from(index.data, first)
        if opcode == Opcode.MESSAGE_INDEX and entries:
            yield channel, first, entries // INDEX_ENTRY.itemsize
        first += RECORD_HEAD.size + length


def _compress(data: Bytes, compression: Compression) -> bytes:
    match compression:
        case "zstd":
            return zstandard.ZstdCompressor(compression_params=ZSTD).compress(data.data)
        case "lz4":
            return bytes(lz4.frame.compress(data.data))
        case "none":
            return data.tobytes()
