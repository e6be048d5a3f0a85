"""Logs merged by time: files of one recording, or one file whose chunks are out of order.

Files are those of a split series, or one bag a sensor. Their chunks may overlap in time, and those
of a slow topic span much of the recording. So the merged log has chunks of its own: spans of time,
each with the messages of all files, by log time.
"""

from bisect import bisect_right
from collections import Counter
from collections.abc import Sequence
from dataclasses import field, replace
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Flags, Ints
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.reader.containers.batch import Batch, LoadedChunk
from dogbot_logtool.reader.containers.chunks.packed_messages import unpacked
from dogbot_logtool.reader.containers.contents import Chunk, Contents, Extra
from dogbot_logtool.reader.containers.log import BATCH_SIZE, Log, Span
from dogbot_logtool.reader.containers.loss import Loss
from dogbot_logtool.reader.containers.rosbag2.joined_log import (
    JointChannels,
    SeveralLogs,
    joint_contents,
    loss_in_file,
)
from dogbot_logtool.reader.containers.sources.source import ByteSource
from dogbot_logtool.reader.decode.message_table import concatenate_messages

_EARLIEST: Final = -(1 << 62)
_LATEST: Final = 1 << 62
_LEAST_SIZE: Final = 1 << 12
"""Bytes that a chunk counts as, however small it says it is: each is looked after."""


@dataclass(frozen=True, slots=True)
class _Piece:
    """A chunk of one of the files."""

    file: int
    chunk: Chunk

    @property
    def start(self) -> int:
        """ns; as early as can be where it is not known."""
        return _EARLIEST if self.chunk.start_time is None else self.chunk.start_time

    @property
    def end(self) -> int:
        """ns; as late as can be where it is not known."""
        known = self.chunk.start_time is not None and self.chunk.end_time is not None
        return max(self.start, self.chunk.end_time or 0) if known else _LATEST


@dataclass(slots=True)
class _Window:
    """The chunks that may hold messages of a span of time."""

    start: int
    end: int
    """ns, the first time behind it."""
    pieces: list[_Piece] = field(default_factory=list)

    def begins(self, piece: _Piece) -> bool:
        """Tell whether a chunk begins in it, so that it is counted here."""
        return self.start <= piece.start < self.end


class MergedLog(SeveralLogs):
    """Logs of one recording. Channels that are alike in all are one."""

    def __init__(self, logs: Sequence[Log]) -> None:
        """Merge logs; they are closed with this one. The first one's name stands for all.

        Args:
            logs: at least two.
        """
        joint = JointChannels()
        channels = [joint.take(log.channels) for log in logs]
        self._merge(logs, channels, joint_contents(joint.channels, logs, channels))
        self.joined = tuple(log.source.path for log in logs[1:])
        kinds = sorted({log.container for log in logs})
        self.container = f"{len(logs)} joined logs ({', '.join(kinds)})"

    def _merge(self, logs: Sequence[Log], channels: Sequence[Ints], contents: Contents) -> None:
        """Cut the time into windows.

        Args:
            logs: the logs.
            channels: ids of the merged log by each log's own.
            contents: of the merged log, but for its chunks.
        """
        self._channels = channels
        pieces = [_Piece(file, chunk) for file, log in enumerate(logs) for chunk in log.chunks]
        self._windows = _windows(sorted(pieces, key=lambda piece: (piece.start, piece.file)))
        self._last: dict[int, tuple[int, Batch]] = {}
        """The batch that was read last of each file, by its chunk's offset: a long chunk reaches
        over several windows."""
        chunks = [self._chunk(number) for number in range(len(self._windows))]
        super().__init__(logs[0].source.path, logs, replace(contents, chunks=chunks))

    def _chunk(self, number: int) -> Chunk:
        window = self._windows[number]
        own = [piece for piece in window.pieces if window.begins(piece)]
        compressions = {piece.chunk.compression for piece in own}
        return Chunk(
            offset=number,
            data_offset=number,
            data_size=sum(piece.chunk.data_size for piece in own),
            end=number + 1,
            index_end=number + 1,
            compression=compressions.pop() if len(compressions) == 1 else "",
            size=sum(piece.chunk.size for piece in own),
            start_time=None if window.start == _EARLIEST else window.start,
            end_time=None if window.end == _LATEST else window.end - 1,
            counts=self._counts(window),
        )

    def _counts(self, window: _Window) -> dict[int, int] | None:
        """Count messages by joint channel: those of chunks that reach on are counted in each."""
        counts: Counter[int] = Counter()
        for piece in window.pieces:
            if piece.chunk.counts is None:
                return None
            for number, count in piece.chunk.counts.items():
                counts[int(self._channels[piece.file][number])] += count
        return dict(counts)

    def read(self, span: Span) -> Batch:
        """See `Log.read`."""
        parts: list[Batch] = []
        losses: list[Loss] = []
        for chunk in span:
            window = self._windows[chunk.offset]
            for piece in window.pieces:
                batch = self._batch(piece)
                parts.append(_within(batch, window, piece))
                if window.begins(piece):
                    losses += self._losses(batch, piece)
        return _merged(parts, span, tuple(losses))

    def _losses(self, batch: Batch, piece: _Piece) -> list[Loss]:
        return [loss_in_file(loss, self.logs[piece.file]) for loss in batch.losses]

    def _batch(self, piece: _Piece) -> Batch:
        """Read a chunk of a file, with joint channels."""
        last = self._last.get(piece.file)
        if last is not None and last[0] == piece.chunk.offset:
            return last[1]
        batch = unpacked(self.logs[piece.file].read((piece.chunk,)))
        channel = self._channels[piece.file][batch.messages.channel]
        batch = replace(batch, messages=replace(batch.messages, channel=channel))
        self._last[piece.file] = piece.chunk.offset, batch
        return batch

    def close(self) -> None:
        """Close all files."""
        self._last.clear()
        super().close()


class ReorderedLog(MergedLog):
    """One log whose chunks are out of order, merged by time."""

    is_reordered = True

    def __init__(self, log: Log) -> None:
        """Merge the chunks of a log, which is closed with this one."""
        same = np.arange(max(log.channels, default=0) + 1)
        contents = Contents(
            channels=log.channels,
            chunks=(),
            counts=log.counts,
            start_time=log.start_time,
            end_time=log.end_time,
            profile=log.profile,
            extras=log.extras,
            losses=log.losses,
        )
        self._merge([log], [same], contents)
        self.source = log.source
        self.container = log.container

    def source_of(self, extra: Extra) -> ByteSource:
        """See `Log.source_of`."""
        return self.logs[0].source_of(extra)

    def _losses(self, batch: Batch, piece: _Piece) -> list[Loss]:
        del piece
        return [*batch.losses]


def most_at_once(chunks: Sequence[Chunk]) -> float:
    """Return the bytes of the chunks that overlap at any one time, at most."""
    pieces = [_Piece(0, chunk) for chunk in chunks]
    size = np.array([max(piece.chunk.size, _LEAST_SIZE) for piece in pieces], np.float64)
    time = np.array([[piece.start for piece in pieces], [piece.end for piece in pieces]]).ravel()
    # At the same time, what begins comes before what ends: both count.
    order = np.lexsort((np.arange(len(time)) >= len(size), time))
    return float(np.cumsum(np.concatenate([size, -size])[order]).max(initial=0.0))


def _windows(pieces: Sequence[_Piece]) -> list[_Window]:
    """Cut the time into windows that begin with a chunk, each of about a batch.

    Args:
        pieces: by their start.
    """
    starts = [_EARLIEST]
    size = 0
    for piece in pieces:
        if size >= BATCH_SIZE and piece.start > starts[-1]:
            starts.append(piece.start)
            size = 0
        size += piece.chunk.size
    windows = [
        _Window(start, end) for start, end in zip(starts, [*starts[1:], _LATEST], strict=True)
    ]
    for piece in pieces:
        first, behind = bisect_right(starts, piece.start) - 1, bisect_right(starts, piece.end)
        for window in windows[first:behind]:
            window.pieces.append(piece)
    return windows


def _within(batch: Batch, window: _Window, piece: _Piece) -> Batch:
    """Return the messages in a window. An index that is wrong about times hides none."""
    time = np.clip(batch.messages.log_time, piece.start, piece.end)
    kept: Flags = (time >= window.start) & (time < window.end)
    if kept.all():
        return batch
    return replace(batch, messages=batch.messages.pick(kept))


def _merged(parts: Sequence[Batch], span: Span, losses: tuple[Loss, ...]) -> Batch:
    """Return messages of several batches, by log time."""
    offsets = np.cumsum([0, *(len(part.buffer) for part in parts)]).tolist()
    messages = concatenate_messages(
        [part.messages.shifted(offset) for part, offset in zip(parts, offsets, strict=False)]
    )
    buffers = [part.buffer for part in parts] or [np.zeros(1, np.uint8)]
    chunks = tuple(
        LoadedChunk(chunk, memoryview(b""), 0, slice(0, 0), whole=False) for chunk in span
    )
    return Batch(np.concatenate(buffers), messages, chunks, losses).by_time()
