"""A scan of all records of a bag whose index is missing or wrong."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Final

from dogbot_logtool.core.arrays import Bytes
from dogbot_logtool.reader.containers.bag.chunk import check_bag_chunk, chunk_at, parse_bag_chunk
from dogbot_logtool.reader.containers.bag.format import BagFormat, is_sound
from dogbot_logtool.reader.containers.bag.index import Connections, chunk_info
from dogbot_logtool.reader.containers.bag.records import (
    BagOp,
    MalformedRecord,
    record_at,
    record_in_file,
)
from dogbot_logtool.reader.containers.chunks.chunk_content import ChunkContent, ChunkDamage
from dogbot_logtool.reader.containers.chunks.recovery_scan import IndexEntry, RecoveryScan
from dogbot_logtool.reader.containers.contents import Chunk, Contents
from dogbot_logtool.reader.containers.loss import Loss, Losses
from dogbot_logtool.reader.containers.signatures import BAG_MAGIC
from dogbot_logtool.reader.containers.sources.source import ByteSource

_LARGEST_PADDING: Final = 4096


class BagRecoveryScan(RecoveryScan):
    """Finds chunks, bare messages and connections."""

    def __init__(self, source: ByteSource, connections: Connections) -> None:
        self._bag_format = BagFormat()
        super().__init__(source, self._bag_format, Losses())
        self._connections = connections
        self._outside: list[tuple[int, int]] = []
        """Offset and end of connection records outside chunks."""

    def contents(self, problem: Loss | None) -> Contents:
        """Walk the file."""
        contents = self._contents(len(BAG_MAGIC), problem)
        channels = self._connections.channels
        return replace(
            contents,
            channels=channels,
            counts={**dict.fromkeys(channels, 0), **contents.counts},
            profile="ros1",
            losses=self._losses.all(),
        )

    def _step(self, offset: int) -> int | None:
        try:
            record = record_in_file(self._source, offset)
            if record.fields.has("compression"):
                return self._chunk_record(offset)
            op = record.fields.op()
            if record.end > self._source.size or not is_sound(record, op):
                return None
            if op == BagOp.MESSAGE:
                return self._bare(offset, record.end)
            self._record(op, offset, record.end)
        except (MalformedRecord, ChunkDamage):
            if self._source.read(offset, len(BAG_MAGIC)) == BAG_MAGIC:
                return self._end(offset)
            return self._passed_zeros(offset)
        return record.end

    def _record(self, op: int, offset: int, end: int) -> None:
        match op:
            case BagOp.INDEX:
                if self._chunks and self._chunks[-1].index_end == offset:
                    self._chunks[-1] = replace(self._chunks[-1], index_end=end)
            case BagOp.CONNECTION:
                self._outside.append((offset, end))
            case BagOp.CHUNK_INFO:
                data = self._source.read(offset, end - offset)
                info = chunk_info(record_at(data, 0, len(data)), data)
                self._index_entries[info.offset] = IndexEntry(
                    info.start_time, info.end_time, info.counts
                )

    def _chunk_record(self, offset: int) -> int:
        chunk = chunk_at(self._source, offset)
        if chunk.is_compressed:
            return self._chunk(chunk, chunk.end)
        stated = record_in_file(self._source, offset).fields.u32("size")
        return self._chunk(replace(chunk, data_size=stated), chunk.data_offset + stated)

    def _passed_zeros(self, offset: int) -> int | None:
        """Pass over the zero bytes that some recorders leave before the index."""
        window = self._source.read(offset, _LARGEST_PADDING)
        zeros = len(window) - len(window.lstrip(b"\0"))
        # The length of the next record's header ends with zeros, but does not begin with one.
        following = offset + zeros
        if zeros and following < self._source.size and self._follows(following):
            return following
        return None

    def _connect(self, data: bytes, offset: int) -> None:
        record = record_at(data, 0, len(data))
        self._connections.add(record.fields, memoryview(data)[record.data : record.end])
        loss = self._connections.contradiction(data, offset)
        if loss is not None:
            self._losses.add(loss)

    def _describe(self, op: int, record: Bytes, chunk: Chunk) -> None:
        try:
            if op == BagOp.CONNECTION:
                self._connect(record.tobytes(), chunk.offset)
        except MalformedRecord:
            return

    def _parse(self, chunk: Chunk, stored: memoryview, target: Bytes) -> ChunkContent:
        return parse_bag_chunk(chunk, stored, target, self._bag_format)

    def _check(self, chunk: Chunk) -> None:
        check_bag_chunk(chunk, self._source.size)

    def _settle_ids(self) -> Mapping[int, int]:
        # Those in chunks come first: a compressed chunk's checksum vouches for them.
        for offset, end in self._outside:
            try:
                self._connect(self._source.read(offset, end - offset), offset)
            except MalformedRecord as fault:
                what = f"the connection record at byte {offset} is damaged ({fault})"
                self._losses.add(Loss(offset, what))
        return self._connections.channel_ids
