"""MCAP message records, many at a time, and finished chunks: compressed, with their index."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Final, Literal, NamedTuple

import lz4.frame
import numpy as np
import zstandard
from mcap import records
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from zlib_ng.zlib_ng import crc32

from dogbot_logtool.core.arrays import Bytes, Ints, rows_by_group
from dogbot_logtool.mcap_layout import INDEX_ENTRY, INDEX_HEAD, MESSAGE_HEAD, RECORD_HEAD
from dogbot_logtool.writer.template import Records

Compression = Literal["zstd", "lz4", "none"]
CHUNK_SIZE: Final = 1 << 20
"""Bytes of records in a chunk, before compression; a record is never split."""
ZSTD: Final = zstandard.ZstdCompressionParameters.from_level(-1, window_log=18)
"""Level -1, looking back over 256 KiB, which stay in a processor's cache, instead of 512: `convert`
takes a twentieth less time than with level 1, for files from 1 % smaller to 2 % larger."""
_MANY: Final = 64 << 10
"""Bytes of one channel's messages from which they get chunks of their own."""


class MessageRecords(NamedTuple):
    """Consecutive message records."""

    data: Bytes
    """(b,) the records."""
    bounds: Ints
    """(n + 1,) where each record begins and the last one ends."""
    channel: Ints
    """(n,) channel ids of the output."""
    log_time: Ints
    """(n,) ns."""

    def part(self, rows: slice) -> "MessageRecords":
        """Return consecutive messages."""
        bounds = self.bounds[rows.start : rows.stop + 1]
        first = int(bounds[0])
        return MessageRecords(
            self.data[first : int(bounds[-1])],
            bounds - first,
            self.channel[rows],
            self.log_time[rows],
        )


def recorded(
    channel: Ints,
    sequence: Ints,
    log_time: Ints,
    publish_time: Ints,
    buffer: Bytes,
    start: Ints,
    end: Ints,
) -> MessageRecords:
    """Return records of recorded messages, payloads byte for byte.

    Args:
        channel: (n,) channel ids of the output.
        sequence: (n,).
        log_time: (n,) ns.
        publish_time: (n,) ns.
        buffer: (b,) holds the payloads.
        start: (n,) offset of each payload's first byte.
        end: (n,) offset after its last byte.
    """
    size = end - start
    head = np.empty(len(size), MESSAGE_HEAD)
    head["opcode"] = Opcode.MESSAGE
    head["length"] = size + (MESSAGE_HEAD.itemsize - RECORD_HEAD.size)
    head["channel"] = channel
    head["sequence"] = sequence
    head["log_time"] = log_time
    head["publish_time"] = publish_time
    # Slices of Python: to gather and scatter pieces with numpy takes as long, and more lines.
    pieces: list[bytes | memoryview] = [b""] * (2 * len(size))
    pieces[::2] = head.view(f"V{MESSAGE_HEAD.itemsize}").tolist()
    payloads = buffer.data
    pieces[1::2] = [payloads[a:b] for a, b in zip(start.tolist(), end.tolist(), strict=True)]
    data = np.frombuffer(b"".join(pieces), np.uint8)
    return MessageRecords(data, _bounds(size + MESSAGE_HEAD.itemsize), channel, log_time)


def of_payloads(channel: int, payloads: Iterable[bytes], log_time: Ints) -> MessageRecords:
    """Return records of messages of one channel, (n,) ns."""
    made = list(payloads)
    end = np.cumsum([len(each) for each in made], dtype=np.int64)
    start, none = np.append(0, end)[:-1], np.zeros(len(made), np.int64)
    data = np.frombuffer(b"".join(made), np.uint8)
    return recorded(none + channel, none, log_time, log_time, data, start, end)


def by_channel(parts: Iterable[Records]) -> Iterator[MessageRecords]:
    """Group records by channel: each channel that has many, then the rest together.

    Messages of one channel are similar, so they compress better together; and a reader of some
    channels skips the chunks of the others.

    Args:
        parts: copies of record templates, each (k,) and of one channel. They are made one after
            the other, so that few are in memory at once; parts of a channel that are not
            neighbours make several groups.
    """
    few: list[Records] = []
    for _, same in groupby(filter(len, parts), lambda part: int(part["channel"][0])):
        of_channel = list(same)
        if sum(part.nbytes for part in of_channel) < _MANY:
            few.extend(of_channel)
        else:
            yield in_time_order(of_channel)
    if few:
        yield in_time_order(few)


def in_time_order(parts: Sequence[Records]) -> MessageRecords:
    """Return records sorted by log time; at equal times the earlier part comes first.

    Args:
        parts: copies of record templates, each (k,).
    """
    log_time, channel = (
        np.concatenate([part[field] for part in parts]).astype(np.int64)
        for field in ("log_time", "channel")
    )
    counts = [len(part) for part in parts]
    order = np.argsort(log_time, kind="stable")
    bounds = _bounds(np.repeat([part.dtype.itemsize for part in parts], counts)[order])
    offset = np.empty_like(order)
    offset[order] = bounds[:-1]
    data = np.empty(int(bounds[-1]), np.uint8)
    for part, own in zip(parts, np.split(offset, np.cumsum(counts)[:-1]), strict=True):
        width = part.dtype.itemsize
        windows = np.ndarray((len(data) - width + 1,), f"V{width}", data.data, 0, (1,))
        windows[own] = part.view(f"V{width}")
    return MessageRecords(data, bounds, channel[order], log_time[order])


def _bounds(size: Ints) -> Ints:
    return np.concatenate([[0], np.cumsum(size)])


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
    if compression == "zstd":
        return zstandard.ZstdCompressor(compression_params=ZSTD).compress(data.data)
    return bytes(lz4.frame.compress(data.data)) if compression == "lz4" else data.tobytes()
