"""The index section at the end of a ROS 1 bag."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.reader.containers.bag.chunk import chunk_at, indexed_times
from dogbot_logtool.reader.containers.bag.format import INDEX_ENTRY_SIZE
from dogbot_logtool.reader.containers.bag.records import (
    HEAD_SIZE,
    BagOp,
    Fields,
    MalformedRecord,
    Record,
    connection_channel,
    record_at,
    record_in_file,
)
from dogbot_logtool.reader.containers.chunks.chunk_content import ChunkDamage
from dogbot_logtool.reader.containers.chunks.records import Heads
from dogbot_logtool.reader.containers.contents import Channel, Chunk, Contents, Schema, SharedCounts
from dogbot_logtool.reader.containers.loss import Loss, described_twice
from dogbot_logtool.reader.containers.signatures import BAG_MAGIC
from dogbot_logtool.reader.containers.sources.source import ByteSource

_MOST_CONNECTIONS: Final = 1 << 16
_MOST_BYTES: Final = 64 << 20
"""A bag that describes more connections, or in more words, is not honest."""
_UNSUSPICIOUS_SIZE: Final = 64 << 20
_LARGEST_SHARE: Final = 4
"""A larger index than `_UNSUSPICIOUS_SIZE` must not be more than this part of the bag."""
_LARGEST_PADDING: Final = 4096
"""Some recorders leave zero bytes before the index."""
_INDEX_RECORD_SIZE: Final = 55
"""Bytes of an index record besides its entries, as every recorder writes it."""


class Connections:
    """The bag's connections as channels, numbered from 1 in the order in which they are met."""

    def __init__(self) -> None:
        self.channels: dict[int, Channel] = {}
        self.channel_ids: dict[int, int] = {}
        """Channel id by connection number."""
        self._schemas: dict[tuple[str, str], Schema] = {}
        self._bytes = 0

    def add(self, fields: Fields, data: bytes | memoryview) -> None:
        """Take a connection record; one that is known already changes nothing.

        Raises:
            MalformedRecord: it does not describe a connection.
        """
        connection = fields.u32("conn")
        if connection in self.channel_ids:
            return
        self._bytes += len(data)
        if len(self.channels) >= _MOST_CONNECTIONS or self._bytes > _MOST_BYTES:
            raise MalformedRecord("it describes too many connections")
        number = len(self.channels) + 1
        self.channels[number] = connection_channel(number, fields, data, self._schemas)
        self.channel_ids[connection] = number

    def contradiction(self, record: bytes, offset: int) -> Loss | None:
        """Compare a connection record with what is known of the connection.

        Args:
            record: the whole record.
            offset: of the chunk that holds it.

        Returns:
            what to say if they differ.
        """
        try:
            found = record_at(record, 0, len(record))
            connection = found.fields.u32("conn")
            number = self.channel_ids.get(connection)
            if number is None:
                return None
            content = memoryview(record)[found.data : found.end]
            described = connection_channel(number, found.fields, content, {})
        except MalformedRecord as fault:
            what = f"a connection's description in the chunk at byte {offset} is damaged ({fault})"
            return Loss(offset, what)
        known = self.channels[number]
        if _same(described, known):
            return None
        one, other = (f"{each.topic} of type {each.type_name}" for each in (known, described))
        if one == other:
            other += " with another definition or header"
        return described_twice(f"connection {connection}", one, other, offset)


def _same(one: Channel, other: Channel) -> bool:
    """Tell whether channels are described alike; schemas are numbered as they are met."""
    return (one.topic, one.metadata) == (other.topic, other.metadata) and (
        (one.schema and (one.schema.name, one.schema.data))
        == (other.schema and (other.schema.name, other.schema.data))
    )


@dataclass(frozen=True, slots=True)
class ChunkInfo:
    """A chunk's entry in the index."""

    offset: int
    start_time: int
    """ns; also `end_time`."""
    end_time: int
    counts: Mapping[int, int]
    """Messages by connection number."""


def read_index(source: ByteSource, connections: Connections) -> tuple[Contents | None, Loss | None]:
    """Read the index section, collecting the connections.

    Returns:
        the contents, or None where the index is absent, damaged or contradicts the chunks; and
        what is wrong with it.
    """
    try:
        header = record_in_file(source, len(BAG_MAGIC))
        if header.fields.op() != BagOp.BAG_HEADER:
            raise MalformedRecord("the bag's header is missing")
        index_start = header.fields.u64("index_pos")
        if index_start == 0:
            what = "the bag has no index (its recording was not closed); it was read without it"
            return None, Loss(len(BAG_MAGIC), what)
        infos = _read_section(source, index_start, connections)
        if len(infos) != header.fields.u32("chunk_count"):
            raise MalformedRecord("it names another number of chunks than the bag's header")
        chunks = _chunks(source, infos, index_start, connections)
        if not _only_small_records(source, header.end, chunks[0].offset if chunks else index_start):
            raise MalformedRecord("it contradicts the chunks")
        if not _times_hold(source, chunks):
            raise MalformedRecord("it tells wrong times")
    except (MalformedRecord, ChunkDamage) as fault:
        what = f"the bag's index is damaged ({fault}); the bag was read without it"
        return None, Loss(len(BAG_MAGIC), what)
    return _contents(connections, chunks), None


def _times_hold(source: ByteSource, chunks: Sequence[Chunk]) -> bool:
    """Tell whether the index records behind chunks confirm when the log begins and ends.

    They are compared for the first and the last chunk, in the file and by the times stated.
    """
    if not chunks:
        return True
    compared = {
        chunk.offset: chunk
        for chunk in (
            chunks[0],
            chunks[-1],
            min(chunks, key=lambda chunk: chunk.start_time or 0),
            max(chunks, key=lambda chunk: chunk.end_time or 0),
        )
    }.values()
    found = indexed_times(source, list(compared))
    return all(
        times in {None, (chunk.start_time, chunk.end_time)}
        for chunk, times in zip(compared, found, strict=True)
    )


def _contents(connections: Connections, chunks: Sequence[Chunk]) -> Contents:
    counts = dict.fromkeys(connections.channels, 0)
    for chunk in chunks:
        for channel, count in (chunk.counts or {}).items():
            counts[channel] += count
    filled = [chunk for chunk in chunks if chunk.messages]
    return Contents(
        channels=connections.channels,
        chunks=chunks,
        counts=counts,
        start_time=min((c.start_time for c in filled if c.start_time is not None), default=None),
        end_time=max((c.end_time for c in filled if c.end_time is not None), default=None),
        profile="ros1",
    )


def _read_section(source: ByteSource, start: int, connections: Connections) -> list[ChunkInfo]:
    if start > source.size:
        raise MalformedRecord("it is cut off")
    if source.size - start > max(_UNSUSPICIOUS_SIZE, source.size // _LARGEST_SHARE):
        raise MalformedRecord("it is absurdly long")
    section = source.read(start, source.size - start)
    infos: list[ChunkInfo] = []
    # Some recorders leave zero bytes before the index; a record's length begins after them.
    offset = len(section) - len(section.lstrip(b"\0"))
    while offset < len(section):
        record = record_at(section, offset, len(section))
        op = record.fields.op()
        if op == BagOp.CONNECTION:
            connections.add(record.fields, memoryview(section)[record.data : record.end])
            if connections.contradiction(section[offset : record.end], start + offset) is not None:
                raise MalformedRecord("it describes a connection in two ways")
        elif op == BagOp.CHUNK_INFO:
            infos.append(chunk_info(record, section))
        else:
            raise MalformedRecord("it holds records of another kind")
        offset = record.end
    return infos


def chunk_info(record: Record, data: bytes) -> ChunkInfo:
    """Decode what an index record says of a chunk.

    Args:
        record: the record.
        data: the bytes in which it lies.

    Raises:
        MalformedRecord: it is damaged.
    """
    fields = record.fields
    count = fields.u32("count")
    if record.end - record.data != count * 8:
        raise MalformedRecord("a chunk's message counts are damaged")
    pairs = np.frombuffer(data, "<u4", count * 2, record.data).reshape(-1, 2).tolist()
    return ChunkInfo(
        fields.u64("chunk_pos"),
        fields.time_ns("start_time"),
        fields.time_ns("end_time"),
        dict(pairs),
    )


def _chunks(
    source: ByteSource, infos: list[ChunkInfo], index_start: int, connections: Connections
) -> list[Chunk]:
    infos = sorted(infos, key=lambda info: info.offset)
    ends = [*(info.offset for info in infos[1:]), index_start][: len(infos)]
    chunks: list[Chunk] = []
    heads = Heads(source, [info.offset for info in infos], HEAD_SIZE)
    shared = SharedCounts()
    for info, end in zip(infos, ends, strict=True):
        chunk = chunk_at(heads, info.offset)
        if (
            not _only_index_records(source, chunk.end, end, info.counts)
            or not info.counts.keys() <= connections.channel_ids.keys()
        ):
            raise MalformedRecord("it contradicts the chunks")
        counts = {connections.channel_ids[c]: n for c, n in info.counts.items()}
        chunks.append(
            replace(
                chunk,
                index_end=end,
                start_time=info.start_time,
                end_time=info.end_time,
                counts=shared.of(counts),
            )
        )
    return chunks


def _only_index_records(
    source: ByteSource, offset: int, end: int, counts: Mapping[int, int]
) -> bool:
    """Tell whether a chunk's index records lead from its end to the next chunk."""
    expected = _INDEX_RECORD_SIZE * len(counts) + INDEX_ENTRY_SIZE * sum(counts.values())
    return end - offset == expected or _only_small_records(source, offset, end)


def _only_small_records(source: ByteSource, offset: int, end: int) -> bool:
    """Tell whether records that are neither chunks nor messages lead from one offset to another."""
    while offset < end:
        if end - offset <= _LARGEST_PADDING and not any(source.read(offset, end - offset)):
            return True
        record = record_in_file(source, offset)
        if record.fields.op() not in {BagOp.INDEX, BagOp.CONNECTION}:
            return False
        offset = record.end
    return offset == end
