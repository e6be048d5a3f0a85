"""Logs merged by time: files of one recording, or one file whose chunks are out of order.

Files are those of a split series, or one bag a sensor. Their chunks may overlap in time, and those
of a slow topic span much of the recording. So the merged log has chunks of its own: spans of time,
each with the messages of all files, by log time.
"""

from bisect import bisect_right
from collections import Counter
from collections.abc import Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass, field, replace
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.io.storage import Location, file_name
from dogbot_logtool.provenance import is_marked
from dogbot_logtool.reader.containers.batch import Batch, LoadedChunk
from dogbot_logtool.reader.containers.contents import Channel, Chunk, Contents, Schema
from dogbot_logtool.reader.containers.log import BATCH_SIZE, Log, Span
from dogbot_logtool.reader.containers.loss import Loss
from dogbot_logtool.reader.containers.packed_messages import unpacked
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
    start: int
    """ns; as early as can be where it is not known."""
    end: int
    """ns; as late as can be where it is not known."""


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


class _NoBytes(ByteSource):
    """Stands for the bytes of all files, each of which has its own source."""

    def __init__(self, path: Location, size: int) -> None:
        self.path = path
        self.size = size

    def read(self, offset: int, size: int) -> bytes:
        """Return nothing."""
        del offset, size
        return b""

    def close(self) -> None:
        """Do nothing."""


class MergedLog(Log):
    """Several logs that are read as one; they are closed with it."""

    def __init__(
        self,
        source: ByteSource,
        logs: Sequence[Log],
        channels: Sequence[Ints],
        contents: Contents,
    ) -> None:
        """Cut the time into windows.

        Args:
            source: of the merged log.
            logs: the logs.
            channels: ids of the merged log by each log's own.
            contents: of the merged log, but for its chunks.
        """
        self.logs = logs
        self._channel_ids = channels
        pieces = [_piece(file, chunk) for file, log in enumerate(logs) for chunk in log.chunks]
        self._windows = _windows(sorted(pieces, key=lambda piece: (piece.start, piece.file)))
        self._starts = np.array([window.start for window in self._windows])
        self._last: dict[int, tuple[AbstractSet[int], Batch]] = {}
        """What was read last of each file's chunks that begin earlier, by their offsets: they
        reach over several windows."""
        chunks = [self._chunk(number, window) for number, window in enumerate(self._windows)]
        super().__init__(source, replace(contents, chunks=chunks))

    @property
    def can_fork(self) -> bool:
        """See `Log.can_fork`."""
        return all(log.can_fork for log in self.logs)

    def _chunk(self, number: int, window: _Window) -> Chunk:
        """Return a window as a chunk; what reaches on from an earlier one is counted in each."""
        own = [piece for piece in window.pieces if window.begins(piece)]
        compressions = {piece.chunk.compression for piece in own}
        start = max(window.start, min((piece.start for piece in own), default=_EARLIEST))
        end = min(window.end - 1, max((piece.end for piece in window.pieces), default=_LATEST))
        counts: Counter[int] = Counter()
        for piece in window.pieces:
            for channel, count in (piece.chunk.counts or {}).items():
                counts[int(self._channel_ids[piece.file][channel])] += count
        known = all(piece.chunk.counts is not None for piece in window.pieces)
        return Chunk(
            offset=number,
            data_offset=number,
            data_size=sum(piece.chunk.data_size for piece in own),
            end=number + 1,
            index_end=number + 1,
            compression=compressions.pop() if len(compressions) == 1 else "",
            size=sum(piece.chunk.size for piece in own),
            start_time=None if start == _EARLIEST else start,
            end_time=None if end >= _LATEST - 1 else end,
            counts=dict(counts) if known else None,
        )

    def _read(self, span: Span) -> Batch:
        """See `Log.read`."""
        begun: dict[int, dict[int, Chunk]] = {}
        earlier: dict[int, dict[int, Chunk]] = {}
        for window in (self._windows[chunk.offset] for chunk in span):
            for piece in window.pieces:
                found = begun if window.begins(piece) else earlier
                found.setdefault(piece.file, {})[piece.chunk.offset] = piece.chunk
        parts = [self._of_file(file, chunks) for file, chunks in begun.items()]
        losses = [
            loss if self.is_reordered else _named(loss, self.logs[file])
            for file, part in zip(begun, parts, strict=True)
            for loss in part.losses
        ]
        for file, chunks in earlier.items():
            again = {at: chunks[at] for at in chunks.keys() - begun.get(file, {}).keys()}
            if again and (file not in self._last or self._last[file][0] != again.keys()):
                self._last[file] = again.keys(), self._of_file(file, again)
            parts += [self._last[file][1]] if again else []
        return self._merged(parts, span, tuple(losses))

    def _of_file(self, file: int, chunks: Mapping[int, Chunk]) -> Batch:
        """Read chunks of a file, by their offsets, with joint channels."""
        in_order = tuple(chunks[offset] for offset in sorted(chunks))
        batch = unpacked(self.logs[file].read(in_order))
        channel = self._channel_ids[file][batch.messages.channel]
        return replace(batch, messages=replace(batch.messages, channel=channel))

    def _merged(self, parts: Sequence[Batch], span: Span, losses: tuple[Loss, ...]) -> Batch:
        """Return the messages of some windows, in each of them by time."""
        offsets = np.cumsum([0, *(len(part.buffer) for part in parts)]).tolist()
        messages = concatenate_messages(
            [part.messages.shifted(offset) for part, offset in zip(parts, offsets, strict=False)]
        )
        window = np.concatenate([np.empty(0, np.int64), *map(self._windows_of, parts)])
        numbers = np.array([chunk.offset for chunk in span])
        # A chunk that is alone in its time stays as it was recorded.
        alone = np.array([len(each.pieces) == 1 for each in self._windows])
        order = np.lexsort((np.where(alone[window], 0, messages.log_time), window))
        order = order[np.isin(window[order], numbers)]
        bounds = np.searchsorted(window[order], np.append(numbers, numbers[-1] + 1)).tolist()
        buffers = [part.buffer for part in parts] or [np.zeros(1, np.uint8)]
        buffer = buffers[0] if len(buffers) == 1 else np.concatenate(buffers)
        chunks = tuple(
            LoadedChunk(chunk, memoryview(b""), 0, slice(*bounds[row : row + 2]), whole=False)
            for row, chunk in enumerate(span)
        )
        return Batch(buffer, messages.pick(order), chunks, losses)

    def _windows_of(self, part: Batch) -> Ints:
        """Return the window of each message, one of those that its chunk reaches into.

        An index that is wrong about times hides no message.
        """
        time = part.messages.log_time.copy()
        for loaded in part.chunks:
            piece = _piece(0, loaded.chunk)
            np.clip(time[loaded.rows], piece.start, piece.end, out=time[loaded.rows])
        return np.searchsorted(self._starts, time, "right") - 1

    def close(self) -> None:
        """Close all files."""
        self._last.clear()
        for log in self.logs:
            log.close()


def join(path: Location, logs: Sequence[Log], losses: Sequence[Loss] = ()) -> MergedLog:
    """Merge logs of one recording. Channels that are alike in all are one.

    Args:
        path: what the user named.
        logs: at least one.
        losses: damage to the whole.
    """
    channels: dict[tuple[object, ...], Channel] = {}
    schemas: dict[tuple[str, str, bytes], Schema] = {}
    ids = [_joint_ids(log.channels, channels, schemas) for log in logs]
    counts: Counter[int] = Counter()
    for log, own in zip(logs, ids, strict=True):
        for number, count in log.counts.items():
            counts[int(own[number])] += count
    contents = Contents(
        channels={channel.id: channel for channel in channels.values()},
        chunks=(),
        counts=counts,
        start_time=min(
            (t for t in (log.start_time for log in logs) if t is not None), default=None
        ),
        end_time=max((log.end_time for log in logs if log.end_time is not None), default=None),
        profile=logs[0].profile,
        extras=[extra for log in logs for extra in log.extras],
        losses=(*losses, *(_named(loss, log) for log in logs for loss in log.losses)),
    )
    return MergedLog(_NoBytes(path, sum(log.source.size for log in logs)), logs, ids, contents)


def reorder(log: Log) -> MergedLog:
    """Merge the chunks of a log, which are out of order, by time."""
    same = np.arange(max(log.channels, default=0) + 1)
    merged = MergedLog(log.source, [log], [same], replace(log.contents, losses=log.losses))
    merged.container = log.container
    merged.is_reordered = True
    return merged


def _joint_ids(
    own: Mapping[int, Channel],
    channels: dict[tuple[object, ...], Channel],
    schemas: dict[tuple[str, str, bytes], Schema],
) -> Ints:
    """Return joint ids by a file's own.

    Args:
        own: the file's channels.
        channels: receives those that are new, by all that makes channels alike.
        schemas: likewise.
    """
    ids = np.zeros(max(own, default=0) + 1, np.int64)
    for number, channel in own.items():
        schema = channel.schema
        if schema is not None:
            fresh = replace(schema, id=len(schemas) + 1)
            schema = schemas.setdefault((schema.name, schema.encoding, schema.data), fresh)
        kind = schema and schema.id
        key = (channel.topic, channel.message_encoding, kind, is_marked(channel.metadata))
        new = replace(channel, id=len(channels) + 1, schema=schema)
        ids[number] = channels.setdefault(key, new).id
    return ids


def _named(loss: Loss, log: Log) -> Loss:
    """Say in which file it is."""
    name = file_name(log.source.path)
    return replace(loss, what=f"{name}: {loss.what}", file=name)


def _piece(file: int, chunk: Chunk) -> _Piece:
    """Return a chunk with its times; one without messages takes no time."""
    start, end = chunk.start_time, chunk.end_time
    if start is None or end is None:
        return _Piece(file, chunk, _EARLIEST, _EARLIEST if chunk.messages == 0 else _LATEST)
    return _Piece(file, chunk, start, max(start, end))


def most_at_once(chunks: Sequence[Chunk]) -> float:
    """Return the bytes of the chunks that overlap at any one time, at most."""
    pieces = [_piece(0, chunk) for chunk in chunks]
    size = np.array([max(piece.chunk.size, _LEAST_SIZE) for piece in pieces], np.float64)
    time = np.array([[piece.start for piece in pieces], [piece.end for piece in pieces]]).ravel()
    # At the same time, what begins comes before what ends: both count.
    order = np.lexsort((np.arange(len(time)) >= len(size), time))
    return float(np.cumsum(np.concatenate([size, -size])[order]).max(initial=0.0))


def _windows(pieces: Sequence[_Piece]) -> list[_Window]:
    """Cut the time into windows that begin with a chunk.

    They begin where no other chunk reaches to, and at the latest when they hold about a batch.

    Args:
        pieces: by their start.
    """
    starts = [_EARLIEST]
    size, reached = 0, _EARLIEST
    for piece in pieces:
        is_apart = piece.start > reached or size >= BATCH_SIZE
        if size and is_apart and piece.start > starts[-1]:
            starts.append(piece.start)
            size = 0
        reached = max(reached, piece.end)
        size += max(piece.chunk.size, 1)
    windows = [
        _Window(start, end) for start, end in zip(starts, [*starts[1:], _LATEST], strict=True)
    ][: len(pieces)]
    for piece in pieces:
        first, behind = bisect_right(starts, piece.start) - 1, bisect_right(starts, piece.end)
        for window in windows[first:behind]:
            window.pieces.append(piece)
    return windows
