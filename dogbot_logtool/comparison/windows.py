"""Two logs read in lock-step: the same windows of log time of both, small enough for the memory.

Chunks need not be in the order of time, and may overlap. So the axis of time is cut where about
as many bytes lie between cuts, by the chunks' own times; then each window is loaded from
both logs by reading every chunk that reaches into it. A chunk across a cut is read twice, which
costs little, since windows are larger than chunks. Memory is bounded by the size of a window,
whatever the order of the chunks; only messages of one and the same log time cannot be parted.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from dogbot_logtool.comparison.descriptions import kind_of
from dogbot_logtool.core.arrays import Bytes, Flags, Ints
from dogbot_logtool.reader.containers.log import (
    Batch,
    Chunk,
    LoadedChunk,
    Log,
    Loss,
    Messages,
    concatenate_messages,
)
from dogbot_logtool.reader.decode.columns import gather

WINDOW_SIZE: Final = 8 << 20
"""Bytes of decompressed chunks, of both logs together, that a window aims at."""
_PARTS: Final = 64
"""Parts of a chunk that windows may divide: the bytes of each are taken to be spread evenly."""
_FIRST: Final = int(np.iinfo(np.int64).min)
_LAST: Final = int(np.iinfo(np.int64).max)

Window = tuple[int, int]
"""First and last log time, ns, both included."""


class UntrueTimes(Exception):  # noqa: N818 - the caller measures them then
    """A chunk holds messages outside the time that the log's index has, or the index has none."""


@dataclass(frozen=True, slots=True)
class Block:
    """The messages of one log in a window, by topic, in it by log time, in that in file order."""

    buffer: Bytes
    messages: Messages
    topic: Ints
    """(n,) topic numbers."""
    kind: Ints
    """(n,) numbers of the kinds of their channels."""
    nth: Ints
    """(n,) index of each among the messages of its topic and log time."""

    def payload(self, row: int) -> bytes:
        """Return the bytes of a message."""
        return self.buffer[self.messages.start[row] : self.messages.end[row]].tobytes()


class Side:
    """One of the logs, ready to be loaded window by window."""

    def __init__(
        self, log: Log, topics: Mapping[str, int], kinds: dict[str, int], *, measured: bool
    ) -> None:
        """Find the times of its chunks.

        Args:
            log: the log.
            topics: numbers of the topics that are compared.
            kinds: numbers of kinds of channels (see `kind_of`), to which new ones are added.
            measured: read all chunks for their times, instead of trusting the log's index.

        Raises:
            UntrueTimes: the times in the index are not all there, or impossible.
        """
        self.log = log
        self.losses: list[Loss] = [*log.losses]
        wanted = [(n, c) for n, c in sorted(log.channels.items()) if c.topic in topics]
        self._channels = np.array([number for number, _ in wanted], np.int64)
        self._topics = np.array([topics[channel.topic] for _, channel in wanted], np.int64)
        numbers = [kinds.setdefault(kind_of(channel), len(kinds)) for _, channel in wanted]
        self._kinds = np.array(numbers, np.int64)
        self.chunks: list[Chunk] = []
        self._is_measured = measured
        times = np.array([*(self._measured() if measured else self._indexed())], np.int64)
        self.start, self.end = times.reshape(-1, 2).T

    def _indexed(self) -> Iterator[Window]:
        for chunk in self.log.chunks:
            start, end = chunk.start_time, chunk.end_time
            if start is None or end is None or not _FIRST <= start <= end <= _LAST:
                raise UntrueTimes
            self.chunks.append(chunk)
            yield start, end

    def _measured(self) -> Iterator[Window]:
        for span in self.log.spans():
            batch = self.log.read(span)
            self.losses.extend(batch.losses)
            for loaded in batch.chunks:
                time = batch.messages.log_time[loaded.rows]
                if len(time):
                    self.chunks.append(loaded.chunk)
                    yield int(time.min()), int(time.max())

    def load(self, window: Window) -> Block:
        """Load the messages in a window.

        Raises:
            UntrueTimes: a chunk's times are not what the index says.
        """
        first, last = window
        buffers: list[Bytes] = [np.empty(0, np.uint8)]
        tables: list[Messages] = []
        reach = np.flatnonzero((self.start <= last) & (self.end >= first)).tolist()
        for span in self.log.grouped(self.chunks[row] for row in reach):
            batch = self.log.read(span)
            self.losses.extend(batch.losses)
            if not self._is_measured and not all(_is_true(each, batch) for each in batch.chunks):
                raise UntrueTimes
            time = batch.messages.log_time
            kept = (time >= first) & (time <= last)
            kept &= np.isin(batch.messages.channel, self._channels)
            buffer, messages = _packed(batch, kept)
            tables.append(messages.shifted(sum(map(len, buffers))))
            buffers.append(buffer)
        messages = concatenate_messages(tables)
        row = np.searchsorted(self._channels, messages.channel)
        order = np.lexsort((messages.log_time, self._topics[row]))
        messages, row = messages.pick(order), row[order]
        topic = self._topics[row]
        buffer = buffers[1] if len(buffers) == 2 else np.concatenate(buffers)
        nth = _index_in_run(topic, messages.log_time)
        return Block(buffer, messages, topic, self._kinds[row], nth)


def _is_true(loaded: LoadedChunk, batch: Batch) -> bool:
    """Tell whether a chunk's messages lie in the time that the index has for it."""
    time, chunk = batch.messages.log_time[loaded.rows], loaded.chunk
    if not len(time) or chunk.start_time is None or chunk.end_time is None:
        return not len(time)
    return bool(chunk.start_time <= time.min() and time.max() <= chunk.end_time)


def _packed(batch: Batch, kept: Flags) -> tuple[Bytes, Messages]:
    """Return some of the messages, and a buffer that is not much larger than they are."""
    messages = batch.messages.pick(kept)
    size = messages.end - messages.start
    if 2 * size.sum() > len(batch.buffer):
        return batch.buffer, messages
    bounds = zip(messages.start.tolist(), messages.end.tolist(), strict=True)
    data = b"".join([batch.buffer.data[start:end] for start, end in bounds])
    end = np.cumsum(size)
    return np.frombuffer(data, np.uint8), replace(messages, start=end - size, end=end)


def _index_in_run(*columns: Ints) -> Ints:
    """Return the index of each row in its run of rows that are alike; (n,)."""
    row = np.arange(len(columns[0]))
    begins = np.ones(len(row), np.bool_)
    begins[1:] = np.any([column[1:] != column[:-1] for column in columns], axis=0)
    return row - np.maximum.accumulate(np.where(begins, row, 0))


def plan_windows(sides: Sequence[Side]) -> Iterator[Window]:
    """Cut time so that each window holds about `WINDOW_SIZE` bytes, or twice the largest chunk."""
    size = np.array([chunk.size for side in sides for chunk in side.chunks], np.float64)
    first = _FIRST
    if len(size):
        start = np.concatenate([side.start for side in sides])
        end = np.concatenate([side.end for side in sides])
        # Differences of times may be beyond the signed numbers, but not the unsigned.
        origin = int(start.min())
        since = np.stack([start, end]).view(np.uint64) - np.uint64(origin % 2**64)
        time = np.linspace(since[0].astype(np.float64), since[1], _PARTS).ravel()
        order = np.argsort(time, kind="stable")
        filled = np.cumsum(np.tile(size / _PARTS, _PARTS)[order])
        count = int(size.sum() / max(WINDOW_SIZE, 2.0 * size.max()))
        wanted = filled[-1] * np.arange(1, count) / max(count, 1)
        for later in time[order][np.searchsorted(filled, wanted)].tolist():
            cut = min(origin + int(later), _LAST)
            if cut > first:
                yield first, cut - 1
                first = cut
    yield first, _LAST


def pair_messages(one: Block, other: Block) -> tuple[Ints, Ints, Ints, Ints]:
    """Pair messages of the same topic, log time, and index among those of the same.

    Returns:
        (n,) rows of the pairs in one block and (n,) in the other; (m,) rows that only the one has;
        (k,) rows that only the other has.
    """
    columns = [(b.nth, b.messages.log_time, b.topic) for b in (one, other)]
    if all(map(np.array_equal, *columns)):
        rows, none = np.arange(len(one.topic)), np.empty(0, np.int64)
        return rows, rows, none, none
    keys = [np.concatenate(both) for both in zip(*columns, strict=True)]
    count = len(one.topic)
    is_other = np.arange(len(keys[0])) >= count
    order = np.lexsort((is_other, *keys))
    # The two of a pair stand side by side now.
    first = np.flatnonzero(np.all([key[order][1:] == key[order][:-1] for key in keys], axis=0))
    alone = np.ones(len(order), np.bool_)
    alone[first] = alone[first + 1] = False
    left = order[alone]
    return order[first], order[first + 1] - count, left[left < count], left[left >= count] - count


def same_payloads(one: Block, rows: Ints, other: Block, others: Ints) -> Flags:
    """Tell of each pair of messages whether the payloads are the same, byte for byte; (n,)."""
    start, begin = one.messages.start[rows], other.messages.start[others]
    size = one.messages.end[rows] - start
    same: Flags = size == other.messages.end[others] - begin
    candidates = np.flatnonzero(same & (size > 0))
    by_size = candidates[np.argsort(size[candidates], kind="stable")]
    sizes, begins = np.unique(size[by_size], return_index=True)
    for length, pairs in zip(sizes.tolist(), np.split(by_size, begins[1:]), strict=False):
        left = gather(one.buffer, start[pairs], length)
        same[pairs] = left == gather(other.buffer, begin[pairs], length)
    return same
