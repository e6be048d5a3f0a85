"""A walk over all records of a bag, for what its index should have told."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Final

from dogbot_logtool.reader.bag_chunk import check_bag_chunk, chunk_at, parse_bag_chunk
from dogbot_logtool.reader.bag_format import BagFormat
from dogbot_logtool.reader.bag_index import Connections, chunk_info
from dogbot_logtool.reader.bag_records import (
    MAGIC,
    BagOp,
    MalformedRecord,
    record_at,
    record_in_file,
)
from dogbot_logtool.reader.columns import Bytes
from dogbot_logtool.reader.log import Chunk, ChunkContent, ChunkDamage, Contents, Loss
from dogbot_logtool.reader.source import ByteSource
from dogbot_logtool.reader.survey import Stated, Survey

_LARGEST_PADDING: Final = 4096


class BagSurvey(Survey):
    """Finds chunks, bare messages and connections."""

    def __init__(self, source: ByteSource, connections: Connections) -> None:
        super().__init__(source, BagFormat())
        self._connections = connections

    def contents(self, problem: Loss | None) -> Contents:
        """Walk the file."""
        contents = self._contents(len(MAGIC), problem)
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
            op = record.fields.op()
            if op == BagOp.CHUNK:
                return self._chunk_record(place)
            if record.end > self._source.size:
                return None
            if op == BagOp.MESSAGE:
                return self._bare(place, record.end)
            self._record(op, place, record.end)
        except (MalformedRecord, ChunkDamage):
            return self._passed_zeros(place)
        return record.end

    def _record(self, op: int, place: int, end: int) -> None:
        match op:
            case BagOp.INDEX:
                if self._chunks and self._chunks[-1].index_end == place:
                    self._chunks[-1] = replace(self._chunks[-1], index_end=end)
            case BagOp.CONNECTION:
                self._connect(self._source.read(place, end - place))
            case BagOp.CHUNK_INFO:
                data = self._source.read(place, end - place)
                info = chunk_info(record_at(data, 0, len(data)), data)
                self._stated[info.offset] = Stated(info.start_time, info.end_time, info.counts)
            case BagOp.BAG_HEADER:
                pass
            case _:
                raise MalformedRecord("a record of an unknown kind")

    def _chunk_record(self, place: int) -> int:
        chunk = chunk_at(self._source, place)
        derived_end = chunk.end if chunk.is_compressed else chunk.data_offset + chunk.size
        return self._chunk(chunk, derived_end)

    def _passed_zeros(self, place: int) -> int | None:
        """Pass over the zero bytes that some recorders leave before the index."""
        window = self._source.read(place, _LARGEST_PADDING)
        zeros = len(window) - len(window.lstrip(b"\0"))
        # The length of the next record's header ends with zeros, but does not begin with one.
        following = place + zeros
        if zeros and following < self._source.size and self._follows(following):
            return following
        return None

    def _connect(self, data: bytes) -> None:
        record = record_at(data, 0, len(data))
        content = memoryview(data)[record.data : record.end]
        if self._may_describe(len(self._connections.channels), len(content)):
            self._connections.add(record.fields, content)

    def _describe(self, op: int, record: Bytes) -> None:
        try:
            if op == BagOp.CONNECTION:
                self._connect(record.tobytes())
        except MalformedRecord:
            return

    def _parse(self, chunk: Chunk, stored: memoryview, target: Bytes) -> ChunkContent:
        return parse_bag_chunk(chunk, stored, target)

    def _check(self, chunk: Chunk) -> None:
        check_bag_chunk(chunk, self._source.size)

    def _ids(self) -> Mapping[int, int]:
        return self._connections.channel_ids
