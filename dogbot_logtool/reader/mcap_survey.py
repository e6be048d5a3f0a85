"""A walk over all records of an MCAP file, for what its summary should have told."""

from dataclasses import replace
from typing import Final

import numpy as np
from mcap import records
from mcap.opcode import Opcode

from dogbot_logtool.reader.log import Chunk, ChunkDamage, Contents, Extra, Loss, Schema
from dogbot_logtool.reader.mcap_chunk import check_chunk, chunk_at, parse_chunk
from dogbot_logtool.reader.mcap_records import (
    MAGIC,
    RECORD_HEAD,
    channel_of,
    decode_record,
    schema_of,
)
from dogbot_logtool.reader.source import ByteSource

_REGION_SIZE: Final = 1 << 20
"""Messages outside chunks are read in runs of about this many bytes."""


class Survey:
    """A walk over all records of the file, for what its summary should have told."""

    def __init__(self, source: ByteSource) -> None:
        self._source = source
        self._schemas: dict[int, Schema] = {}
        self._channels: dict[int, records.Channel] = {}
        self._chunks: list[Chunk] = []
        self._extras: list[Extra] = []
        self._losses: list[Loss] = []
        self._region: int | None = None

    def contents(self, problem: Loss | None) -> Contents:
        """Walk the file."""
        if problem is not None:
            self._losses.append(problem)
        self._walk()
        chunks = [self._look_into(chunk) for chunk in self._chunks]
        counts = dict.fromkeys(self._channels, 0)
        for chunk in chunks:
            for channel, count in (chunk.counts or {}).items():
                counts[channel] = counts.get(channel, 0) + count
        times = [time for c in chunks for time in (c.start_time, c.end_time) if time is not None]
        return Contents(
            channels={
                channel.id: channel_of(channel, self._schemas)
                for channel in self._channels.values()
            },
            chunks=chunks,
            counts=counts,
            start_time=min(times, default=None),
            end_time=max(times, default=None),
            extras=self._extras,
            losses=self._losses,
        )

    def _walk(self) -> None:
        place, size = len(MAGIC), self._source.size
        while place < size:
            head = self._source.read(place, RECORD_HEAD.size)
            content = place + RECORD_HEAD.size
            opcode, length = RECORD_HEAD.unpack(head) if len(head) == RECORD_HEAD.size else (0, 0)
            if not opcode or opcode >= 0x80 or length > size - content:
                self._end_region(place)
                self._cut_off(place)
                return
            if opcode == Opcode.MESSAGE:
                self._bare_message(place, content + length)
            else:
                self._end_region(place)
                if opcode in {Opcode.DATA_END, Opcode.FOOTER}:
                    return
                self._record(opcode, place, content, length)
            place = content + length

    def _record(self, opcode: int, place: int, content: int, length: int) -> None:
        match opcode:
            case Opcode.SCHEMA | Opcode.CHANNEL:
                self._describe(opcode, self._source.read(content, length))
            case Opcode.CHUNK:
                self._chunk(place, content, length)
            case Opcode.MESSAGE_INDEX:
                if self._chunks and self._chunks[-1].index_end == place:
                    self._chunks[-1] = replace(self._chunks[-1], index_end=content + length)
            case Opcode.ATTACHMENT | Opcode.METADATA:
                self._extras.append(Extra(opcode, place, content + length - place))

    def _describe(self, opcode: int, body: bytes | memoryview) -> None:
        if opcode == Opcode.SCHEMA:
            schema = decode_record(records.Schema, body)
            if schema is not None:
                self._schemas[schema.id] = schema_of(schema)
        else:
            channel = decode_record(records.Channel, body)
            if channel is not None:
                self._channels.setdefault(channel.id, channel)

    def _bare_message(self, place: int, end: int) -> None:
        if self._region is None:
            self._region = place
        elif end - self._region >= _REGION_SIZE:
            self._end_region(place)
            self._region = place

    def _end_region(self, end: int) -> None:
        if self._region is not None:
            size = end - self._region
            self._chunks.append(Chunk(self._region, self._region, size, end, end, "", size))
            self._region = None

    def _chunk(self, place: int, content: int, length: int) -> None:
        try:
            self._chunks.append(chunk_at(self._source, place, content, length))
        except ChunkDamage as damage:
            what = f"the chunk at byte {place} was left out: {damage}"
            self._losses.append(Loss(place, what, length, None))

    def _cut_off(self, place: int) -> None:
        lost = self._source.size - place
        what = f"the {lost} bytes from byte {place} on are no whole record"
        self._losses.append(Loss(place, what, lost, None))

    def _look_into(self, chunk: Chunk) -> Chunk:
        """Read a chunk for its counts, times and descriptions; damage is told by the reader."""
        try:
            check_chunk(chunk, self._source.size)
            stored = self._source.read(chunk.offset, chunk.index_end - chunk.offset)
            target = np.empty(chunk.size, np.uint8)
            content = parse_chunk(chunk, memoryview(stored), target)
        except ChunkDamage:
            return chunk
        for opcode, start, end in content.others:
            if opcode in {Opcode.SCHEMA, Opcode.CHANNEL}:
                self._describe(opcode, target[start:end].tobytes())
        messages = content.messages
        if not len(messages):
            return replace(chunk, counts={}, start_time=None, end_time=None)
        channels, counts = np.unique(messages.channel, return_counts=True)
        return replace(
            chunk,
            counts=dict(zip(channels.tolist(), counts.tolist(), strict=True)),
            start_time=int(messages.log_time.min()),
            end_time=int(messages.log_time.max()),
        )
