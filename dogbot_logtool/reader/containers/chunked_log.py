"""Logs whose messages lie in chunk records: ROS 1 bags and MCAP files."""

from abc import abstractmethod
from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np
from zlib_ng.zlib_ng import crc32

from dogbot_logtool.core.arrays import Bytes
from dogbot_logtool.reader.containers.compression import check_claimed_size, decompress_into
from dogbot_logtool.reader.containers.descriptions import Descriptions
from dogbot_logtool.reader.containers.log import Batch, Chunk, LoadedChunk, Log, Span
from dogbot_logtool.reader.containers.loss import Loss
from dogbot_logtool.reader.containers.salvage.content import (
    ChunkContent,
    ChunkDamage,
    left_out,
    read_content,
    undescribed,
)
from dogbot_logtool.reader.containers.salvage.records import Index, RecordFormat
from dogbot_logtool.reader.containers.source import ByteSource
from dogbot_logtool.reader.decode.message_table import Messages, concatenate_messages

_ROUND_SIZE: Final = 1 << 20

Times = tuple[int | None, int | None]
"""ns, of a first and a last message; None: not known."""


class ChunkedLog(Log):
    """A log of one file that is read by decompressing its chunks."""

    describing: frozenset[int]
    """Kinds of the records that describe channels."""

    def __init__(self, source: ByteSource, fmt: RecordFormat, descriptions: Descriptions) -> None:
        super().__init__(source)
        self.descriptions = descriptions
        self._format = fmt
        self._only_batch: Batch | None = None

    @abstractmethod
    def _index_of(self, behind: memoryview) -> Index | None:
        """Return what the records behind a chunk name."""

    def _checksum(self, chunk: Chunk, stored: memoryview) -> tuple[int, tuple[Loss, ...]]:
        """Return the CRC of a chunk, 0 for none, and what its own header contradicts."""
        del chunk, stored
        return 0, ()

    @abstractmethod
    def _own_times(self, chunk: Chunk) -> Times:
        """Return the log times, ns, that a chunk itself tells."""

    def _read(self, span: Span) -> Batch:
        """See `Log.read`. A batch that is the whole log is read several times, so it is kept."""
        if len(span) < len(self.chunks):
            return self._of_chunks(span)
        if self._only_batch is None:
            self._only_batch = self._of_chunks(span)
        return self._only_batch

    def located(self, loss: Loss) -> Loss:
        """See `Log.located`. The times are those of its chunk, or of the chunks around it."""
        if not loss.offset:
            return loss
        first, behind = (
            bisect_left(self.chunks, byte, key=lambda chunk: chunk.offset)
            for byte in (loss.offset, loss.offset + max(loss.bytes, 1))
        )
        if behind > first and self.chunks[first].offset == loss.offset:
            chunk = self.chunks[first]
            return replace(loss, start_time=chunk.start_time, end_time=chunk.end_time)
        before = self.chunks[first - 1].end_time if first else None
        after = self.chunks[behind].start_time if behind < len(self.chunks) else None
        if before is not None and after is not None:
            before, after = sorted((before, after))
        return replace(loss, start_time=before, end_time=after)

    def overlaps(self, chunk: Chunk, start: int | None, end: int | None) -> bool:
        """See `Log.overlaps`: a chunk is left out only if what stands in it or behind it agrees.

        That is not fetched from a store.
        """
        if super().overlaps(chunk, start, end):
            return True
        if chunk.is_scanned or not self.source.has_cheap_seeks:
            return False
        first, last = self._own_times(chunk)
        return super().overlaps(replace(chunk, start_time=first, end_time=last), start, end)

    def check(self, chunk: Chunk) -> None:
        """Check what a chunk claims before memory is set aside for it.

        Raises:
            ChunkDamage: it cannot be true.
        """
        check_claimed_size(chunk.size, chunk.data_size)
        if chunk.data_offset + chunk.data_size > self.source.size:
            raise ChunkDamage("it is cut off by the end of the file")

    def parse(self, chunk: Chunk, stored: memoryview, target: Bytes) -> ChunkContent:
        """Decompress a chunk into the target and find its messages.

        Args:
            chunk: the chunk.
            stored: the file's bytes from `chunk.offset` to `chunk.index_end`, or fewer.
            target: (chunk.size,) uint8.

        Raises:
            ChunkDamage: nothing in the chunk can be trusted.
        """
        index = self._index_of(stored[chunk.end - chunk.offset :])
        data = stored[chunk.data_offset - chunk.offset :][: chunk.data_size]
        try:
            crc, losses = self._checksum(chunk, stored) if chunk.is_record else (0, ())
            size = decompress_into(target, data, chunk.compression)
            if size < len(target) and (crc or not size):
                raise ChunkDamage(f"its {chunk.compression} data is damaged or cut off")
            if crc and crc32(target.data) != crc:
                raise ChunkDamage("its checksum does not hold")
            if losses and not crc:
                raise ChunkDamage("its header is damaged, and it has no checksum")
        except ChunkDamage as damage:
            raise ChunkDamage(str(damage), len(index.offset) if index else None) from damage
        content = read_content(self._format, target[:size], index, chunk, verified=bool(crc))
        return replace(content, losses=(*losses, *content.losses))

    def _descriptions_in(self, content: ChunkContent, data: Bytes) -> list[bytes]:
        """Return the records of a chunk, whose bytes are given, that describe channels."""
        return [
            data[start:end].tobytes()
            for op, start, end in content.others.tolist()
            if op in self.describing
        ]

    def _of_chunks(self, span: Sequence[Chunk]) -> Batch:
        sound: list[Chunk] = []
        losses: list[Loss] = []
        for chunk in span:
            try:
                self.check(chunk)
                sound.append(chunk)
            except ChunkDamage as damage:
                losses.append(left_out(chunk, damage))
        ranges = [(chunk.offset, chunk.index_end - chunk.offset) for chunk in sound]
        stored = [memoryview(data) for data in self.source.read_many(ranges)]

        size = sum(chunk.size for chunk in sound)
        # The allocator reuses blocks of the same size, which keeps each process smaller.
        buffer = np.empty(size + -size % _ROUND_SIZE, np.uint8)[:size]
        loaded: list[LoadedChunk] = []
        parts: list[Messages] = []
        base = row = 0
        for chunk, data in zip(sound, stored, strict=True):
            target = buffer[base : base + chunk.size]
            try:
                content = self.parse(chunk, data, target)
            except ChunkDamage as damage:
                losses.append(left_out(chunk, damage))
                continue
            described = self._descriptions_in(content, target)
            messages, found = self._described(chunk, content)
            found += self.descriptions.compare(described, chunk.offset)
            rows = slice(row, row + len(messages))
            has_index = len(data) > chunk.end - chunk.offset
            whole = (
                chunk.is_record
                and not found
                and content.indexed == has_index
                and (not self.hidden or self._are_kept(described))
            )
            copied = data if self.copies_chunks else memoryview(b"")
            loaded.append(LoadedChunk(chunk, copied, base, rows, whole, content.indexed))
            parts.append(messages.shifted(base))
            losses.extend(() if chunk.is_scanned else found)
            base, row = base + chunk.size, rows.stop
        located = tuple(map(self.located, losses))
        return Batch(buffer, concatenate_messages(parts), tuple(loaded), located)

    def _are_kept(self, described: Sequence[bytes]) -> bool:
        """Tell whether records describe no other channels than those that are not left out."""
        kept = {("channel", number) for number in self.channels}
        kept |= {("schema", each.schema.id) for each in self.channels.values() if each.schema}
        found = map(self.descriptions.decode, described)
        return all(each and (each.kind, each.number) in kept for each in found)

    def _described(self, chunk: Chunk, content: ChunkContent) -> tuple[Messages, list[Loss]]:
        """Leave out messages whose channels are nowhere described."""
        messages, losses = content.messages, list(content.losses)
        known = np.isin(messages.channel, [*self.channels, *self.hidden])
        if not known.all():
            losses.append(undescribed(chunk, messages.pick(~known)))
            messages = messages.pick(known)
        return messages, losses
