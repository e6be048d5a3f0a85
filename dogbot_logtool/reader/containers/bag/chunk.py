"""One chunk of a ROS 1 bag: its header, and the messages in it."""

import sys
from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Bytes
from dogbot_logtool.reader.containers.bag.format import nanoseconds
from dogbot_logtool.reader.containers.bag.records import (
    BagOp,
    Fields,
    MalformedRecord,
    record_bounds,
    record_in_file,
)
from dogbot_logtool.reader.containers.compression import decompress_into
from dogbot_logtool.reader.containers.contents import Chunk
from dogbot_logtool.reader.containers.loss import Loss
from dogbot_logtool.reader.containers.salvage.content import ChunkContent, ChunkDamage, read_content
from dogbot_logtool.reader.containers.salvage.records import (
    Index,
    IndexRecord,
    Readable,
    RecordFormat,
    read_index,
)
from dogbot_logtool.reader.containers.sources.source import ByteSource

_INDEX_ENTRY: Final = np.dtype([("seconds", "<u4"), ("nanoseconds", "<u4"), ("offset", "<u4")])
_RECURRING_SIZE: Final = 64
"""Headers of index records are mostly shorter, and come again behind every chunk."""


def chunk_at(source: Readable, offset: int, head: bytes = b"") -> Chunk:
    """Read a chunk record's header. Its data may reach beyond the end of the file.

    Raises:
        ChunkDamage: there is no chunk.
    """
    try:
        record = record_in_file(source, offset, head)
        compression = record.fields.raw("compression").decode("utf-8", "replace")
        size = record.fields.u32("size")
    except MalformedRecord as fault:
        raise ChunkDamage(f"its header is damaged ({fault})") from fault
    data_size = record.end - record.data
    return Chunk(
        offset=offset,
        data_offset=record.data,
        data_size=data_size,
        end=record.end,
        index_end=record.end,
        compression=sys.intern(compression),
        size=data_size if compression in {"", "none"} else size,
    )


def parse_bag_chunk(
    chunk: Chunk, stored: memoryview, target: Bytes, fmt: RecordFormat
) -> ChunkContent:
    """Decompress a chunk and find its messages; their channels are the connections' numbers.

    Raises:
        ChunkDamage: nothing in it can be trusted.
    """
    index = _index(stored[chunk.end - chunk.offset :])
    data = stored[chunk.data_offset - chunk.offset :][: chunk.data_size]
    promised = chunk.messages if index is None else len(index.offset)
    try:
        size = decompress_into(target, data, chunk.compression)
        if not size and len(target):
            raise ChunkDamage(f"its {chunk.compression} data is damaged or cut off")
    except ChunkDamage as damage:
        raise ChunkDamage(str(damage), promised) from damage
    if size == len(target):
        return read_content(fmt, target, index, chunk, verified=False)
    content = read_content(fmt, target[:size], None, replace(chunk, counts=None), verified=False)
    # A last record that is cut off is no other damage, and has no number of messages lost.
    losses = [loss for loss in content.losses if loss.messages is not None]
    found = len(content.messages) + sum(loss.messages or 0 for loss in losses)
    lost = None if promised is None else max(promised - found, 0)
    what = f"the last {chunk.size - size} bytes in the chunk at byte {chunk.offset} are "
    losses.append(Loss(chunk.offset, what + "damaged or cut off", 0, lost))
    return replace(content, losses=tuple(losses))


def indexed_times(source: ByteSource, chunks: Sequence[Chunk]) -> list[tuple[int, int] | None]:
    """Return the first and last log time, ns, that the index records behind chunks name.

    None for a chunk whose index records are missing, empty or damaged.
    """
    ranges = [(chunk.end, chunk.index_end - chunk.end) for chunk in chunks]
    indexes = [_index(memoryview(data)) for data in source.read_many(ranges)]
    return [
        (int(index.log_time.min()), int(index.log_time.max()))
        if index is not None and index.complete and len(index.log_time)
        else None
        for index in indexes
    ]


def _index(behind: memoryview) -> Index | None:
    return read_index(behind, _index_record, _INDEX_ENTRY, nanoseconds)


def _index_record(behind: memoryview, offset: int) -> IndexRecord | None:
    try:
        header_end, end = record_bounds(behind, offset, len(behind))
        header = bytes(behind[offset + 4 : header_end])
        recurs = len(header) <= _RECURRING_SIZE
        connection = (_recurring_connection if recurs else _indexed_connection)(header)
    except MalformedRecord:
        return None
    return connection, behind[header_end + 4 : end], end


def _indexed_connection(header: bytes) -> int:
    """Return the connection whose messages an index record names.

    Raises:
        MalformedRecord: it is no index record.
    """
    fields = Fields(header)
    if fields.op() != BagOp.INDEX:
        raise MalformedRecord("it is a record of another kind")
    return fields.u32("conn")


_recurring_connection: Final = lru_cache(maxsize=1024)(_indexed_connection)
