"""Logs whose messages lie in chunk records: ROS 1 bags and MCAP files."""

from bisect import bisect_left
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from dogbot_logtool.reader.containers.batch import Batch, LoadedChunk
from dogbot_logtool.reader.containers.contents import Chunk, Contents
from dogbot_logtool.reader.containers.log import Log, Span
from dogbot_logtool.reader.containers.loss import Loss
from dogbot_logtool.reader.containers.salvage.content import (
    ChunkContent,
    ChunkDamage,
    left_out,
    undescribed,
)
from dogbot_logtool.reader.containers.salvage.scan import Scan
from dogbot_logtool.reader.containers.sources.source import ByteSource
from dogbot_logtool.reader.decode.message_table import Messages, concatenate_messages

_ROUND_SIZE: Final = 1 << 20


class ChunkedLog(Log):
    """A log of one file that is read by decompressing its chunks."""

    def __init__(self, contents: Contents, scan: Scan) -> None:
        """Take a log.

        Args:
            contents: what was found in the file.
            scan: what found it; its code reads the chunks, too.
        """
        super().__init__(scan.source, contents)
        self.container = scan.container
        self.copies_chunks = scan.copies_chunks
        self._scan = scan
        self._ids = [*contents.channels]
        self._only_batch: Batch | None = None

    def _read(self, span: Span) -> Batch:
        """See `Log.read`. A batch that is the whole log is read several times, so it is kept."""
        if len(span) < len(self.chunks):
            return self._corrected(span)
        if self._only_batch is None:
            self._only_batch = self._corrected(span)
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
        times = self._scan.own_times(chunk)
        if times is None:
            return True
        return super().overlaps(replace(chunk, start_time=times[0], end_time=times[1]), start, end)

    def _corrected(self, span: Span) -> Batch:
        """Read chunks as the log's index describes them, else as their own headers do."""
        batch, damaged = self._of_chunks(span)
        corrected = {chunk.offset: own for chunk in damaged if (own := self._own_header(chunk))}
        if not corrected:
            return self._with_times(batch)
        batch, damaged = self._of_chunks([corrected.get(chunk.offset, chunk) for chunk in span])
        readable = corrected.keys() - {chunk.offset for chunk in damaged}
        what = "the log's index is wrong about the compression or size of the chunk at byte {}; "
        what += "the chunk's own header was used"
        wrong = (Loss(offset, what.format(offset)) for offset in sorted(readable))
        return self._with_times(replace(batch, losses=(*batch.losses, *wrong)))

    def _own_header(self, chunk: Chunk) -> Chunk | None:
        """Return a chunk as its own header has it; None: that is damaged, or says the same."""
        try:
            own = self._scan.chunk_at(chunk.offset)
        except ChunkDamage:
            return None
        names = ("data_offset", "data_size", "compression", "size")
        corrected = replace(chunk, **{name: getattr(own, name) for name in names})
        is_sound = own.end == chunk.end == own.data_offset + own.data_size
        return corrected if is_sound and corrected != chunk else None

    def _with_times(self, batch: Batch) -> Batch:
        return replace(batch, losses=tuple(map(self.located, batch.losses)))

    def _of_chunks(self, span: Sequence[Chunk]) -> tuple[Batch, list[Chunk]]:
        """Read chunks; those that cannot be used are returned beside the batch."""
        sound: list[Chunk] = []
        damaged: list[Chunk] = []
        losses: list[Loss] = []
        for chunk in span:
            try:
                self._scan.check(chunk)
            except ChunkDamage as damage:
                losses.append(left_out(chunk, damage))
                damaged.append(chunk)
            else:
                sound.append(chunk)
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
                content = self._scan.parse(chunk, data, target)
            except ChunkDamage as damage:
                losses.append(left_out(chunk, damage))
                damaged.append(chunk)
                continue
            described = self._scan.described_in(content, target)
            messages, found = self._described(chunk, content)
            found += self._scan.descriptions.compare(described, chunk.offset)
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
        batch = Batch(buffer, concatenate_messages(parts), tuple(loaded), tuple(losses))
        return batch, damaged

    def _are_kept(self, described: Sequence[bytes]) -> bool:
        """Tell whether records describe no other channels than those that are not left out."""
        kept = {("channel", number) for number in self.channels}
        kept |= {("schema", each.schema.id) for each in self.channels.values() if each.schema}
        found = map(self._scan.descriptions.decode, described)
        return all(each and (each.kind, each.number) in kept for each in found)

    def _described(self, chunk: Chunk, content: ChunkContent) -> tuple[Messages, list[Loss]]:
        """Leave out messages whose channels are nowhere described."""
        messages, losses = content.messages, list(content.losses)
        known = np.isin(messages.channel, self._ids)
        if not known.all():
            unknown = messages.pick(~known)
            size = int((unknown.end - unknown.start).sum())
            losses.append(undescribed(chunk, len(unknown), size))
            messages = messages.pick(known)
        return messages, losses


def open_chunked(scan_of: Callable[[ByteSource], Scan], source: ByteSource) -> ChunkedLog:
    """Open a file by its index; where that is absent or damaged, by all of its records."""
    scan = scan_of(source)
    contents, problem = scan.indexed()
    if contents is None:
        scan = scan_of(source.nearby())
        contents = scan.scanned(problem)
    return ChunkedLog(contents, scan)
