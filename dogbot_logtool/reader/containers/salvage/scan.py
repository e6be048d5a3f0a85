"""The chunks of a file: by its index, or where that is missing or wrong, by all of its records."""

from abc import ABC, abstractmethod
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from typing import Final, NamedTuple

import numpy as np

from dogbot_logtool.core.arrays import Bytes
from dogbot_logtool.reader.containers.contents import Channel, Chunk, Contents, Extra, time_range
from dogbot_logtool.reader.containers.loss import Loss, Losses
from dogbot_logtool.reader.containers.salvage.content import (
    ChunkContent,
    ChunkDamage,
    left_out,
    undescribed,
)
from dogbot_logtool.reader.containers.salvage.records import RecordFormat, next_sound
from dogbot_logtool.reader.containers.salvage.runs import Runs
from dogbot_logtool.reader.containers.sources.source import ByteSource

_SHORTEST_HEAD: Final = 12
"""Fewer bytes at the end of the file are taken for a record that is cut off."""
_LARGEST_PADDING: Final = 64


class IndexEntry(NamedTuple):
    """What the log's index says of a chunk."""

    start_time: int | None
    """ns; also `end_time`."""
    end_time: int | None
    counts: Mapping[int, int] | None
    """Messages by channel, as numbered in the records."""

    def added_to(self, chunk: Chunk) -> Chunk:
        """Return a chunk with what the entry says."""
        return replace(chunk, **self._asdict())


class ReadChunk(NamedTuple):
    """A chunk that was read, and the messages found in it."""

    chunk: Chunk
    counts: Mapping[int, float]
    """Messages by number of the channel."""
    sizes: Mapping[int, float]
    """Bytes of their payloads, also by number of the channel."""


class Scan(ABC):
    """The chunks of a file, and what is in each.

    `indexed` takes the chunks that an index names, where they and what is known beside them tile
    the file; `scanned` follows all records, and reads each chunk. Both end in the same `Contents`.
    """

    container: str
    """Name of the container for people."""
    magic: bytes
    copies_chunks = False
    """See `Log.copies_chunks`."""

    def __init__(self, source: ByteSource, fmt: RecordFormat) -> None:
        self.source = source
        self._format = fmt
        self._runs = Runs(source, fmt)
        self._losses = Losses()
        self._chunks: list[Chunk] = []
        self._extras: list[Extra] = []
        self._some_checked = False
        """A chunk has a checksum."""
        self._index_entries: dict[int, IndexEntry] = {}
        """By offset of the chunk."""
        self._searched = False
        """Damage was skipped, so that the next bare messages may belong to a damaged chunk."""
        self._doubtful: set[int] = set()
        """Offsets of runs of messages that may be a damaged chunk's."""

    @abstractmethod
    def indexed(self) -> tuple[Contents | None, Loss | None]:
        """Read the index.

        Returns:
            the contents, or None where the index is absent, damaged, incomplete or contradicts the
            chunks; and what is wrong with it.
        """

    @abstractmethod
    def _step(self, offset: int) -> int | None:
        """Take the record at an offset; return where to go on, None if there is no sound record."""

    @abstractmethod
    def _between(self, offset: int, stop: int) -> int | None:
        """Take a record that may stand before an indexed chunk; None: there is another one."""

    @abstractmethod
    def check(self, chunk: Chunk) -> None:
        """Check what a chunk claims before memory is set aside for it.

        Raises:
            ChunkDamage: it cannot be true.
        """

    @abstractmethod
    def parse(self, chunk: Chunk, stored: memoryview, target: Bytes) -> ChunkContent:
        """Decompress a chunk into the target and find its messages.

        Args:
            chunk: the chunk; its counts are by channel as numbered in the records.
            stored: the file's bytes from `chunk.offset` to `chunk.index_end`, or fewer.
            target: (chunk.size,) uint8.

        Raises:
            ChunkDamage: nothing in the chunk can be trusted.
        """

    @abstractmethod
    def _describe(self, op: int, record: Bytes, chunk: Chunk) -> None:
        """Take a record from inside a chunk that may describe a channel."""

    @abstractmethod
    def contradictions(self, content: ChunkContent, data: Bytes, chunk: Chunk) -> Sequence[Loss]:
        """Compare the descriptions in a chunk, whose bytes are given, with those that are used."""

    @abstractmethod
    def own_times(self, chunk: Chunk) -> tuple[int | None, int | None] | None:
        """Return the log times, ns, that a chunk itself tells; None if nothing of it does."""

    def by_own_header(self, chunk: Chunk) -> Chunk | None:
        """Return a chunk as its own header has it; None: that is damaged, or says the same."""
        del chunk
        return None

    def describes_others(
        self, channels: Collection[Channel], content: ChunkContent, data: Bytes
    ) -> bool:
        """Tell whether a chunk, whose bytes are given, describes other channels than some."""
        del channels, content, data
        return False

    @property
    @abstractmethod
    def ids(self) -> Mapping[int, int]:
        """Channel ids by the numbers in the records."""

    @abstractmethod
    def _channels(self) -> Mapping[int, Channel]:
        """Return the channels by their ids."""

    @abstractmethod
    def _profile(self) -> str:
        """Return the log's profile; say if it cannot be read."""

    def _conclude(self, counts: Mapping[int, int]) -> None:
        """Compare what was found with what the file says elsewhere.

        Args:
            counts: messages by channel id.
        """
        del counts

    def _fills(self, start: int, chunks: Sequence[Chunk], end: int) -> bool:
        """Tell whether chunks that an index names, and records known beside them, tile the file."""
        offset = start
        for stop, following in (*((each.offset, each.index_end) for each in chunks), (end, end)):
            while offset < stop:
                behind = self._between(offset, stop)
                if behind is None:
                    return False
                offset = behind
            if offset != stop:
                return False
            offset = following
        return True

    def scanned(self, problem: Loss | None) -> Contents:
        """Follow all records.

        Args:
            problem: what is wrong with the index.
        """
        profile = self._profile()
        if problem is not None:
            self._losses.add(problem)
        offset = len(self.magic)
        while offset < self.source.size:
            following = self._step(offset)
            offset = self._search(offset) if following is None else following
        self._runs.forget()
        chunks = self._read_chunks()
        counts = self._counts(chunks)
        self._conclude(counts)
        losses = self._losses.all()
        times = time_range(chunks)
        return Contents(self._channels(), chunks, counts, *times, profile, self._extras, losses)

    def _counts(self, chunks: Sequence[Chunk]) -> dict[int, int]:
        """Return the messages of each channel, by its id."""
        counts = dict.fromkeys(self._channels(), 0)
        for chunk in chunks:
            for number, count in (chunk.counts or {}).items():
                counts[number] += count
        return counts

    def _search(self, offset: int) -> int:
        """Go on at the next sound record; say what was passed over."""
        self._searched = True
        following = next_sound(self._format, self.source, offset + 1, self.source.size)
        count = following - offset
        if following == self.source.size:
            what = f"the last {count} bytes, from byte {offset} on, are no whole record"
        else:
            what = f"the {count} bytes from byte {offset} on are no record"
        self._losses.add(Loss(offset, what, count, None))
        return following

    def _end(self, offset: int) -> int:
        """Stop where the recording ends; another one may follow, whose channels are others."""
        rest = self.source.size - offset
        if rest:
            what = f"the {rest} bytes behind the end of the recording were left out"
            self._losses.add(Loss(offset, what, rest, None))
        return self.source.size

    def _take_chunk(self, chunk: Chunk, derived_end: int) -> int:
        """Take a chunk whose header has been read; return where to go on.

        Args:
            chunk: the chunk; its end may be beyond the file's.
            derived_end: where it ends by another of its lengths, or the same.
        """
        size = self.source.size
        for end in (chunk.end, derived_end):
            if end <= size and self._follows(end):
                return self._append(chunk, end)
        if chunk.end <= size:
            return self._append(chunk, chunk.end)
        if not chunk.is_compressed and 0 <= chunk.end - derived_end < _LARGEST_PADDING:
            what = f"the chunk at byte {chunk.offset} is cut off; its whole messages were read"
            # What is missing comes after its whole messages.
            self._losses.add(Loss(size, what, 0, None))
            self._searched = False
            return chunk.data_offset
        end = next_sound(self._format, self.source, chunk.data_offset, size)
        if end < size or chunk.compression == "bz2":
            return self._append(chunk, end)
        what = f"the chunk at byte {chunk.offset} is cut off; nothing in it can be used"
        self._losses.add(Loss(chunk.offset, what, size - chunk.offset, None))
        return size

    def _append(self, chunk: Chunk, end: int) -> int:
        data_size = min(chunk.data_size, end - chunk.data_offset)
        size = chunk.size if chunk.is_compressed else data_size
        sized = replace(chunk, data_size=data_size, size=size, end=end, index_end=end)
        self._chunks.append(sized)
        self._some_checked = self._some_checked or bool(chunk.crc)
        return end

    def _take_index(self, offset: int, end: int) -> None:
        """Take a record that names the messages of the chunk before it."""
        if self._chunks and self._chunks[-1].is_record and self._chunks[-1].index_end == offset:
            self._chunks[-1] = replace(self._chunks[-1], index_end=end)

    def _follows(self, offset: int) -> bool:
        size = self.source.size
        return offset == size or self._format.sound(self.source, offset, size)

    def _bare(self, offset: int, end: int) -> int | None:
        """Take a run of messages that stand outside of chunks; None if the first is none.

        Args:
            offset: where the first begins.
            end: where it ends.
        """
        window, count, bounds = self._runs.at(offset, end)
        if not count:
            return None
        stop = bounds[count]
        goes_on = (
            (offset + len(window) < self.source.size and count == len(bounds) - 1)
            or self.source.size - offset - stop < _SHORTEST_HEAD
            or self._follows(offset + stop)
        )
        if not goes_on:
            before = bounds[count - 1]
            goes_on = self._format.resembles(window, before, stop, len(window))
            stop = stop if goes_on else before
        behind = offset + stop
        if stop:
            if self._searched:
                self._doubtful.add(offset)
            self._chunks.append(Chunk(offset, offset, stop, behind, behind, "", stop))
        return behind if goes_on else self._search(behind)

    def _read_chunks(self) -> list[Chunk]:
        """Read every chunk for counts, times and descriptions; return those that can be used."""
        read: list[ReadChunk] = []
        behind_damage = False
        for chunk in self._chunks:
            # A damaged chunk may seem to end before its end, and messages to follow it.
            doubtful = behind_damage or chunk.offset in self._doubtful
            if self._some_checked and doubtful and not chunk.is_record:
                what = (
                    f"the {chunk.size} bytes from byte {chunk.offset} on were left out: they "
                    "belong to a damaged chunk"
                )
                self._losses.add(Loss(chunk.offset, what, chunk.size, None))
                continue
            entry = self._index_entries.get(chunk.offset)
            try:
                read.append(self._read_chunk(entry.added_to(chunk) if entry else chunk))
                behind_damage = False
            except ChunkDamage as damage:
                self._losses.add(left_out(chunk, damage))
                behind_damage = True
        return self._with_ids(read)

    def _read_chunk(self, chunk: Chunk) -> ReadChunk:
        self.check(chunk)
        stored = self.source.read(chunk.offset, chunk.index_end - chunk.offset)
        target = np.empty(chunk.size, np.uint8)
        content = self.parse(chunk, memoryview(stored), target)
        for op, offset, end in content.others.tolist():
            self._describe(op, target[offset:end], chunk)
        for loss in content.losses:
            self._losses.add(loss)
        messages, times = content.messages, content.messages.log_time
        start, end = (int(times.min()), int(times.max())) if len(times) else (None, None)
        numbers, code = np.unique(messages.channel, return_inverse=True)
        counts, sizes = (
            dict(zip(numbers.tolist(), np.bincount(code, weight, len(numbers)), strict=True))
            for weight in (None, messages.end - messages.start)
        )
        known = replace(chunk, start_time=start, end_time=end, is_scanned=True)
        return ReadChunk(known, counts, sizes)

    def _with_ids(self, read: Sequence[ReadChunk]) -> list[Chunk]:
        """Count by channel id, and say which messages no channel describes."""
        ids = self.ids
        chunks: list[Chunk] = []
        for found in read:
            strange = [number for number in found.counts if number not in ids]
            if strange:
                messages, size = (
                    int(sum(values[number] for number in strange))
                    for values in (found.counts, found.sizes)
                )
                self._losses.add(undescribed(found.chunk, messages, size))
            known = {ids[number]: int(n) for number, n in found.counts.items() if number in ids}
            chunks.append(replace(found.chunk, counts=known))
        return chunks
