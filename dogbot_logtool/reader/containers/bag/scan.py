"""The chunks and connections of a ROS 1 bag: by its index, or by all of its records."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Bytes
from dogbot_logtool.reader.containers.bag.chunk import (
    chunk_at,
    indexed_times,
    parse_bag_chunk,
)
from dogbot_logtool.reader.containers.bag.connections import Connections
from dogbot_logtool.reader.containers.bag.format import INDEX_ENTRY_SIZE, BagFormat, is_sound
from dogbot_logtool.reader.containers.bag.records import (
    HEAD_SIZE,
    BagOp,
    MalformedRecord,
    Record,
    record_at,
    record_in_file,
)
from dogbot_logtool.reader.containers.chunked_log import ChunkedLog, open_chunked
from dogbot_logtool.reader.containers.compression import check_claimed_size
from dogbot_logtool.reader.containers.contents import Channel, Chunk, Contents, time_range
from dogbot_logtool.reader.containers.loss import Loss
from dogbot_logtool.reader.containers.salvage.content import ChunkContent, ChunkDamage
from dogbot_logtool.reader.containers.salvage.scan import IndexEntry, ReadChunk, Scan
from dogbot_logtool.reader.containers.signatures import BAG_MAGIC
from dogbot_logtool.reader.containers.sources.source import ByteSource, in_groups

_UNSUSPICIOUS_SIZE: Final = 64 << 20
_LARGEST_SHARE: Final = 4
"""A larger index than `_UNSUSPICIOUS_SIZE` must not be more than this part of the bag."""
_LARGEST_PADDING: Final = 4096
"""Some recorders leave zero bytes before the index."""
_INDEX_RECORD_SIZE: Final = 55
"""Bytes of an index record besides its entries, as every recorder writes it."""
_NOT_CLOSED: Final = "the bag has no index (its recording was not closed); it was read without it"


class BagScan(Scan):
    """Finds chunks, bare messages and connections."""

    container = "ROS 1 bag"
    magic = BAG_MAGIC

    def __init__(self, source: ByteSource) -> None:
        super().__init__(source, BagFormat())
        self.connections = Connections()
        self._outside: list[tuple[int, int]] = []
        """Offset and end of connection records outside chunks."""

    def indexed(self) -> tuple[Contents | None, Loss | None]:
        """See `Scan.indexed`."""
        start = len(BAG_MAGIC)
        try:
            header = record_in_file(self.source, start)
            if header.fields.op() != BagOp.BAG_HEADER:
                raise MalformedRecord("the bag's header is missing")
            index_start = header.fields.u64("index_pos")
            if index_start == 0:
                return None, Loss(start, _NOT_CLOSED)
            self._read_section(index_start)
            if len(self._index_entries) != header.fields.u32("chunk_count"):
                raise MalformedRecord("it names another number of chunks than the bag's header")
            chunks = self._indexed_chunks(index_start)
            if not self._fills(header.end, chunks, index_start):
                raise MalformedRecord("it contradicts the chunks")
            if not _times_hold(self.source, chunks):
                raise MalformedRecord("it tells wrong times")
        except (MalformedRecord, ChunkDamage) as fault:
            what = f"the bag's index is damaged ({fault}); the bag was read without it"
            return None, Loss(start, what)
        times = time_range([chunk for chunk in chunks if chunk.messages])
        contents = self._channels(), chunks, self._counts(chunks), *times, self._profile()
        return Contents(*contents), None

    def _read_section(self, start: int) -> None:
        """Read the connections and the chunks' entries."""
        size = self.source.size
        if start > size:
            raise MalformedRecord("it is cut off")
        if size - start > max(_UNSUSPICIOUS_SIZE, size // _LARGEST_SHARE):
            raise MalformedRecord("it is absurdly long")
        section = self.source.read(start, size - start)
        # A record's length begins behind the zeros.
        offset = len(section) - len(section.lstrip(b"\0"))
        while offset < len(section):
            record = record_at(section, offset, len(section))
            op = record.fields.op()
            if op == BagOp.CONNECTION:
                data = section[offset : record.end]
                self.connections.add(data)
                if self.connections.contradiction(data, start + offset) is not None:
                    raise MalformedRecord("it describes a connection in two ways")
            elif op == BagOp.CHUNK_INFO:
                self._take_info(record, section)
            else:
                raise MalformedRecord("it holds records of another kind")
            offset = record.end

    def _take_info(self, record: Record, data: bytes) -> None:
        """Take what an index record says of a chunk.

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
        counts = np.frombuffer(data, "<u4", count * 2, record.data).reshape(-1, 2).tolist()
        times = fields.time_ns("start_time"), fields.time_ns("end_time")
        self._index_entries[fields.u64("chunk_pos")] = IndexEntry(*times, dict(counts))

    def _indexed_chunks(self, index_start: int) -> list[Chunk]:
        """Return the chunks that the index names, and the index records behind each."""
        entries = sorted(self._index_entries.items())
        offsets = [offset for offset, _ in entries]
        heads = in_groups(self.source, [(offset, HEAD_SIZE) for offset in offsets])
        ids = self.connections.channel_ids
        chunks: list[Chunk] = []
        for (offset, entry), end, head in zip(
            entries, [*offsets[1:], index_start][: len(offsets)], heads, strict=True
        ):
            chunk = chunk_at(self.source, offset, head)
            counts = entry.counts or {}
            if not counts.keys() <= ids.keys():
                raise MalformedRecord("it contradicts the chunks")
            named = _INDEX_RECORD_SIZE * len(counts) + INDEX_ENTRY_SIZE * sum(counts.values())
            # Index records of the usual size need not be looked at.
            if end - chunk.end != named and not self._fills(chunk.end, (), end):
                raise MalformedRecord("it contradicts the chunks")
            known = {ids[number]: count for number, count in counts.items()}
            chunks.append(replace(entry.added_to(chunk), index_end=end, counts=known))
        return chunks

    def _between(self, offset: int, stop: int) -> int | None:
        size = stop - offset
        if size <= _LARGEST_PADDING and not any(self.source.read(offset, size)):
            return stop
        record = record_in_file(self.source, offset)
        return record.end if record.fields.op() in {BagOp.INDEX, BagOp.CONNECTION} else None

    def _step(self, offset: int) -> int | None:
        try:
            record = record_in_file(self.source, offset)
            if record.fields.has("compression"):
                return self._chunk_record(offset, record)
            op = record.fields.op()
            if record.end > self.source.size or not is_sound(record, op):
                return None
            if op == BagOp.MESSAGE:
                return self._bare(offset, record.end)
            if op == BagOp.INDEX:
                self._take_index(offset, record.end)
            elif op == BagOp.CONNECTION:
                self._outside.append((offset, record.end))
            elif op == BagOp.CHUNK_INFO:
                data = self.source.read(offset, record.end - offset)
                self._take_info(record_at(data, 0, len(data)), data)
        except (MalformedRecord, ChunkDamage):
            if self.source.read(offset, len(BAG_MAGIC)) == BAG_MAGIC:
                return self._end(offset)
            return self._passed_zeros(offset)
        return record.end

    def _chunk_record(self, offset: int, record: Record) -> int:
        chunk = chunk_at(self.source, offset)
        if chunk.is_compressed:
            return self._take_chunk(chunk, chunk.end)
        stated = record.fields.u32("size")
        return self._take_chunk(replace(chunk, data_size=stated), chunk.data_offset + stated)

    def _passed_zeros(self, offset: int) -> int | None:
        """Pass over the zero bytes that some recorders leave before the index."""
        window = self.source.read(offset, _LARGEST_PADDING)
        zeros = len(window) - len(window.lstrip(b"\0"))
        # The length of the next record's header ends with zeros, but does not begin with one.
        following = offset + zeros
        if zeros and following < self.source.size and self._follows(following):
            return following
        return None

    def _describe(self, op: int, record: Bytes, chunk: Chunk) -> None:
        if op == BagOp.CONNECTION:
            self._connect(record.tobytes(), chunk.offset)

    def _connect(self, record: bytes, offset: int) -> str:
        """Take a connection record; return why it cannot be, or nothing."""
        try:
            self.connections.add(record)
        except MalformedRecord as fault:
            return str(fault)
        loss = self.connections.contradiction(record, offset)
        if loss is not None:
            self._losses.add(loss)
        return ""

    def check(self, chunk: Chunk) -> None:
        """See `Scan.check`."""
        if chunk.is_compressed:
            check_claimed_size(chunk.size, chunk.data_size)
        if chunk.end > self.source.size:
            raise ChunkDamage("it reaches beyond the end of the file")

    def parse(self, chunk: Chunk, stored: memoryview, target: Bytes) -> ChunkContent:
        """See `Scan.parse`."""
        return parse_bag_chunk(chunk, stored, target, self._format)

    def contradictions(self, content: ChunkContent, data: Bytes, chunk: Chunk) -> Sequence[Loss]:
        """See `Scan.contradictions`."""
        found = {
            self.connections.contradiction(data[offset:end].tobytes(), chunk.offset): None
            for op, offset, end in content.others.tolist()
            if op == BagOp.CONNECTION
        }
        return [loss for loss in found if loss is not None]

    def own_times(self, chunk: Chunk) -> tuple[int | None, int | None] | None:
        """See `Scan.own_times`: those that the index records behind it name."""
        return indexed_times(self.source, [chunk])[0]

    @property
    def ids(self) -> Mapping[int, int]:
        """See `Scan.ids`."""
        return self.connections.channel_ids

    def _with_ids(self, read: Sequence[ReadChunk]) -> list[Chunk]:
        # Those in chunks come first: a compressed chunk's checksum vouches for them.
        for offset, end in self._outside:
            if fault := self._connect(self.source.read(offset, end - offset), offset):
                what = f"the connection record at byte {offset} is damaged ({fault})"
                self._losses.add(Loss(offset, what))
        return super()._with_ids(read)

    def _channels(self) -> Mapping[int, Channel]:
        return self.connections.channels

    def _profile(self) -> str:
        return "ros1"


def _times_hold(source: ByteSource, chunks: Sequence[Chunk]) -> bool:
    """Tell whether the index records behind chunks confirm when the log begins and ends.

    They are compared for the first and the last chunk, in the file and by the times stated.
    """
    if not chunks:
        return True
    by_time = (
        min(chunks, key=lambda chunk: chunk.start_time or 0),
        max(chunks, key=lambda chunk: chunk.end_time or 0),
    )
    compared = {each.offset: each for each in (chunks[0], chunks[-1], *by_time)}.values()
    found = indexed_times(source, list(compared))
    return all(
        times in {None, (chunk.start_time, chunk.end_time)}
        for chunk, times in zip(compared, found, strict=True)
    )


def open_log(source: ByteSource, distribution: str) -> ChunkedLog:
    """Open a bag."""
    del distribution
    return open_chunked(BagScan, source)
