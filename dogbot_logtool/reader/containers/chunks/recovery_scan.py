"""A scan of all records of a file whose index is missing or wrong."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import replace
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Bytes, Ints
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.reader.containers.chunks.chunk_content import (
    ChunkContent,
    ChunkDamage,
    left_out,
    undescribed,
)
from dogbot_logtool.reader.containers.chunks.records import RecordFormat, next_sound
from dogbot_logtool.reader.containers.contents import Chunk, Contents
from dogbot_logtool.reader.containers.loss import Loss, Losses
from dogbot_logtool.reader.containers.sources.source import ByteSource

_REGION_SIZE: Final = 1 << 20
"""Messages outside chunks are read in runs of about this many bytes."""
_REGION_RECORDS: Final = 1 << 16
_FIRST_RECORDS: Final = 16
_NO_ACCIDENT: Final = 4
_READ_AT_ONCE: Final = 4 << 20
_SHORTEST_HEAD: Final = 12
"""Fewer bytes at the end of the file are taken for a record that is cut off."""
_LARGEST_PADDING: Final = 64


@dataclass(frozen=True, slots=True)
class IndexEntry:
    """A chunk's entry in the index."""

    start_time: int | None
    """ns; also `end_time`."""
    end_time: int | None
    counts: Mapping[int, int] | None
    """Messages by channel."""


@dataclass(frozen=True, slots=True)
class _ScannedChunk:
    """A chunk that was read, and the messages found in it."""

    chunk: Chunk
    counts: Mapping[int, int]
    """Messages by number of the channel."""
    sizes: Mapping[int, int]
    """Bytes of their payloads, also by number of the channel."""


class RecoveryScan(ABC):
    """Finds chunks and bare messages by following the records, then reads each chunk."""

    def __init__(self, source: ByteSource, fmt: RecordFormat, losses: Losses) -> None:
        self._source = source
        self._format = fmt
        self._losses = losses
        self._chunks: list[Chunk] = []
        self._some_checked = False
        """A chunk has a checksum."""
        self._index_entries: dict[int, IndexEntry] = {}
        """By offset of the chunk."""
        self._searched = False
        """Damage was skipped, so that the next bare messages may belong to a damaged chunk."""
        self._kept: tuple[int, bytes] = (0, b"")
        """The last record outside of chunks, and its offset."""
        self._doubtful: set[int] = set()
        """Offsets of runs of messages that may be a damaged chunk's."""

    @abstractmethod
    def _step(self, offset: int) -> int | None:
        """Take the record at an offset; return where to go on, None if there is no sound record."""

    @abstractmethod
    def _parse(self, chunk: Chunk, stored: memoryview, target: Bytes) -> ChunkContent:
        """See `Log.parse`."""

    @abstractmethod
    def _check(self, chunk: Chunk) -> None:
        """See `Log.check`."""

    @abstractmethod
    def _describe(self, op: int, record: Bytes, chunk: Chunk) -> None:
        """Take a record from inside a chunk that may describe a channel."""

    @abstractmethod
    def _settle_ids(self) -> Mapping[int, int]:
        """Return channel ids by the numbers in the records, once all chunks were read."""

    def _walk(self, offset: int) -> None:
        size = self._source.size
        while offset < size:
            following = self._step(offset)
            offset = self._search(offset) if following is None else following

    def _search(self, offset: int) -> int:
        """Go on at the next sound record; say what was passed over."""
        self._searched = True
        following = next_sound(self._format, self._source, offset + 1, self._source.size)
        count = following - offset
        if following == self._source.size:
            what = f"the last {count} bytes, from byte {offset} on, are no whole record"
        else:
            what = f"the {count} bytes from byte {offset} on are no record"
        self._losses.add(Loss(offset, what, count, None))
        return following

    def _end(self, offset: int) -> int:
        """Stop where the recording ends; another one may follow, whose channels are others."""
        rest = self._source.size - offset
        if rest:
            what = f"the {rest} bytes behind the end of the recording were left out"
            self._losses.add(Loss(offset, what, rest, None))
        return self._source.size

    def _chunk(self, chunk: Chunk, derived_end: int) -> int:
        """Take a chunk whose header has been read.

        Args:
            chunk: the chunk; its end may be beyond the file's.
            derived_end: where it ends by another of its lengths, or the same.

        Returns:
            where to go on.
        """
        size = self._source.size
        for end in (chunk.end, derived_end):
            if end <= size and self._follows(end):
                return self._append(chunk, end)
        if chunk.end <= size:
            return self._append(chunk, chunk.end)
        lost = size - chunk.offset
        if not chunk.is_compressed and 0 <= chunk.end - derived_end < _LARGEST_PADDING:
            what = f"the chunk at byte {chunk.offset} is cut off; its whole messages were read"
            # What is missing comes after its whole messages.
            self._losses.add(Loss(size, what, 0, None))
            self._searched = False
            return chunk.data_offset
        end = next_sound(self._format, self._source, chunk.data_offset, size)
        if end < size:
            return self._append(chunk, end)
        if chunk.compression == "bz2":
            return self._append(chunk, size)
        what = f"the chunk at byte {chunk.offset} is cut off; nothing in it can be used"
        self._losses.add(Loss(chunk.offset, what, lost, None))
        return size

    def _append(self, chunk: Chunk, end: int) -> int:
        data_size = min(chunk.data_size, end - chunk.data_offset)
        size = chunk.size if chunk.is_compressed else data_size
        sized = replace(chunk, data_size=data_size, size=size, end=end, index_end=end)
        self._chunks.append(sized)
        self._some_checked = self._some_checked or bool(chunk.crc)
        return end

    def _follows(self, offset: int) -> bool:
        size = self._source.size
        return offset == size or self._format.sound(self._source, offset, size)

    def _bare(self, offset: int, end: int) -> int | None:
        """Take a run of messages that stand outside of chunks; None if the first is none.

        Args:
            offset: where the first begins.
            end: where it ends.
        """
        window = self._window(offset, max(_REGION_SIZE, end - offset))
        count, bounds = self._messages_in(window)
        if not count:
            return None
        stop = bounds[count]
        following: int | None = offset + stop
        at_window_end = offset + len(window) < self._source.size and count == len(bounds) - 1
        cut_off = self._source.size - offset - stop < _SHORTEST_HEAD
        if not (at_window_end or cut_off or self._follows(offset + stop)):
            before = bounds[count - 1]
            if not self._format.resembles(window, before, stop, len(window)):
                stop, following = before, None
        if stop:
            if self._searched:
                self._doubtful.add(offset)
            run = Chunk(offset, offset, stop, offset + stop, offset + stop, "", stop)
            self._chunks.append(run)
        return self._search(offset + stop) if following is None else following

    def _begins_run(self, offset: int, end: int) -> bool:
        """Tell whether so many messages follow each other that they are no accident.

        Args:
            offset: where the first begins.
            end: where it ends.
        """
        window = self._window(offset, max(_REGION_SIZE, end - offset))
        return self._messages_in(window)[0] >= _NO_ACCIDENT

    def _window(self, offset: int, size: int) -> Bytes:
        """Return bytes of the file; runs that follow each other share what was read."""
        begin, kept = self._kept
        if not (begin <= offset and min(offset + size, self._source.size) <= begin + len(kept)):
            begin, kept = offset, self._source.read(offset, max(size, _READ_AT_ONCE))
            self._kept = begin, kept
        return np.frombuffer(memoryview(kept)[offset - begin :][:size], np.uint8)

    def _messages_in(self, window: Bytes) -> tuple[int, list[int]]:
        """Return how many messages a window begins with, and where its records begin and end.

        More and more records are looked at: where runs of messages are short, looking at all that
        follows each of them would take the square of the time.
        """
        limit = _FIRST_RECORDS
        while True:
            bounds = self._format.chain(window.data, 0, len(window), limit)
            found = self._format.decode(window, np.array(bounds, np.int64))
            others = np.flatnonzero(found.op != self._format.message)
            if len(others):
                return int(others[0]), bounds
            if len(found) < limit or limit == _REGION_RECORDS:
                return len(found), bounds
            limit = min(limit * 8, _REGION_RECORDS)

    def _scan_chunks(self) -> tuple[list[Chunk], dict[int, int]]:
        """Read every chunk for its counts, times and descriptions.

        Returns:
            the chunks that can be used, and how many messages each channel has.
        """
        scanned: list[_ScannedChunk] = []
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
            try:
                scanned.append(self._scan_chunk(self._with_index_entry(chunk)))
                behind_damage = False
            except ChunkDamage as damage:
                self._losses.add(left_out(chunk, damage))
                behind_damage = True
        return self._count(scanned)

    def _with_index_entry(self, chunk: Chunk) -> Chunk:
        stated = self._index_entries.get(chunk.offset)
        if stated is None:
            return chunk
        return replace(
            chunk,
            start_time=stated.start_time,
            end_time=stated.end_time,
            counts=stated.counts,
        )

    def _scan_chunk(self, chunk: Chunk) -> _ScannedChunk:
        self._check(chunk)
        stored = self._source.read(chunk.offset, chunk.index_end - chunk.offset)
        target = np.empty(chunk.size, np.uint8)
        content = self._parse(chunk, memoryview(stored), target)
        for op, offset, end in content.others.tolist():
            self._describe(op, target[offset:end], chunk)
        for loss in content.losses:
            self._losses.add(loss)
        messages = content.messages
        times = messages.log_time
        known = replace(
            chunk,
            start_time=int(times.min()) if len(times) else None,
            end_time=int(times.max()) if len(times) else None,
            is_scanned=True,
        )
        return _ScannedChunk(known, *_tally(messages.channel, messages.end - messages.start))

    def _count(self, scanned: list[_ScannedChunk]) -> tuple[list[Chunk], dict[int, int]]:
        """Count by channel id, and say which messages no channel describes."""
        ids = self._settle_ids()
        chunks: list[Chunk] = []
        totals: dict[int, int] = {}
        for found in scanned:
            strange = [number for number in found.counts if number not in ids]
            if strange:
                messages = sum(found.counts[number] for number in strange)
                size = sum(found.sizes[number] for number in strange)
                self._losses.add(undescribed(found.chunk, messages, size))
            known = {ids[number]: n for number, n in found.counts.items() if number in ids}
            for channel, count in known.items():
                totals[channel] = totals.get(channel, 0) + count
            chunks.append(replace(found.chunk, counts=known))
        return chunks, totals

    def _contents(self, offset: int, problem: Loss | None) -> Contents:
        """Scan from an offset to the end of the file; subclasses add the channels."""
        if problem is not None:
            self._losses.add(problem)
        self._walk(offset)
        chunks, counts = self._scan_chunks()
        return Contents(
            channels={},
            chunks=chunks,
            counts=counts,
            start_time=min(
                (c.start_time for c in chunks if c.start_time is not None), default=None
            ),
            end_time=max((c.end_time for c in chunks if c.end_time is not None), default=None),
        )


def _tally(channel: Ints, size: Ints) -> tuple[dict[int, int], dict[int, int]]:
    """Return the number of messages, and the bytes of their payloads, by channel."""
    numbers, code = np.unique(channel, return_inverse=True)
    counts = np.bincount(code, minlength=len(numbers))
    sizes = np.bincount(code, size, minlength=len(numbers))
    return (
        dict(zip(numbers.tolist(), counts.tolist(), strict=True)),
        dict(zip(numbers.tolist(), sizes.astype(np.int64).tolist(), strict=True)),
    )
