"""Logs of records, ROS 1 bags and MCAP files: messages in chunks, or as records of their own.

An intact log is a damaged one with nothing lost: records are followed from the first to the last,
with an index or without. Chunks that a true index names are stepped over; all others are read.
"""

from abc import abstractmethod
from bisect import bisect_left, bisect_right
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Final

import numpy as np
from zlib_ng.zlib_ng import crc32

from dogbot_logtool.core.arrays import Bytes
from dogbot_logtool.reader.containers.compression import decompress_into, is_honest_size
from dogbot_logtool.reader.containers.descriptions import Description, Descriptions
from dogbot_logtool.reader.containers.log import (
    Batch,
    Channel,
    Chunk,
    Extra,
    LoadedChunk,
    Log,
    Messages,
    Span,
    concatenate_messages,
    counts_by_channel,
    time_range,
)
from dogbot_logtool.reader.containers.loss import Loss, summed_up
from dogbot_logtool.reader.containers.salvage import (
    ChunkContent,
    ChunkDamage,
    Index,
    RecordFormat,
    left_out,
    may_begin,
    next_sound,
    read_content,
    undescribed,
)
from dogbot_logtool.reader.containers.source import ByteSource

_ROUND_SIZE: Final = 1 << 20
_REGION_SIZE: Final = 1 << 20
"""Messages outside of chunks are read in runs of about this many bytes."""
_REGION_RECORDS: Final = 1 << 16
_FIRST_SIZE: Final = 4 << 10
_GROWTH: Final = 16
_LARGEST_PADDING: Final = 64
_LARGEST_DESCRIPTION: Final = 16 << 20

Times = tuple[int | None, int | None]
"""ns, of a first and a last message; None: not known."""


class UnusableIndex(Exception):  # noqa: N818 - it never reaches a user; `Loss` does
    """A file's index is absent, damaged, incomplete or contradicts the chunks."""

    def __init__(self, loss: Loss | None = None) -> None:
        """Say what is wrong with it, if that is damage."""
        super().__init__()
        self.loss = loss


class RecordLog(Log):
    """A log of one file that is read by decompressing its chunks."""

    magic: bytes
    _format: RecordFormat

    def __init__(self, source: ByteSource, describe: Callable[[bytes], Description | None]) -> None:
        """Begin with nothing found.

        Args:
            source: the file.
            describe: returns what a record tells of a channel; None: it is malformed.
        """
        super().__init__(source)
        self.descriptions = Descriptions(describe)
        self.chunks: list[Chunk] = []
        self.extras: list[Extra] = []
        self._losses: list[Loss] = []
        self._stated: dict[int, Mapping[str, Any]] = {}
        """By offset of the chunk: its `start_time`, `end_time` and `counts` by the log's index."""
        self._outside: list[tuple[int, int]] = []
        """Offset and end of descriptions outside of chunks."""
        self._only_batch: Batch | None = None

    @abstractmethod
    def use_index(self) -> None:
        """Find the chunks by the index.

        Raises:
            UnusableIndex: that cannot be done.
        """

    @abstractmethod
    def _step(self, offset: int) -> int | None:
        """Take the record at an offset; return where to go on, None if there is no sound record."""

    @abstractmethod
    def _described_channels(self) -> Mapping[int, Channel]:
        """Return the channels by their ids."""

    @abstractmethod
    def _index_of(self, behind: memoryview) -> Index | None:
        """Return what the records behind a chunk name."""

    def _checksum(self, chunk: Chunk, stored: memoryview) -> tuple[int, tuple[Loss, ...]]:
        """Return the CRC of a chunk, 0 for none, and what its own header contradicts."""
        del chunk, stored
        return 0, ()

    def _conclude(self) -> None:
        """Compare what was found with what the file says elsewhere."""

    # Find the chunks.

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
            if chunk := named.get(offset):
                if not is_honest_size(chunk.size, chunk.data_size):
                    return False
                self.chunks.append(chunk)
            following = chunk.index_end if chunk else self._step(offset)
            if following is None:
                return False
            offset = following
        return offset == end and [chunk.offset for chunk in self.chunks] == sorted(named)

    def scan(self, problem: Loss | None) -> None:
        """Follow all records, and read all chunks.

        Args:
            problem: what is wrong with the index.
        """
        if problem is not None:
            self._losses.append(problem)
        offset = len(self.magic)
        while offset < self.source.size:
            following = self._step(offset)
            offset = self._search(offset) if following is None else following
        self._read_chunks()
        self._losses += self._take_outside()
        self.channels = self._described_channels()
        self.chunks = [self._without_undescribed(chunk) for chunk in self.chunks]
        self._finish(self._counted())

    def _finish(self, counts: Mapping[int, int]) -> None:
        """Say what the log holds, by its chunks and the messages of each channel."""
        self.counts = counts
        filled = [chunk for chunk in self.chunks if chunk.messages != 0]
        self.start_time, self.end_time = time_range(filled)
        self._conclude()
        self.losses = summed_up(self._losses)

    def _take_outside(self) -> list[Loss]:
        """Take the descriptions that stand outside of chunks; return what to say of them."""
        losses: list[Loss] = []
        for offset, end in self._outside:
            record = self.source.read(offset, min(end - offset, _LARGEST_DESCRIPTION))
            losses += self.descriptions.compare([record], offset, adding=True)
        return losses

    def _counted(self) -> dict[int, int]:
        """Return the messages of each channel, by its id, that the chunks are known to hold."""
        counts = Counter(dict.fromkeys(self.channels, 0))
        for chunk in self.chunks:
            counts.update(chunk.counts or {})
        return dict(counts)

    def _search(self, offset: int) -> int:
        """Go on at the next sound record; say what was passed over."""
        following = next_sound(self._format, self.source.read, offset + 1, self.source.size)
        count = following - offset
        what = f"the {count} bytes from byte {offset} on are no record"
        self._losses.append(Loss(offset, what, count, None))
        return following

    def _end(self, offset: int) -> int:
        """Stop where the recording ends; another one may follow, whose channels are others."""
        rest = self.source.size - offset
        if rest:
            what = f"the {rest} bytes behind the end of the recording were left out"
            self._losses.append(Loss(offset, what, rest, None))
        return self.source.size

    def _take_chunk(self, chunk: Chunk, derived_end: int) -> int | None:
        """Take a chunk whose header has been read; return where to go on, None if it is none.

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
                if not (chunk.is_compressed or chunk.crc):
                    # Its messages are found one by one.
                    return None
                # It is cut off, or its length is damaged.
                end = next_sound(self._format, self.source.read, chunk.data_offset, size)
        known = chunk._replace(end=end, index_end=end)
        known = known._replace(data_size=min(chunk.data_size, end - chunk.data_offset))
        if not chunk.is_compressed and end < size:
            known = known._replace(size=known.data_size)
        self.chunks.append(known)
        return end

    def _take_index(self, offset: int, end: int) -> None:
        """Take a record that names the messages of the chunk before it."""
        if self.chunks and self.chunks[-1].is_record and self.chunks[-1].index_end == offset:
            self.chunks[-1] = self.chunks[-1]._replace(index_end=end)

    def _follows(self, offset: int) -> bool:
        size = self.source.size
        return offset == size or self._format.sound(self.source.read, offset, size)

    def _bare(self, offset: int, end: int) -> int:
        """Take a run of messages that stand outside of chunks; return where to go on.

        Args:
            offset: where the first begins.
            end: where it ends.
        """
        window, bounds = self._run(offset, end)
        stop = bounds[-1]
        goes_on = self._follows(offset + stop) or may_begin(self._format, window, stop, len(window))
        if not goes_on:
            stop = bounds[-2]
        behind = offset + stop
        if stop:
            self.chunks.append(Chunk(offset, offset, stop, behind, behind, "", stop))
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

    def _read_chunks(self) -> None:
        """Read every chunk for counts, times and descriptions; keep those that can be used."""
        found, self.chunks = self.chunks, []
        has_checksums = any(chunk.crc for chunk in found)
        for chunk in found:
            known = chunk._replace(**self._stated.get(chunk.offset, {}))
            try:
                # A damaged chunk may seem to end before its end, and messages to follow it.
                if has_checksums and self._losses and not chunk.is_record:
                    raise ChunkDamage("it is a part of a damaged one")
                self.chunks.append(self._read_chunk(known))
            except ChunkDamage as damage:
                self._losses.append(left_out(known, damage))

    def _read_chunk(self, chunk: Chunk) -> Chunk:
        content = self._content(chunk)
        losses = self.descriptions.compare(content.described, chunk.offset, adding=True)
        self._losses += [*content.losses, *losses]
        times = content.messages.log_time
        start, end = (int(times.min()), int(times.max())) if len(times) else (None, None)
        counts = counts_by_channel(content.messages)
        return chunk._replace(start_time=start, end_time=end, counts=counts, is_scanned=True)

    def _without_undescribed(self, chunk: Chunk) -> Chunk:
        """Leave out the messages of a chunk that no channel describes, and say which those are."""
        if self.channels.keys() >= (chunk.counts or {}).keys():
            return chunk
        messages, losses = self._described(chunk, self._content(chunk).messages)
        self._losses += losses
        return chunk._replace(counts=counts_by_channel(messages))

    # Read them.

    def _content(self, chunk: Chunk) -> ChunkContent:
        """Read a chunk by itself.

        Raises:
            ChunkDamage: nothing in the chunk can be trusted.
        """
        if not is_honest_size(chunk.size, chunk.data_size):
            raise ChunkDamage(f"it claims to hold {chunk.size} bytes in {chunk.data_size}")
        stored = self.source.read(chunk.offset, chunk.index_end - chunk.offset)
        return self._parse(chunk, memoryview(stored), np.empty(chunk.size, np.uint8))

    def _parse(self, chunk: Chunk, stored: memoryview, target: Bytes) -> ChunkContent:
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
            if chunk.end - chunk.data_offset - chunk.data_size > _LARGEST_PADDING:
                raise ChunkDamage("its lengths contradict each other")
            crc, losses = self._checksum(chunk, stored) if chunk.is_record else (0, ())
            size = decompress_into(target, data, chunk.compression)
            if size < len(target) and (crc or not size):
                raise ChunkDamage(f"its {chunk.compression} data is damaged or cut off")
            if crc and crc32(target.data) != crc:
                raise ChunkDamage("its checksum does not hold")
            if losses and not (crc or chunk.is_scanned):
                raise ChunkDamage("its header is damaged, and it has no checksum")
        except ChunkDamage as damage:
            raise ChunkDamage(str(damage), len(index.offset) if index else None) from damage
        content = read_content(self._format, target[:size], index, chunk, verified=bool(crc))
        return content._replace(losses=(*losses, *content.losses))

    def _read(self, span: Span) -> Batch:
        """See `Log.read`. A batch that is the whole log is read several times, so it is kept."""
        if len(span) < len(self.chunks):
            return self._of_chunks(span)
        if self._only_batch is None:
            self._only_batch = self._of_chunks(span)
        return self._only_batch

    def _of_chunks(self, span: Sequence[Chunk]) -> Batch:
        losses: list[Loss] = []
        ranges = [(chunk.offset, chunk.index_end - chunk.offset) for chunk in span]
        stored = [memoryview(data) for data in self.source.read_many(ranges)]

        size = sum(chunk.size for chunk in span)
        # The allocator reuses blocks of the same size, which keeps each process smaller.
        buffer = np.empty(size + -size % _ROUND_SIZE, np.uint8)[:size]
        loaded: list[LoadedChunk] = []
        parts: list[Messages] = []
        base = row = 0
        for chunk, data in zip(span, stored, strict=True):
            try:
                content = self._parse(chunk, data, buffer[base : base + chunk.size])
            except ChunkDamage as damage:
                losses.append(left_out(chunk, damage))
                continue
            messages, found = self._described(chunk, content.messages)
            found += content.losses
            found += self.descriptions.compare(content.described, chunk.offset, adding=False)
            rows = slice(row, row + len(messages))
            whole = (
                chunk.is_record
                and not found
                and content.indexed
                and (not self.hidden or self._are_kept(content.described))
            )
            copied = data if self.copies_chunks else memoryview(b"")
            loaded.append(LoadedChunk(chunk, copied, rows, whole))
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

    def _described(self, chunk: Chunk, messages: Messages) -> tuple[Messages, list[Loss]]:
        """Leave out messages whose channels are nowhere described."""
        known = np.isin(messages.channel, [*self.channels, *self.hidden])
        if known.all():
            return messages, []
        return messages.pick(known), [undescribed(chunk, messages.pick(~known))]

    # Where and when.

    def located(self, loss: Loss) -> Loss:
        """See `Log.located`. The times are by the index, or those of the chunks around."""
        if not loss.offset:
            return loss
        chunks, end = self.chunks, loss.offset + max(loss.bytes, 1)
        first = bisect_right(chunks, loss.offset, key=lambda chunk: chunk.index_end)
        behind = bisect_left(chunks, end, key=lambda chunk: chunk.offset)
        if first < behind:
            own, behind = chunks[first], first + 1
            if not own.is_scanned:
                return loss._replace(start_time=own.start_time, end_time=own.end_time)
            # What is missing at the end of a chunk comes after all that was read of it.
            first = behind if own.offset < loss.offset and end >= own.end else first
        before = chunks[first - 1].end_time if first else None
        after = chunks[behind].start_time if behind < len(chunks) else None
        if before is not None and after is not None:
            before, after = sorted((before, after))
        return loss._replace(start_time=before, end_time=after)


def open_records(new_log: Callable[[ByteSource], RecordLog], source: ByteSource) -> RecordLog:
    """Open a file by its index; where that is absent or damaged, by all of its records."""
    log = new_log(source)
    try:
        log.use_index()
    except UnusableIndex as unusable:
        log = new_log(source.nearby())
        log.scan(unusable.loss)
    return log
