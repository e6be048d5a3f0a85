"""A log as it was before `convert` annotated it."""

import struct
from collections.abc import Iterable, Iterator, Mapping
from collections.abc import Set as AbstractSet
from dataclasses import replace
from typing import Final

import numpy as np

from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.reader.containers.batch import Batch, LoadedChunk
from dogbot_logtool.reader.containers.contents import Chunk, Contents, Extra
from dogbot_logtool.reader.containers.log import Log, Span
from dogbot_logtool.reader.containers.sources.source import ByteSource

# The mcap library is not loaded for them: most commands and logs do without it.
_SCHEMA: Final = 0x03
_CHANNEL: Final = 0x04
_RECORD_HEAD: Final = struct.Struct("<BQ")
_MESSAGE_HEAD_SIZE: Final = 31
"""Bytes of an MCAP's message record before the payload."""


@dataclass(frozen=True, slots=True)
class EarlierAnnotations:
    """Annotations that `convert` added to a log."""

    channels: frozenset[int]
    """Ids of the channels."""
    extras: tuple[Extra, ...]
    """The metadata records that describe how the file was made."""
    records: tuple[Mapping[str, str], ...]
    """Their contents, the oldest first."""
    messages: int


class RecordedLog(Log):
    """A log without its annotations. Closing it closes the whole log."""

    def __init__(self, log: Log, annotations: EarlierAnnotations) -> None:
        """Leave out what was added to a log."""
        ours = annotations.channels
        super().__init__(
            log.source,
            Contents(
                channels={n: channel for n, channel in log.channels.items() if n not in ours},
                # A chunk's index may be wrong about holding only annotations: all chunks are read.
                chunks=[_without(chunk, ours) for chunk in log.chunks],
                counts={n: count for n, count in log.counts.items() if n not in ours},
                start_time=log.start_time,
                end_time=log.end_time,
                profile=log.profile,
                extras=[extra for extra in log.extras if extra not in annotations.extras],
                losses=log.losses,
            ),
        )
        self.container = log.container
        self.joined = log.joined
        self.is_reordered = log.is_reordered
        self.copies_chunks = log.copies_chunks
        self.annotations = annotations
        self._log = log
        self._chunks = {chunk.offset: chunk for chunk in log.chunks}
        schemas = (channel.schema for channel in self.channels.values())
        self._described_ids: Mapping[int, AbstractSet[int]] = {
            _CHANNEL: self.channels.keys(),
            _SCHEMA: {schema.id for schema in schemas if schema is not None},
        }

    @property
    def can_fork(self) -> bool:
        """See `Log.can_fork`."""
        return self._log.can_fork

    def source_of(self, extra: Extra) -> ByteSource:
        """See `Log.source_of`."""
        return self._log.source_of(extra)

    def overlaps(self, chunk: Chunk, start: int | None, end: int | None) -> bool:
        """See `Log.overlaps`."""
        return self._log.overlaps(chunk, start, end)

    def grouped(self, chunks: Iterable[Chunk]) -> Iterator[Span]:
        """See `Log.grouped`."""
        return self._log.grouped(chunks)

    def read(self, span: Span) -> Batch:
        """See `Log.read`."""
        batch = self._log.read(tuple(self._chunks[chunk.offset] for chunk in span))
        batch = batch.without(self.annotations.channels)
        if not self.copies_chunks:
            return batch
        chunks = (
            replace(each, whole=each.whole and not self._describes_others(each, batch))
            for each in batch.chunks
        )
        return replace(batch, chunks=tuple(chunks))

    def _describes_others(self, loaded: LoadedChunk, batch: Batch) -> bool:
        """Tell whether a chunk describes a channel or schema that is left out.

        New annotations may have its number.
        """
        return any(
            number not in self._described_ids.get(opcode, (number,))
            for opcode, number in _other_records(loaded, batch)
        )

    def close(self) -> None:
        """See `Log.close`."""
        self._log.close()


def _without(chunk: Chunk, channels: frozenset[int]) -> Chunk:
    if chunk.counts is None or channels.isdisjoint(chunk.counts):
        return chunk
    return replace(chunk, counts={n: c for n, c in chunk.counts.items() if n not in channels})


def _other_records(loaded: LoadedChunk, batch: Batch) -> Iterator[tuple[int, int]]:
    """Yield opcode and first number, an id, of the records in a chunk that are no messages."""
    rows = batch.messages.pick(loaded.rows)
    size = loaded.chunk.size
    data = batch.buffer[loaded.base : loaded.base + size].data
    begins = np.append(rows.start - loaded.base - _MESSAGE_HEAD_SIZE, size)
    ends = np.insert(rows.end - loaded.base, 0, 0)
    for gap in np.flatnonzero(ends < begins).tolist():
        offset = int(ends[gap])
        while offset < begins[gap]:
            opcode, length = _RECORD_HEAD.unpack_from(data, offset)
            body = offset + _RECORD_HEAD.size
            yield opcode, int.from_bytes(data[body : body + 2], "little")
            offset = body + length
