"""A walk over all records of a bag, for what its index should have told."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Final

from dogbot_logtool.core.geometry.arrays import Bytes
from dogbot_logtool.reader.containers.bag.chunk import check_bag_chunk, chunk_at, parse_bag_chunk
from dogbot_logtool.reader.containers.bag.format import BagFormat, is_sound
from dogbot_logtool.reader.containers.bag.index import Connections, chunk_info
from dogbot_logtool.reader.containers.bag.records import (
    BagOp,
    MalformedRecord,
    record_at,
    record_in_file,
)
from dogbot_logtool.reader.containers.log import Chunk, ChunkContent, ChunkDamage, Contents, Loss
from dogbot_logtool.reader.containers.signatures import BAG_MAGIC
from dogbot_logtool.reader.containers.source import ByteSource
from dogbot_logtool.reader.salvage.losses import Losses
from dogbot_logtool.reader.salvage.survey import Stated, Survey

_LARGEST_PADDING: Final = 4096


class BagSurvey(Survey):
    """Finds chunks, bare messages and connections."""

    def __init__(self, source: ByteSource, connections: Connections) -> None:
        self._bag_format = BagFormat()
        super().__init__(source, self._bag_format, Losses())
        self._connections = connections
        self._outside: list[tuple[int, int]] = []
        """Places of connection records outside chunks."""

    def contents(self, problem: Loss | None) -> Contents:
        """Walk the file."""
        contents = self._contents(len(BAG_MAGIC), problem)
        channels = self._connections.channels
        return replace(
            contents,
            channels=channels,
            counts={**dict.fromkeys(channels, 0), **contents.counts},
            profile="ros1",
            losses=self._losses.told(),
        )

    def _step(self, place: int) -> int | None:
        try:
            record = record_in_file(self._source, place)
            if record.fields.has("compression"):
                return self._chunk_record(place)
            op = record.fields.op()
            if record.end > self._source.size or not is_sound(record, op):
                return None
            if op == BagOp.MESSAGE:
                return self._bare(place, record.end)
            self._record(op, place, record.end)
        except (MalformedRecord, ChunkDamage):
            if self._source.read(place, len(BAG_MAGIC)) == BAG_MAGIC:
                return self._end(place)
            return self._passed_zeros(place)
        return record.end

    def _record(self, op: int, place: int, end: int) -> None:
        match op:
            case BagOp.INDEX:
                if self._chunks and self._chunks[-1].index_end == place:
                    self._chunks[-1] = replace(self._chunks[-1], index_end=end)
            case BagOp.CONNECTION:
                self._outside.append((place, end))
            case BagOp.CHUNK_INFO:
                data = self._source.read(place, end - place)
                info = chunk_info(record_at(data, 0, len(data)), data)
                self._stated[info.offset] = Stated(info.start_time, info.end_time, info.counts)

    def _chunk_record(self, place: int) -> int:
        chunk = chunk_at(self._source, place)
        if chunk.is_compressed:
            return self._chunk(chunk, chunk.end)
        stated = record_in_file(self._source, place).fields.u32("size")
        return self._chunk(replace(chunk, data_size=stated), chunk.data_offset + stated)

    def _passed_zeros(self, place: int) -> int | None:
        """Pass over the zero bytes that some recorders leave before the index."""
        window = self._source.read(place, _LARGEST_PADDING)
        zeros = len(window) - len(window.lstrip(b"\0"))
        # The length of the next record's header ends with zeros, but does not begin with one.
        following = place + zeros
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
        for place, end in self._outside:
            try:
                self._connect(self._source.read(place, end - place), place)
            except MalformedRecord as fault:
                what = f"the connection record at byte {place} is damaged ({fault})"
                self._losses.add(Loss(place, what))
        return self._connections.channel_ids
