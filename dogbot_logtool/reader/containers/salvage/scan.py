"""The chunks of a file: by its index, or where that is missing or wrong, by all of its records."""

from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Final, NamedTuple

import numpy as np
from zlib_ng.zlib_ng import crc32

from dogbot_logtool.core.arrays import Bytes
from dogbot_logtool.reader.containers.compression import check_claimed_size, decompress_into
from dogbot_logtool.reader.containers.contents import Channel, Chunk, Contents, Extra, time_range
from dogbot_logtool.reader.containers.descriptions import Descriptions
from dogbot_logtool.reader.containers.loss import Loss, Losses
from dogbot_logtool.reader.containers.salvage.content import (
    ChunkContent,
    ChunkDamage,
    left_out,
    read_content,
    undescribed,
)
from dogbot_logtool.reader.containers.salvage.records import (
    Index,
    RecordFormat,
    may_begin,
    next_sound,
)
from dogbot_logtool.reader.containers.sources.source import ByteSource

_REGION_SIZE: Final = 1 << 20
"""Messages outside of chunks are read in runs of about this many bytes."""
_REGION_RECORDS: Final = 1 << 16
_FIRST_SIZE: Final = 4 << 10
_GROWTH: Final = 16
_LARGEST_PADDING: Final = 64
_LARGEST_DESCRIPTION: Final = 16 << 20


class IndexEntry(NamedTuple):
    """What the log's index says of a chunk."""

    start_time: int | None
    """ns; also `end_time`."""
    end_time: int | None
    counts: Mapping[int, int] | None
    """Messages by channel id."""

    def added_to(self, chunk: Chunk) -> Chunk:
        """Return a chunk with what the entry says."""
        return replace(chunk, **self._asdict())


class Scan(ABC):
    """The chunks of a file, and what is in each.

    Its records are followed from the first to the last, with an index (`indexed`) or without one
    (`scanned`). Chunks that the index names are stepped over; of all others, each is read. Both
    end in the same `Contents`.
    """

    container: str
    """Name of the container for people."""
    magic: bytes
    copies_chunks = False
    """See `Log.copies_chunks`."""
    describing: frozenset[int]
    """Kinds of the records that describe channels."""

    def __init__(self, source: ByteSource, fmt: RecordFormat, descriptions: Descriptions) -> None:
        self.source = source
        self.descriptions = descriptions
        self._format = fmt
        self._losses = Losses()
        self._chunks: list[Chunk] = []
        self._extras: list[Extra] = []
        self._index_entries: dict[int, IndexEntry] = {}
        """By offset of the chunk."""
        self._outside: list[tuple[int, int]] = []
        """Offset and end of descriptions outside of chunks."""
        self._cut_off: int | None = None
        """Offset of the chunk that the end of the file cuts off."""
        self._is_behind_damage = False
        """What was passed over may be the head of a chunk whose messages come next."""
        self._doubtful: set[int] = set()
        """Offsets of messages outside of chunks that may be a damaged chunk's."""

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
    def chunk_at(self, offset: int) -> Chunk:
        """Read a chunk record's own header. Its data may reach beyond the end of the file.

        Raises:
            ChunkDamage: there is no chunk, or its header makes no sense.
        """

    @abstractmethod
    def _index_of(self, behind: memoryview) -> Index | None:
        """Return what the records behind a chunk name."""

    @abstractmethod
    def _checksum(self, chunk: Chunk, stored: memoryview) -> tuple[int, tuple[Loss, ...]]:
        """Return the CRC of a chunk, 0 for none, and what its own header contradicts."""

    @abstractmethod
    def own_times(self, chunk: Chunk) -> tuple[int | None, int | None] | None:
        """Return the log times, ns, that a chunk itself tells; None if nothing of it does."""

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

    def parsed(self, chunk: Chunk) -> tuple[ChunkContent, list[bytes]]:
        """Read a chunk; return its content, and the records in it that describe channels.

        Raises:
            ChunkDamage: nothing in the chunk can be trusted.
        """
        self.check(chunk)
        stored = self.source.read(chunk.offset, chunk.index_end - chunk.offset)
        target = np.empty(chunk.size, np.uint8)
        content = self.parse(chunk, memoryview(stored), target)
        return content, self.described_in(content, target)

    def described_in(self, content: ChunkContent, data: Bytes) -> list[bytes]:
        """Return the records of a chunk, whose bytes are given, that describe channels."""
        return [
            data[start:end].tobytes()
            for op, start, end in content.others.tolist()
            if op in self.describing
        ]

    def _holds(self, start: int, end: int, named: Mapping[int, Chunk]) -> bool:
        """Follow the records of a part of the file that is said to be sound.

        Args:
            start: where it begins.
            end: where it ends.
            named: the chunks that stand there by the index, by their offsets.

        Returns:
            Whether they are all of its chunks, and all else there is sound as well.
        """
        offset = start
        while offset < end:
            chunk = named.get(offset)
            self._chunks += [chunk] if chunk else []
            following = chunk.index_end if chunk else self._step(offset)
            if following is None:
                return False
            offset = following
        return offset == end and [chunk.offset for chunk in self._chunks] == sorted(named)

    def scanned(self, problem: Loss | None) -> Contents:
        """Follow all records, and read all chunks.

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
        read = self._read_chunks()
        self._losses.add(*self._take_outside())
        chunks = self._described(read)
        counts = self._counts(chunks)
        self._conclude(counts)
        losses = self._losses.all()
        times = time_range(chunks)
        return Contents(self._channels(), chunks, counts, *times, profile, self._extras, losses)

    def _take_outside(self) -> list[Loss]:
        """Take the descriptions that stand outside of chunks; return what to say of them."""
        losses: list[Loss] = []
        for offset, end in self._outside:
            record = self.source.read(offset, min(end - offset, _LARGEST_DESCRIPTION))
            losses += self.descriptions.add([record], offset)
        return losses

    def _counts(self, chunks: Sequence[Chunk]) -> dict[int, int]:
        """Return the messages of each channel, by its id."""
        counts = Counter(dict.fromkeys(self._channels(), 0))
        for chunk in chunks:
            counts.update(chunk.counts or {})
        return dict(counts)

    def _search(self, offset: int) -> int:
        """Go on at the next sound record; say what was passed over."""
        self._is_behind_damage = True
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
                break
        else:
            end = min(chunk.end, size)
            is_plain = not chunk.is_compressed and 0 <= chunk.end - derived_end < _LARGEST_PADDING
            if chunk.end > size and not is_plain:
                # It is cut off, or its length is damaged.
                end = next_sound(self._format, self.source, chunk.data_offset, size)
            self._cut_off = chunk.offset if chunk.end > size == end else None
        known = replace(chunk, end=end, index_end=end, is_scanned=True)
        known = replace(known, data_size=min(chunk.data_size, end - chunk.data_offset))
        if not chunk.is_compressed and end < size:
            known = replace(known, size=known.data_size)
        self._chunks.append(known)
        self._is_behind_damage = False
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
        window, bounds = self._run(offset, end)
        if len(bounds) == 1:
            return None
        stop = bounds[-1]
        goes_on = self._follows(offset + stop) or may_begin(self._format, window, stop, len(window))
        if not goes_on:
            stop = bounds[-2]
        behind = offset + stop
        if stop:
            if self._is_behind_damage:
                self._doubtful.add(offset)
            self._chunks.append(
                Chunk(offset, offset, stop, behind, behind, "", stop, is_scanned=True)
            )
        return behind if goes_on else self._search(behind)

    def _run(self, offset: int, end: int) -> tuple[Bytes, list[int]]:
        """Return bytes, and where the messages with which they begin begin and end.

        More and more bytes are looked at: where runs of messages are short, looking at all that
        follows each of them would take the square of the time.

        Args:
            offset: where the first message begins.
            end: where it ends.
        """
        size = max(_FIRST_SIZE, end - offset)
        while True:
            window = np.frombuffer(self.source.read(offset, size), np.uint8)
            bounds = self._format.chain(window.data, 0, len(window), _REGION_RECORDS)
            found = self._format.decode(window, np.array(bounds[:-1], np.int64))
            count = int(np.append(found.op != self._format.message, True).argmax())
            is_all = count < len(found.op) or len(window) < size
            if is_all or size >= _REGION_SIZE:
                return window, bounds[: count + 1]
            size *= _GROWTH

    def _read_chunks(self) -> list[tuple[Chunk, Mapping[int, int]]]:
        """Read every chunk for counts, times and descriptions.

        Returns:
            Those that can be used; and bytes of the messages of each, by channel.
        """
        read: list[tuple[Chunk, Mapping[int, int]]] = []
        has_checksums = any(chunk.crc for chunk in self._chunks)
        behind_damage = False
        for chunk in self._chunks:
            # A damaged chunk may seem to end before its end, and messages to follow it.
            is_doubtful = behind_damage or chunk.offset in self._doubtful
            if has_checksums and is_doubtful and not chunk.is_record:
                what = (
                    f"the {chunk.size} bytes from byte {chunk.offset} on were left out: they "
                    "belong to a damaged chunk"
                )
                self._losses.add(Loss(chunk.offset, what, chunk.size, None))
                continue
            entry = self._index_entries.get(chunk.offset)
            known = entry.added_to(chunk) if entry else chunk
            try:
                read.append(self._read_chunk(known))
                behind_damage = False
            except ChunkDamage as damage:
                behind_damage = True
                is_cut = chunk.offset == self._cut_off
                what = "it is cut off by the end of the file" if is_cut else str(damage)
                self._losses.add(left_out(known, ChunkDamage(what, damage.messages)))
        return read

    def _read_chunk(self, chunk: Chunk) -> tuple[Chunk, Mapping[int, int]]:
        content, described = self.parsed(chunk)
        losses = self.descriptions.add(described, chunk.offset)
        self._losses.add(*content.losses, *losses)
        messages, times = content.messages, content.messages.log_time
        start, end = (int(times.min()), int(times.max())) if len(times) else (None, None)
        numbers, code = np.unique(messages.channel, return_inverse=True)
        counts = dict(zip(numbers.tolist(), np.bincount(code).tolist(), strict=True))
        sizes = np.bincount(code, messages.end - messages.start, len(numbers)).astype(np.int64)
        known = replace(chunk, start_time=start, end_time=end, counts=counts)
        return known, dict(zip(numbers.tolist(), sizes.tolist(), strict=True))

    def _described(self, read: Sequence[tuple[Chunk, Mapping[int, int]]]) -> list[Chunk]:
        """Return chunks without the messages that no channel describes, and say which those are."""
        channels = self._channels()
        chunks: list[Chunk] = []
        for chunk, sizes in read:
            counts = chunk.counts or {}
            strange = counts.keys() - channels.keys()
            if strange:
                messages = sum(counts[number] for number in strange)
                size = sum(sizes[number] for number in strange)
                self._losses.add(undescribed(chunk, messages, size))
            known = {number: n for number, n in counts.items() if number in channels}
            chunks.append(replace(chunk, counts=known))
        return chunks
