"""Logs whose messages lie in chunk records: ROS 1 bags and MCAP files."""

from abc import abstractmethod
from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Bytes
from dogbot_logtool.reader.containers.batch import Batch, LoadedChunk
from dogbot_logtool.reader.containers.contents import UNKNOWN_CHANNEL, ChannelIds, Chunk, Contents
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

    def __init__(self, source: ByteSource, contents: Contents, scan: Scan) -> None:
        """Take a log.

        Args:
            source: the file.
            contents: what was found in it.
            scan: what found them; its code reads the chunks, too.
        """
        super().__init__(source, contents)
        self._scan = scan
        self._channel_ids = ChannelIds({number: number for number in contents.channels})
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
        times = self.own_times(chunk)
        if times is None:
            return True
        return super().overlaps(replace(chunk, start_time=times[0], end_time=times[1]), start, end)

    @abstractmethod
    def own_times(self, chunk: Chunk) -> tuple[int | None, int | None] | None:
        """Return the log times, ns, that a chunk itself tells; None if nothing of it does."""

    def _corrected(self, span: Span) -> Batch:
        """Read chunks as the log's index describes them, else as their own headers do."""
        batch, damaged = self._of_chunks(span)
        corrected = {chunk.offset: own for chunk in damaged if (own := self.by_own_header(chunk))}
        if not corrected:
            return self._with_times(batch)
        batch, damaged = self._of_chunks([corrected.get(chunk.offset, chunk) for chunk in span])
        readable = corrected.keys() - {chunk.offset for chunk in damaged}
        wrong = (_wrong_index(corrected[offset]) for offset in sorted(readable))
        return self._with_times(replace(batch, losses=(*batch.losses, *wrong)))

    def _with_times(self, batch: Batch) -> Batch:
        return replace(batch, losses=tuple(map(self.located, batch.losses)))

    def by_own_header(self, chunk: Chunk) -> Chunk | None:
        """Return a chunk as its own header describes it.

        Returns:
            None if the header says the same as the log's index, or is damaged.
        """
        del chunk
        return None

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
                content = self.parse(chunk, data, target)
            except ChunkDamage as damage:
                losses.append(left_out(chunk, damage))
                damaged.append(chunk)
                continue
            messages, found = self._described(chunk, content)
            rows = slice(row, row + len(messages))
            has_index = len(data) > chunk.end - chunk.offset
            whole = (
                chunk.is_record
                and not found
                and content.indexed == has_index
                and not (self.hidden and self.describes_hidden(content, target))
            )
            kept = data if self.copies_chunks else memoryview(b"")
            loaded.append(LoadedChunk(chunk, kept, base, rows, whole, content.indexed))
            parts.append(messages.shifted(base))
            losses.extend(() if chunk.is_scanned else found)
            base, row = base + chunk.size, rows.stop
        batch = Batch(buffer, concatenate_messages(parts), tuple(loaded), tuple(losses))
        return batch, damaged

    @abstractmethod
    def parse(self, chunk: Chunk, stored: memoryview, target: Bytes) -> ChunkContent:
        """See `Scan.parse`; what contradicts the log's descriptions is said as well."""

    def describes_hidden(self, content: ChunkContent, data: Bytes) -> bool:
        """Tell whether a chunk describes what is left out: new channels may have its number."""
        del content, data
        return False

    def _described(self, chunk: Chunk, content: ChunkContent) -> tuple[Messages, list[Loss]]:
        """Give messages the ids of their channels; leave out those that are nowhere described."""
        messages, losses = content.messages, list(content.losses)
        messages = replace(messages, channel=self._channel_ids.of(messages.channel))
        known = messages.channel != UNKNOWN_CHANNEL
        if not known.all():
            unknown = messages.pick(~known)
            size = int((unknown.end - unknown.start).sum())
            losses.append(undescribed(chunk, len(unknown), size))
            messages = messages.pick(known)
        return messages, losses


def _wrong_index(chunk: Chunk) -> Loss:
    what = (
        f"the log's index is wrong about the compression or size of the chunk at byte "
        f"{chunk.offset}; the chunk's own header was used"
    )
    return Loss(chunk.offset, what)
