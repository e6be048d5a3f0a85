"""Two logs cut into the same windows of log time, each small enough to hold in memory.

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

from dogbot_logtool.core.arrays import Bytes, Floats, Ints
from dogbot_logtool.reader.containers.log import (
    Batch,
    Chunk,
    Log,
    Loss,
    Messages,
    concatenate_messages,
)

WINDOW_SIZE: Final = 8 << 20
"""Bytes of decompressed chunks, of both logs together, that a window aims at."""


_FIRST: Final = int(np.iinfo(np.int64).min)
_LAST: Final = int(np.iinfo(np.int64).max)


class UntrueTimes(Exception):  # noqa: N818 - the caller measures them then
    """A chunk holds messages outside the time that the log's index has, or the index has none."""


@dataclass(frozen=True, slots=True)
class Window:
    """A span of log time, ns, both ends included."""

    first: int
    last: int


@dataclass(frozen=True, slots=True)
class Block:
    """The messages of one log in a window."""

    buffer: Bytes
    messages: Messages
    """In file order."""
    topic: Ints
    """(n,) topic numbers."""
    losses: tuple[Loss, ...]


@dataclass(frozen=True, slots=True)
class Track:
    """A log made ready to be loaded window by window."""

    log: Log
    chunks: Sequence[Chunk]
    """Those that are read, in file order."""
    start: Ints
    """(n,) ns, log time of each chunk's first message, or earlier."""
    end: Ints
    """(n,) ns, of its last, or later."""
    topic_of: Mapping[int, int]
    """Topic number by channel id; channels that are left out are missing."""
    losses: tuple[Loss, ...] = ()
    """Found on the way."""


def indexed_track(log: Log, topic_of: Mapping[int, int]) -> Track:
    """Trust the times in the log's index; `load` notices if they are wrong.

    Raises:
        UntrueTimes: they are not all there, or impossible.
    """
    times: list[tuple[int, int]] = []
    for chunk in log.chunks:
        start, end = chunk.start_time, chunk.end_time
        if start is None or end is None or not _FIRST <= start <= end <= _LAST:
            raise UntrueTimes
        times.append((start, end))
    return Track(log, log.chunks, *_columns(times), topic_of)


def measured_track(log: Log, topic_of: Mapping[int, int]) -> Track:
    """Find the chunks' times by reading them all."""
    chunks: list[Chunk] = []
    times: list[tuple[int, int]] = []
    losses: list[Loss] = []
    for span in log.spans():
        batch = log.read(span)
        losses.extend(batch.losses)
        for loaded in batch.chunks:
            time = batch.messages.log_time[loaded.rows]
            if len(time):
                chunks.append(loaded.chunk)
                times.append((int(time.min()), int(time.max())))
    return Track(log, chunks, *_columns(times), topic_of, tuple(losses))


def _columns(times: Sequence[tuple[int, int]]) -> tuple[Ints, Ints]:
    table = np.array(times, np.int64).reshape(-1, 2)
    return table[:, 0], table[:, 1]


def plan_windows(tracks: Sequence[Track], window_size: int = WINDOW_SIZE) -> Iterator[Window]:
    """Cut time so that each window holds about so many bytes, or twice the largest chunk.

    Each chunk's bytes are taken to be spread evenly over its time.
    """
    size = np.array([chunk.size for track in tracks for chunk in track.chunks], np.float64)
    start = np.concatenate([track.start for track in tracks])
    end = np.concatenate([track.end for track in tracks])
    first = _FIRST
    if len(size):
        count = int(size.sum() / max(window_size, 2 * size.max(), 1))
        origin = int(start.min())
        for later in _cuts(_since(origin, start), _since(origin, end), size, count):
            cut = min(origin + later, _LAST)
            if cut > first:
                yield Window(first, cut - 1)
                first = cut
    yield Window(first, _LAST)


def _since(origin: int, time: Ints) -> Floats:
    """Return ns since the origin, to the nanosecond within some weeks, whatever the origin."""
    # The difference of two times can be beyond the signed numbers, but not the unsigned.
    return (time.view(np.uint64) - np.uint64(origin % 2**64)).astype(np.float64)


def _cuts(start: Floats, end: Floats, size: Floats, count: int) -> list[int]:
    """Return the times that cut the bytes into `count` equal parts."""
    # A chunk has some length, also where a nanosecond more is no other float.
    end = np.maximum(end + 1.0, np.nextafter(start, np.inf))
    density = size / (end - start)
    time = np.concatenate([start, end])
    slope = np.concatenate([density, -density])
    order = np.argsort(time, kind="stable")
    time, slope = time[order], np.maximum(np.cumsum(slope[order]), 0.0)
    bytes_before = np.concatenate([[0.0], np.cumsum(slope[:-1] * np.diff(time))])
    wanted = bytes_before[-1] * np.arange(1, count) / max(count, 1)
    return [int(cut) for cut in np.interp(wanted, bytes_before, time).tolist()]


def load(track: Track, window: Window) -> Block:
    """Load a log's messages in a window.

    Raises:
        UntrueTimes: a chunk's times are not what the index says.
    """
    parts: list[Bytes] = []
    tables: list[Messages] = []
    losses: list[Loss] = []
    size = 0
    for rows in _spans(track, window):
        batch = track.log.read(tuple(track.chunks[row] for row in rows))
        losses.extend(batch.losses)
        _check_times(track, rows, batch)
        buffer, messages = _taken(batch, track.topic_of, window)
        parts.append(buffer)
        tables.append(messages.shifted(size))
        size += len(buffer)
    messages = concatenate_messages(tables)
    buffer = parts[0] if len(parts) == 1 else np.concatenate([np.empty(0, np.uint8), *parts])
    return Block(buffer, messages, _topics(messages, track.topic_of), tuple(losses))


def _spans(track: Track, window: Window) -> Iterator[list[int]]:
    """Group the chunks that reach into a window into batches, in file order, as row numbers."""
    reach = (track.start <= window.last) & (track.end >= window.first)
    rows = np.flatnonzero(reach).tolist()
    for span in track.log.grouped([track.chunks[row] for row in rows]):
        yield rows[: len(span)]
        rows = rows[len(span) :]


def _check_times(track: Track, rows: Sequence[int], batch: Batch) -> None:
    row_of = {track.chunks[row].offset: row for row in rows}
    for loaded in batch.chunks:
        row = row_of[loaded.chunk.offset]
        time = batch.messages.log_time[loaded.rows]
        if len(time) and (time.min() < track.start[row] or time.max() > track.end[row]):
            raise UntrueTimes


def _taken(batch: Batch, topic_of: Mapping[int, int], window: Window) -> tuple[Bytes, Messages]:
    """Return the wanted messages, and a buffer that is not much larger than they are."""
    messages = batch.messages
    wanted = (messages.log_time >= window.first) & (messages.log_time <= window.last)
    wanted &= np.isin(messages.channel, list(topic_of))
    if wanted.all():
        return batch.buffer, messages
    messages = messages.pick(wanted)
    size = messages.end - messages.start
    if 2 * size.sum() > len(batch.buffer):
        return batch.buffer, messages
    data = batch.buffer.data
    bounds = zip(messages.start.tolist(), messages.end.tolist(), strict=True)
    buffer = np.frombuffer(b"".join([data[start:end] for start, end in bounds]), np.uint8)
    end = np.cumsum(size)
    return buffer, replace(messages, start=end - size, end=end)


def _topics(messages: Messages, topic_of: Mapping[int, int]) -> Ints:
    channels, which = np.unique(messages.channel, return_inverse=True)
    return np.array([topic_of[channel] for channel in channels.tolist()], np.int64)[which]
