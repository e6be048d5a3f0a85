"""A log as this program sees it: channels, chunks, and batches of messages as columns."""

from abc import ABC, abstractmethod
from bisect import bisect_right
from collections.abc import Iterable, Iterator, Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import islice
from typing import Final

import numpy as np

from dogbot_logtool.core.geometry.arrays import Bytes, Flags, Ints
from dogbot_logtool.reader.containers.channel_ids import UNKNOWN_CHANNEL, ChannelIds
from dogbot_logtool.reader.containers.source import ByteSource
from dogbot_logtool.reader.decode.definition import short_type_name
from dogbot_logtool.reader.decode.message_table import Messages, concatenate_messages
from dogbot_logtool.reader.salvage.losses import Loss, lost_messages

__all__ = [
    "BATCH_SIZE",
    "Batch",
    "Channel",
    "Chunk",
    "ChunkContent",
    "ChunkDamage",
    "Contents",
    "Extra",
    "LoadedChunk",
    "Log",
    "Loss",
    "Messages",
    "Schema",
    "Span",
    "concatenate_messages",
    "left_out",
    "lost_messages",
    "undescribed",
]

BATCH_SIZE: Final = 15 << 19
"""Bytes of decompressed chunks from which a batch is full: large enough to make the cost of a
numpy call small, and yet each process that works on one takes some 40 MB."""

_ROUND_SIZE: Final = 1 << 20


class ChunkDamage(Exception):  # noqa: N818 - it never reaches a user; `Loss` does
    """A chunk cannot be used; the text says why."""

    def __init__(self, what: str, messages: int | None = None) -> None:
        """Say why.

        Args:
            what: the rest of the sentence "it was left out: ...".
            messages: how many were in it, if an index behind it tells.
        """
        super().__init__(what)
        self.messages = messages


@dataclass(frozen=True, slots=True)
class Schema:
    """A recorded message definition."""

    id: int
    name: str
    """Type name as recorded."""
    encoding: str
    """``ros1msg``, ``ros2msg``, ``ros2idl``, ``protobuf`` ..."""
    data: bytes


@dataclass(frozen=True, slots=True)
class Channel:
    """A topic as one sender wrote it; a topic may have several."""

    id: int
    topic: str
    message_encoding: str
    """``ros1``, ``cdr``, ``protobuf`` ..."""
    schema: Schema | None
    metadata: Mapping[str, str]

    @property
    def type_name(self) -> str:
        """``package/Name`` whatever the spelling in the log; empty without a schema."""
        return short_type_name(self.schema.name) if self.schema else ""


@dataclass(frozen=True, slots=True)
class Chunk:
    """Where a chunk of messages lies in the file."""

    offset: int
    """First byte of the chunk's record."""
    data_offset: int
    data_size: int
    """Bytes as stored."""
    end: int
    """End of the chunk's record, where the records that index it begin."""
    index_end: int
    compression: str
    size: int
    """Bytes when decompressed, as claimed."""
    crc: int = 0
    """CRC-32 of the decompressed bytes; 0: none recorded."""
    start_time: int | None = None
    """ns, log time of its first message, if known; also `end_time`."""
    end_time: int | None = None
    counts: Mapping[int, int] | None = None
    """Messages by channel id, if an index tells or opening the log counted them."""
    surveyed: bool = False
    """Opening the log looked into it, so that its damage is among the log's losses already."""

    @property
    def messages(self) -> int | None:
        """Number of messages, if an index tells."""
        return None if self.counts is None else sum(self.counts.values())

    @property
    def is_compressed(self) -> bool:
        """Whether its bytes are stored in another form."""
        return self.compression not in {"", "none"}

    @property
    def is_record(self) -> bool:
        """Whether it is a chunk record, not bare messages that only are read like one."""
        return self.data_offset > self.offset


@dataclass(frozen=True, slots=True)
class LoadedChunk:
    """A chunk in a batch."""

    chunk: Chunk
    stored: memoryview
    """Its bytes as they stand in the file, where the log copies chunks; else none."""
    base: int
    """Where its decompressed bytes begin in the batch's buffer."""
    rows: slice
    """Its rows in the batch's messages."""
    whole: bool
    """Nothing in it was damaged, so that its bytes may be copied as they stand, and those of its
    index if it is `indexed`."""
    indexed: bool = False
    """An index that truthfully names all its messages follows it in the file."""


@dataclass(frozen=True, slots=True)
class Batch:
    """A run of decompressed messages."""

    buffer: Bytes
    """(b,) uint8."""
    messages: Messages
    chunks: tuple[LoadedChunk, ...]
    losses: tuple[Loss, ...] = ()

    @property
    def counts(self) -> dict[int, int]:
        """Messages by channel id."""
        counts = np.bincount(self.messages.channel)
        found = np.flatnonzero(counts)
        return dict(zip(found.tolist(), counts[found].tolist(), strict=True))

    def cropped(self, start: int | None, end: int | None) -> "Batch":
        """Leave out messages recorded before the start or after the end, ns; None: no limit."""
        if start is None and end is None:
            return self
        time = self.messages.log_time
        kept = np.ones(len(time), np.bool_)
        if start is not None:
            kept &= time >= start
        if end is not None:
            kept &= time <= end
        return self._only(kept)

    def without(self, channels: AbstractSet[int]) -> "Batch":
        """Leave out the messages of some channels."""
        return self._only(~np.isin(self.messages.channel, list(channels)))

    def _only(self, kept: Flags) -> "Batch":
        """Return some of the messages; chunks that lose any are not whole."""
        bounds = np.concatenate([[0], np.cumsum(kept)])
        chunks = tuple(
            replace(
                loaded,
                rows=slice(int(bounds[loaded.rows.start]), int(bounds[loaded.rows.stop])),
                whole=loaded.whole and bool(kept[loaded.rows].all()),
            )
            for loaded in self.chunks
        )
        return replace(self, messages=self.messages.pick(kept), chunks=chunks)


Span = tuple[Chunk, ...]
"""Neighbouring chunks that make a batch."""


@dataclass(frozen=True, slots=True)
class ChunkContent:
    """What a container's own code finds in a decompressed chunk."""

    messages: Messages
    """Channels as numbered in the records, places relative to the chunk's first byte."""
    others: Ints
    """(k, 3) records that are no messages: kind, first byte, and end."""
    losses: tuple[Loss, ...] = ()
    indexed: bool = False
    """The index behind the chunk names all messages truthfully."""


@dataclass(frozen=True, slots=True)
class Extra:
    """A record that is no message: an MCAP attachment or metadata record, copied as it is."""

    opcode: int
    offset: int
    size: int
    file: int = 0
    """Number of the file that it stands in, where a log has several."""


@dataclass(frozen=True, slots=True)
class Contents:
    """What opening a log found out about it, without reading its messages."""

    channels: Mapping[int, Channel]
    chunks: Sequence[Chunk]
    counts: Mapping[int, int]
    """Messages by channel id."""
    start_time: int | None
    """ns, log time of the earliest message; None for an empty log; also `end_time`."""
    end_time: int | None
    profile: str = ""
    extras: Sequence[Extra] = ()
    losses: Sequence[Loss] = field(default=())
    """Damage found so far."""


def left_out(chunk: Chunk, damage: ChunkDamage) -> Loss:
    """Say that nothing in a chunk can be used."""
    what = f"the chunk at byte {chunk.offset} was left out: {damage}"
    messages = chunk.messages if damage.messages is None else damage.messages
    return Loss(chunk.offset, what, chunk.data_size, messages)


def undescribed(chunk: Chunk, messages: int, size: int) -> Loss:
    """Say that nothing tells what some messages of a chunk are.

    Args:
        chunk: the chunk.
        messages: their number.
        size: bytes of their payloads.
    """
    what = (
        f"the chunk at byte {chunk.offset} holds {messages} "
        f"{'message' if messages == 1 else 'messages'} of channels that are nowhere described"
    )
    return Loss(chunk.offset, what, size, messages)


class Log(ABC):
    """An opened log. `read` may be called from several threads at once."""

    container: str
    """What people call the container: ``ROS 1 bag``, ``MCAP``."""
    copies_chunks: bool = False
    """Whether its chunks are an MCAP's and can be copied into one as they stand."""

    def __init__(self, source: ByteSource, contents: Contents) -> None:
        self.source = source
        self.channels = contents.channels
        self.chunks = contents.chunks
        self.counts = contents.counts
        self.start_time = contents.start_time
        self.end_time = contents.end_time
        self.profile = contents.profile
        self.extras = contents.extras
        self.losses = contents.losses
        self._channel_ids = ChannelIds({number: number for number in contents.channels})

    @property
    def compressions(self) -> tuple[str, ...]:
        """Compressions of the chunks, sorted, ``none`` for the absence of one."""
        return tuple(sorted({chunk.compression or "none" for chunk in self.chunks}))

    @cached_property
    def channels_by_topic(self) -> Mapping[str, tuple[Channel, ...]]:
        """The channels of each topic."""
        found: dict[str, list[Channel]] = {}
        for channel in self.channels.values():
            found.setdefault(channel.topic, []).append(channel)
        return {topic: tuple(channels) for topic, channels in found.items()}

    def spans(self, start: int | None = None, end: int | None = None) -> Iterator[Span]:
        """Group the chunks into batches, in file order.

        Args:
            start: ns; chunks that end before are left out.
            end: ns; chunks that begin later are left out.
        """
        yield from self.grouped(chunk for chunk in self.chunks if self._overlaps(chunk, start, end))

    def _overlaps(self, chunk: Chunk, start: int | None, end: int | None) -> bool:
        """Tell whether a chunk may hold messages of a time span."""
        return not (
            (start is not None and chunk.end_time is not None and chunk.end_time < start)
            or (end is not None and chunk.start_time is not None and chunk.start_time > end)
        )

    def grouped(self, chunks: Iterable[Chunk]) -> Iterator[Span]:
        """Group chunks, in file order, into what can be read at once."""
        group: list[Chunk] = []
        size = 0
        for chunk in chunks:
            group.append(chunk)
            size += chunk.size
            if size >= BATCH_SIZE:
                yield tuple(group)
                group, size = [], 0
        if group:
            yield tuple(group)

    @property
    def can_fork(self) -> bool:
        """Whether copies of this process may read it, too."""
        return self.source.can_fork

    def source_of(self, extra: Extra) -> ByteSource:
        """Return the file that an attachment or metadata record stands in."""
        del extra
        return self.source

    def after(self, span: Span) -> Iterator[Chunk]:
        """Yield the chunks that follow a batch, in file order."""
        following = bisect_right(self.chunks, span[-1].offset, key=lambda chunk: chunk.offset)
        yield from islice(self.chunks, following, None)

    def read(self, span: Span) -> Batch:
        """Read and decompress chunks and find their messages. Damage becomes losses."""
        sound: list[Chunk] = []
        losses: list[Loss] = []
        for chunk in span:
            try:
                self.check(chunk)
            except ChunkDamage as damage:
                losses.append(left_out(chunk, damage))
            else:
                sound.append(chunk)
        places = [(chunk.offset, chunk.index_end - chunk.offset) for chunk in sound]
        stored = [memoryview(data) for data in self.source.read_many(places)]

        size = sum(chunk.size for chunk in sound)
        # Of sizes that recur, the allocator uses memory again; each process then holds less.
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
                continue
            messages, found = self._described(chunk, content)
            rows = slice(row, row + len(messages))
            has_index = len(data) > chunk.end - chunk.offset
            whole = chunk.is_record and not found and content.indexed == has_index
            kept = data if self.copies_chunks else memoryview(b"")
            loaded.append(LoadedChunk(chunk, kept, base, rows, whole, content.indexed))
            parts.append(messages.shifted(base))
            losses.extend(() if chunk.surveyed else found)
            base, row = base + chunk.size, rows.stop
        return Batch(buffer, concatenate_messages(parts), tuple(loaded), tuple(losses))

    @abstractmethod
    def check(self, chunk: Chunk) -> None:
        """Check what a chunk claims before memory is set aside for it.

        Raises:
            ChunkDamage: it cannot be honest.
        """

    @abstractmethod
    def parse(self, chunk: Chunk, stored: memoryview, target: Bytes) -> ChunkContent:
        """Decompress a chunk into the target and find its messages.

        Args:
            chunk: the chunk.
            stored: the file's bytes from `chunk.offset` to `chunk.index_end`, or fewer.
            target: (chunk.size,) uint8.

        Raises:
            ChunkDamage: nothing in the chunk can be trusted.
        """

    def _described(self, chunk: Chunk, content: ChunkContent) -> tuple[Messages, list[Loss]]:
        """Give messages the ids of their channels; leave out those that are nowhere described."""
        messages, losses = content.messages, list(content.losses)
        messages = replace(messages, channel=self._channel_ids.of(messages.channel))
        known = messages.channel != UNKNOWN_CHANNEL
        if not known.all():
            strange = messages.pick(~known)
            size = int((strange.end - strange.start).sum())
            losses.append(undescribed(chunk, len(strange), size))
            messages = messages.pick(known)
        return messages, losses

    def close(self) -> None:
        """Close the file."""
        self.source.close()
