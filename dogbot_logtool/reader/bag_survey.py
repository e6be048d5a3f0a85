"""A walk over all records of a bag, for what its index should have told."""

from dataclasses import replace

import numpy as np

from dogbot_logtool.reader.bag_chunk import check_bag_chunk, chunk_at, parse_bag_chunk
from dogbot_logtool.reader.bag_index import Connections, contents_of
from dogbot_logtool.reader.bag_records import (
    MAGIC,
    BagOp,
    MalformedRecord,
    record_at,
    record_in_file,
)
from dogbot_logtool.reader.log import Chunk, ChunkDamage, Contents, Loss
from dogbot_logtool.reader.source import ByteSource


class BagSurvey:
    """Finds the chunks by following the records, and the connections inside the chunks."""

    def __init__(self, source: ByteSource, connections: Connections) -> None:
        self._source = source
        self._connections = connections
        self._chunks: list[Chunk] = []
        self._losses: list[Loss] = []

    def contents(self, problem: Loss | None) -> Contents:
        """Walk the file."""
        if problem is not None:
            self._losses.append(problem)
        self._walk()
        chunks = [self._look_into(chunk) for chunk in self._chunks]
        return contents_of(self._connections, chunks, self._losses)

    def _walk(self) -> None:
        place, size = len(MAGIC), self._source.size
        while place < size:
            try:
                record = record_in_file(self._source, place)
                op = record.fields.op()
                if record.end > size:
                    raise MalformedRecord("a record is cut off")
                self._record(op, place, record.end)
            except (MalformedRecord, ChunkDamage):
                what = f"the {size - place} bytes from byte {place} on are no whole record"
                self._losses.append(Loss(place, what, size - place, None))
                return
            place = record.end

    def _record(self, op: int, place: int, end: int) -> None:
        if op == BagOp.CHUNK:
            self._chunks.append(chunk_at(self._source, place))
        elif op == BagOp.INDEX and self._chunks and self._chunks[-1].index_end == place:
            self._chunks[-1] = replace(self._chunks[-1], index_end=end)
        elif op == BagOp.CONNECTION:
            self._connect(self._source.read(place, end - place))

    def _connect(self, data: bytes) -> None:
        record = record_at(data, 0, len(data))
        self._connections.add(record.fields, memoryview(data)[record.data : record.end])

    def _look_into(self, chunk: Chunk) -> Chunk:
        """Read a chunk for its counts, times and connections; damage is told by the reader."""
        stored = self._source.read(chunk.offset, chunk.index_end - chunk.offset)
        try:
            check_bag_chunk(chunk, self._source.size)
            target = np.empty(chunk.size, np.uint8)
            # Connections are met in the chunk itself, so each number stands for itself first.
            content = parse_bag_chunk(chunk, memoryview(stored), target, lambda number: number)
            for op, start, end in content.others:
                if op == BagOp.CONNECTION:
                    self._connect(target[start:end].tobytes())
        except (ChunkDamage, MalformedRecord):
            return chunk
        messages = content.messages
        numbers, counts = np.unique(messages.channel, return_counts=True)
        known = self._connections.channel_ids
        return replace(
            chunk,
            counts={
                known[number]: count
                for number, count in zip(numbers.tolist(), counts.tolist(), strict=True)
                if number in known
            },
            start_time=int(messages.log_time.min()) if len(messages) else None,
            end_time=int(messages.log_time.max()) if len(messages) else None,
        )
