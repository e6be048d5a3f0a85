"""A log: its channels, its chunks, and batches of its messages as columns."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from collections.abc import Set as AbstractSet
from copy import copy
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Final, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.arrays import Bytes, Flags, Ints, concatenated, picked
from dogbot_logtool.io.storage import Location, name_of
from dogbot_logtool.reader.containers.loss import LONGEST_NAME, Damage, Loss, lost_messages
from dogbot_logtool.reader.containers.source import ByteSource
from dogbot_logtool.reader.decode.definition import short_type_name

BATCH_SIZE: Final = 15 << 19
"""Bytes of decompressed chunks from which a batch is full: large enough to make the cost of a
numpy call small, while each process that works on one takes some 40 MB."""

_MOST_UNUSED: Final = 2 * BATCH_SIZE
"""Bytes of chunks without messages of interest from which a batch is full, too."""


class Schema(NamedTuple):
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
    metadata: Mapping[str, str] = field(hash=False)

    @property
    def type_name(self) -> str:
        """``package/Name`` whatever the spelling in the log; empty without a schema."""
        return short_type_name(self.schema.name) if self.schema else ""


class Chunk(NamedTuple):
    """Position of a chunk of messages in the file."""

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
    """Messages by channel id, from an index or counted when the log was opened; None: unknown."""
    is_scanned: bool = False
    """It was read when the log was opened, so that its damage is among the log's losses."""
    file: int = 0
    """Which of several joined files it stands in."""

    @property
    def messages(self) -> int | None:
        """Number of messages; None: unknown."""
        return None if self.counts is None else sum(self.counts.values())

    @property
    def is_compressed(self) -> bool:
        """Whether its bytes are stored in another form."""
        return self.compression not in {"", "none"}

    @property
    def is_record(self) -> bool:
        """Whether it is a chunk record, not bare messages that only are read like one."""
        return self.data_offset > self.offset


Span = tuple[Chunk, ...]
"""Neighbouring chunks that make a batch."""


class Extra(NamedTuple):
    """A record that is no message: an MCAP attachment or metadata record, copied as it is."""

    opcode: int
    offset: int
    size: int
    source: ByteSource
    """The file that it stands in."""


class EarlierAnnotations(NamedTuple):
    """Annotations that `convert` added to a log."""

    channels: frozenset[int] = frozenset()
    """Ids of the channels."""
    extras: tuple[Extra, ...] = ()
    """The metadata records that describe how the file was made."""
    records: tuple[Mapping[str, str], ...] = ()
    """Their contents, the oldest first."""
    messages: int = 0


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Messages:
    """Messages in the order in which they stand in the file."""

    channel: NDArray[np.int64]
    """(n,) channel ids."""
    log_time: Ints
    """(n,) ns."""
    publish_time: Ints
    """(n,) ns."""
    sequence: Ints
    """(n,)."""
    start: Ints
    """(n,) where each payload begins in the batch's buffer."""
    end: Ints
    """(n,) where it ends."""

    def __len__(self) -> int:
        return len(self.channel)

    def pick(self, rows: Flags | Ints | slice) -> Self:
        """Return the chosen rows."""
        return picked(self, rows)

    def shifted(self, offset: int) -> "Messages":
        """Return the same messages for a buffer in which their bytes lie `offset` further on."""
        return replace(self, start=self.start + offset, end=self.end + offset)


def concatenate_messages(parts: Sequence[Messages]) -> Messages:
    """Stack message tables."""
    return concatenated(parts) if parts else Messages(*np.empty((6, 0), np.int64))


class LoadedChunk(NamedTuple):
    """A chunk in a batch."""

    chunk: Chunk
    stored: memoryview
    """Its bytes as they stand in the file, where the log copies chunks; else none."""
    rows: slice
    """Its rows in the batch's messages."""
    whole: bool
    """Nothing in it was damaged, and an index that truthfully names all its messages follows it in
    the file, so that the bytes of both may be copied as they stand."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Batch:
    """A run of decompressed messages."""

    buffer: Bytes
    """(b,) uint8."""
    messages: Messages
    chunks: tuple[LoadedChunk, ...]
    losses: tuple[Loss, ...] = ()
    decoded: dict[object, Any] = field(init=False, repr=False, compare=False)
    """Columns that `decode_channels` made of it, which may be asked for again."""

    def __post_init__(self) -> None:
        """Begin with nothing decoded, also where a batch is made of another one."""
        object.__setattr__(self, "decoded", {})

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
        return self.only(kept)

    def without(self, channels: AbstractSet[int]) -> "Batch":
        """Leave out the messages of some channels."""
        return self.only(~np.isin(self.messages.channel, list(channels)))

    def only(self, kept: Flags) -> "Batch":
        """Return some of the messages; chunks that lose any are not whole."""
        bounds = np.concatenate([[0], np.cumsum(kept)])
        chunks = tuple(
            loaded._replace(
                rows=slice(int(bounds[loaded.rows.start]), int(bounds[loaded.rows.stop])),
                whole=loaded.whole and bool(kept[loaded.rows].all()),
            )
            for loaded in self.chunks
        )
        return replace(self, messages=self.messages.pick(kept), chunks=chunks)


class Log(ABC):
    """An opened log. `read` may be called from several threads at once."""

    container: str
    """Name of the container for people: ``ROS 1 bag``, ``MCAP``."""
    channels: Mapping[int, Channel]
    """By id."""
    chunks: Sequence[Chunk]
    counts: Mapping[int, int]
    """Messages by channel id."""
    start_time: int | None
    """ns, log time of the earliest message; None for an empty log; also `end_time`."""
    end_time: int | None
    profile: str = ""
    extras: Sequence[Extra] = ()
    losses: Sequence[Loss] = ()
    """Damage found when it was opened."""
    reopen: "Callable[[], Log] | None" = None
    """Opens it again, in another process; None: that cannot be."""
    joined: tuple[Location, ...] = ()
    """Further files that are read with it."""
    hidden: frozenset[int] = frozenset()
    """Channels in the file that are left out."""
    annotations: EarlierAnnotations | None = None
    """What was added to it, and is left out."""
    copies_chunks: bool = False
    """Whether its chunks are an MCAP's and can be copied into one as they stand."""

    def __init__(self, source: ByteSource) -> None:
        self.source = source

    @property
    def compressions(self) -> tuple[str, ...]:
        """Compressions of the chunks, sorted, ``none`` for the absence of one."""
        return tuple(sorted({chunk.compression or "none" for chunk in self.chunks}))

    @property
    def words(self) -> tuple[str, ...]:
        """Its name on the command line."""
        files = tuple(name_of(path) for path in (self.source.path, *self.joined))
        return (*files, "--join") if self.joined else files

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
        yield from self.grouped(chunk for chunk in self.chunks if self.overlaps(chunk, start, end))

    def overlaps(self, chunk: Chunk, start: int | None, end: int | None) -> bool:
        """Tell whether a chunk may hold messages of a time span."""
        return not (
            (start is not None and chunk.end_time is not None and chunk.end_time < start)
            or (end is not None and chunk.start_time is not None and chunk.start_time > end)
        )

    def chunks_of(self, channels: AbstractSet[int]) -> Iterator[Chunk]:
        """Yield the chunks that may have messages of some channels, given by their ids."""
        for chunk in self.chunks if channels else ():
            if chunk.counts is None or not channels.isdisjoint(chunk.counts):
                yield chunk

    def grouped(self, chunks: Iterable[Chunk]) -> Iterator[Span]:
        """Group chunks, in file order, into what can be read at once."""
        group: list[Chunk] = []
        sizes = {True: 0, False: 0}
        for chunk in chunks:
            # A chunk without messages does not change how the others are grouped.
            is_used = chunk.counts is None or any(
                count for number, count in chunk.counts.items() if number not in self.hidden
            )
            if (is_used and sizes[True] >= BATCH_SIZE) or sizes[False] >= _MOST_UNUSED:
                yield tuple(group)
                group, sizes = [], {True: 0, False: 0}
            group.append(chunk)
            sizes[is_used] += chunk.size
        if group:
            yield tuple(group)

    def located(self, loss: Loss) -> Loss:
        """Return a loss in this file with the log times between which it lies, if known."""
        at_end = loss.offset and loss.offset + loss.bytes >= self.source.size
        return loss._replace(start_time=self.end_time) if at_end else loss

    def without(self, annotations: EarlierAnnotations) -> "Log":
        """Return the same log as it was before it was annotated.

        A chunk's index may be wrong about holding only such messages: all chunks are read.
        """
        log = copy(self)
        log.__dict__.pop("channels_by_topic", None)
        log.annotations = annotations
        log.hidden = hidden = annotations.channels
        log.channels = {n: each for n, each in self.channels.items() if n not in hidden}
        log.counts = {n: count for n, count in self.counts.items() if n not in hidden}
        log.extras = [extra for extra in self.extras if extra not in annotations.extras]
        return log

    def read(self, span: Span) -> Batch:
        """Read and decompress chunks and find their messages. Damage becomes losses."""
        batch = self._read(span)
        return batch.without(self.hidden) if self.hidden else batch

    @abstractmethod
    def _read(self, span: Span) -> Batch:
        """Read chunks, with the messages of all channels."""

    def close(self) -> None:
        """Close the file."""
        self.source.close()


def time_range(parts: Sequence["Chunk | Log"]) -> tuple[int | None, int | None]:
    """Return when the first of some parts begins and the last one ends, ns, as far as known."""
    starts = [part.start_time for part in parts if part.start_time is not None]
    ends = [part.end_time for part in parts if part.end_time is not None]
    return min(starts, default=None), max(ends, default=None)


def counts_by_channel(messages: Messages) -> dict[int, int]:
    """Return the number of messages of each channel, by its id."""
    numbers, counts = np.unique(messages.channel, return_counts=True)
    return dict(zip(numbers.tolist(), counts.tolist(), strict=True))


def wrong_statistics(log: Log, found: Mapping[int, int], losses: Sequence[Loss]) -> list[Loss]:
    """Compare a log's counts, or those of its chunks' indexes, with its messages.

    Args:
        log: the log, all of whose messages were read.
        found: messages by channel id.
        losses: messages that are known to be missing explain a difference.
    """
    numbers = sorted({*log.counts, *found})
    wrong = [n for n in numbers if log.counts.get(n, 0) != found.get(n, 0)]
    if not wrong or lost_messages(losses) != 0:
        return []
    stated, first = log.counts.get(wrong[0], 0), found.get(wrong[0], 0)
    topic = log.channels[wrong[0]].topic[:LONGEST_NAME]
    more = f" ({len(wrong) - 1} more wrong)" if len(wrong) > 1 else ""
    what = f"the log's statistics count {stated} messages of {topic}, but {first} were found{more}"
    return [Loss(0, what)]


def damage_of(log: Log, losses: Iterable[Loss]) -> Damage:
    """Return what was lost of a log.

    Args:
        log: the log.
        losses: all that were found, in opening it and in reading it.
    """
    return Damage(name_of(log.source.path), tuple(losses), log.start_time)


def malformed_messages(
    channels: Mapping[int, Channel], malformed: Mapping[int, int], consequence: str = ""
) -> list[Loss]:
    """Return the loss of messages that could not be decoded.

    Args:
        channels: by id.
        malformed: number of such messages by channel id.
        consequence: what that means, to end the sentence with.
    """
    return [
        Loss(
            0,
            f"{count} messages of {channels[number].topic} could not be decoded{consequence}",
            0,
            count,
        )
        for number, count in sorted(malformed.items())
    ]
