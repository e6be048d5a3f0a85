"""The chunks and connections of a ROS 1 bag: by its index, or by all of its records."""

import sys
from collections.abc import Mapping
from dataclasses import replace
from itertools import pairwise
from typing import Final

import numpy as np

from dogbot_logtool.reader.containers.bag.records import (
    HEAD_SIZE,
    INDEX_ENTRY_SIZE,
    BagFormat,
    BagOp,
    MalformedRecord,
    Record,
    channel_id,
    header_fields,
    nanoseconds,
    record_at,
    record_in_file,
)
from dogbot_logtool.reader.containers.descriptions import Description
from dogbot_logtool.reader.containers.log import Channel, Chunk, Schema
from dogbot_logtool.reader.containers.loss import Loss, lost_messages
from dogbot_logtool.reader.containers.record_log import (
    RecordLog,
    Times,
    UnusableIndex,
    open_records,
)
from dogbot_logtool.reader.containers.registry import BAG_MAGIC
from dogbot_logtool.reader.containers.salvage import Index, IndexRecord, read_index
from dogbot_logtool.reader.containers.source import ByteSource

_MOST_CONNECTIONS: Final = 0xFFFF
"""As many as an MCAP can have channels: they are numbered from 0 on."""
_LARGEST_PADDING: Final = 4096
"""Some recorders leave zero bytes before the index."""
_INDEX_RECORD_SIZE: Final = 55
"""Bytes of an index record besides its entries, as every recorder writes it."""
_INDEX_ENTRY: Final = np.dtype([("seconds", "<u4"), ("nanoseconds", "<u4"), ("offset", "<u4")])
_DAMAGED_INDEX: Final = "the bag's index is damaged; the bag was read without it"
_NOT_CLOSED: Final = "the bag has no index (its recording was not closed); it was read without it"


class BagLog(RecordLog):
    """Finds chunks, bare messages and connections."""

    container = "ROS 1 bag"
    profile = "ros1"
    magic = BAG_MAGIC

    def __init__(self, source: ByteSource) -> None:
        super().__init__(source, _connection)
        self._format = BagFormat()
        self._chunks_missing = 0
        """Chunks that the header of a closed bag counts, less those met."""

    def use_index(self) -> None:
        """See `RecordLog.use_index`."""
        start = len(BAG_MAGIC)
        try:
            header = record_in_file(self.source.read, start)
            index_start = header.number("index_pos", 8)
            is_true = index_start > 0 and self._agrees(index_start, header.number("chunk_count"))
        except MalformedRecord:
            index_start, is_true = -1, False
        if not is_true:
            raise UnusableIndex(Loss(start, _DAMAGED_INDEX if index_start else _NOT_CLOSED))
        self._finish(self._counted())

    def _agrees(self, index_start: int, chunk_count: int) -> bool:
        """Tell whether the index agrees with itself and with the file.

        Raises:
            MalformedRecord: a record is damaged.
        """
        if not self._holds(index_start, self.source.size, {}) or self._take_outside():
            return False
        self.channels = self._described_channels()
        return (
            len(self._stated) == chunk_count
            and self._holds(len(BAG_MAGIC), index_start, self._indexed_chunks(index_start))
            and self._times_hold()
        )

    def _conclude(self) -> None:
        stated = sum(sum(each["counts"].values()) for each in self._stated.values())
        found, known_lost = sum(self.counts.values()), lost_messages(self._losses)
        if known_lost is None:
            return
        if stated > found + known_lost:
            what = f"the bag's index counts {stated} messages, but {found} were found"
            self._losses.append(Loss(0, what, 0, None))
        elif not self._stated and self._chunks_missing > 0:
            what = f"the file was cut off: its header counts {self._chunks_missing} more chunks"
            self._losses.append(Loss(self.source.size, what, 0, None))

    def _take_info(self, record: Record) -> None:
        """Take what an index record says of a chunk.

        Raises:
            MalformedRecord: it is damaged.
        """
        data = self.source.read(record.data, record.end - record.data)
        counts = {
            channel_id(connection): count
            for connection, count in np.frombuffer(data, "<u4").reshape(-1, 2).tolist()
        }
        times = {name: record.time_ns(name) for name in ("start_time", "end_time")}
        self._stated[record.number("chunk_pos", 8)] = {**times, "counts": counts}

    def _indexed_chunks(self, index_start: int) -> dict[int, Chunk]:
        """Return the chunks that the index names, by their offsets."""
        offsets = sorted(self._stated)
        heads = self.source.read_many([(offset, HEAD_SIZE) for offset in offsets])
        chunks: dict[int, Chunk] = {}
        for (offset, end), head in zip(pairwise([*offsets, index_start]), heads, strict=True):
            own = _chunk(offset, record_in_file(self.source.read, offset, head))
            chunk = own._replace(**self._stated[offset])
            counts = chunk.counts or {}
            if not counts.keys() <= self.channels.keys():
                raise MalformedRecord
            named = _INDEX_RECORD_SIZE * len(counts) + INDEX_ENTRY_SIZE * sum(counts.values())
            # Index records of the usual size need not be looked at.
            is_usual = end - chunk.end == named
            chunks[offset] = chunk._replace(index_end=end) if is_usual else chunk
        return chunks

    def _times_hold(self) -> bool:
        """Tell whether the index records behind chunks confirm when the log begins and ends.

        They are compared for the first and the last chunk, in the file and by the times stated.
        """
        chunks = self.chunks
        first = sorted(chunks, key=lambda chunk: chunk.start_time or 0)[:1]
        last = sorted(chunks, key=lambda chunk: chunk.end_time or 0)[-1:]
        return all(
            self._own_times(chunk) in {(None, None), (chunk.start_time, chunk.end_time)}
            for chunk in (*chunks[:1], *chunks[-1:], *first, *last)
        )

    def _step(self, offset: int) -> int | None:
        try:
            record = record_in_file(self.source.read, offset)
            if "compression" in record.fields:
                return self._chunk_record(offset, record)
            op = record.op()
            if record.end > self.source.size or not record.is_sound():
                return None
            if op == BagOp.MESSAGE:
                return self._bare(offset, record.end)
            if op == BagOp.INDEX:
                self._take_index(offset, record.end)
            elif op == BagOp.CONNECTION:
                self._outside.append((offset, record.end))
            elif op == BagOp.CHUNK_INFO:
                self._take_info(record)
            elif op == BagOp.BAG_HEADER and "chunk_count" in record.fields:
                self._chunks_missing += record.number("chunk_count")
        except MalformedRecord:
            if self.source.read(offset, len(BAG_MAGIC)) == BAG_MAGIC:
                return self._end(offset)
            return self._passed_zeros(offset)
        return record.end

    def _chunk_record(self, offset: int, record: Record) -> int | None:
        chunk = _chunk(offset, record)
        self._chunks_missing -= 1
        if chunk.is_compressed:
            return self._take_chunk(chunk, chunk.end)
        stated = record.number("size")
        return self._take_chunk(
            chunk._replace(data_size=stated, size=stated), chunk.data_offset + stated
        )

    def _passed_zeros(self, offset: int) -> int | None:
        """Pass over the zero bytes that some recorders leave before the index."""
        window = self.source.read(offset, _LARGEST_PADDING)
        zeros = len(window) - len(window.lstrip(b"\0"))
        # The length of the next record's header ends with zeros, but does not begin with one.
        following = offset + zeros
        if zeros and following < self.source.size and self._follows(following):
            return following
        return None

    def _index_of(self, behind: memoryview) -> Index | None:
        return read_index(behind, _index_record, _INDEX_ENTRY, nanoseconds)

    def overlaps(self, chunk: Chunk, start: int | None, end: int | None) -> bool:
        """See `Log.overlaps`: a chunk is left out only if the index records behind it agree.

        These are not fetched from a store.
        """
        if super().overlaps(chunk, start, end):
            return True
        if chunk.is_scanned or not self.source.has_cheap_seeks:
            return False
        first, last = self._own_times(chunk)
        return super().overlaps(chunk._replace(start_time=first, end_time=last), start, end)

    def _own_times(self, chunk: Chunk) -> Times:
        """Return the log times, ns, that the index records behind a chunk name."""
        index = self._index_of(memoryview(self.source.read(chunk.end, chunk.index_end - chunk.end)))
        if index is None or not index.complete or not len(index.log_time):
            return None, None
        return int(index.log_time.min()), int(index.log_time.max())

    def _described_channels(self) -> Mapping[int, Channel]:
        schemas: dict[Schema | None, Schema] = {}
        channels: dict[int, Channel] = {}
        for _, _, _, channel in self.descriptions.of_kind("connection"):
            new = channel.schema._replace(id=len(schemas) + 1)
            schema = schemas.setdefault(channel.schema, new)
            channels[channel.id] = replace(channel, schema=schema)
        return channels


def _chunk(offset: int, record: Record) -> Chunk:
    """Return a chunk by the header of its record; its data may reach beyond the file's end.

    Raises:
        MalformedRecord: its header makes no sense.
    """
    compression = record.raw("compression").decode("utf-8", "replace")
    size, data_size = record.number("size"), record.end - record.data
    return Chunk(
        offset=offset,
        data_offset=record.data,
        data_size=data_size,
        end=record.end,
        index_end=record.end,
        compression=sys.intern(compression),
        size=data_size if compression in {"", "none"} else size,
    )


def _connection(record: bytes) -> Description | None:
    """Decode a connection record: its data is the header that the publisher sent."""
    try:
        found = record_at(record, 0)
        number = found.number("conn")
        # The topic of the record is the one under which it was recorded, after any remapping.
        topic = found.raw("topic").decode("utf-8", "replace")
        header = header_fields(record[found.data : found.end])
    except MalformedRecord:
        return None
    texts = {key: value.decode("utf-8", "replace") for key, (_, value) in header.items()}
    schema = Schema(
        0, texts.pop("type", ""), "ros1msg", texts.pop("message_definition", "").encode()
    )
    texts.pop("topic", None)
    channel = Channel(channel_id(number), topic, "ros1", schema, texts)
    described = Description("connection", number, f"{topic} of type {schema.name}", channel)
    return described if schema.name and number < _MOST_CONNECTIONS else None


def _index_record(behind: memoryview, offset: int) -> IndexRecord | None:
    try:
        record = record_at(behind, offset)
        if record.op() != BagOp.INDEX:
            return None
        connection = record.number("conn")
    except MalformedRecord:
        return None
    return channel_id(connection), behind[record.data : record.end], record.end


def open_log(source: ByteSource, distribution: str) -> RecordLog:
    """Open a bag."""
    del distribution
    return open_records(BagLog, source)
