"""A log: its channels, its chunks, and batches of its messages as columns.

Other rooms import what they need of a log from here.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from collections.abc import Set as AbstractSet
from copy import copy
from dataclasses import replace
from functools import cached_property
from typing import Final

from dogbot_logtool.io.storage import Location, name_of
from dogbot_logtool.reader.containers.batch import Batch, LoadedChunk
from dogbot_logtool.reader.containers.contents import (
    Channel,
    Chunk,
    Contents,
    EarlierAnnotations,
    Extra,
    Schema,
    differing_counts,
)
from dogbot_logtool.reader.containers.loss import Damage, Loss, lost_messages
from dogbot_logtool.reader.containers.sources.source import ByteSource
from dogbot_logtool.reader.decode.message_table import Messages, concatenate_messages

__all__ = [
    "BATCH_SIZE",
    "Batch",
    "Channel",
    "Chunk",
    "EarlierAnnotations",
    "Extra",
    "LoadedChunk",
    "Log",
    "Loss",
    "Messages",
    "Schema",
    "Span",
    "concatenate_messages",
    "damage_of",
    "lost_messages",
    "malformed_messages",
    "wrong_statistics",
]

BATCH_SIZE: Final = 15 << 19
"""Bytes of decompressed chunks from which a batch is full: large enough to make the cost of a
numpy call small, while each process that works on one takes some 40 MB."""

_MOST_UNUSED: Final = 2 * BATCH_SIZE
"""Bytes of chunks without messages of interest from which a batch is full, too."""

Span = tuple[Chunk, ...]
"""Neighbouring chunks that make a batch."""


class Log(ABC):
    """An opened log. `read` may be called from several threads at once."""

    container: str
    """Name of the container for people: ``ROS 1 bag``, ``MCAP``."""
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

    def __init__(self, source: ByteSource, contents: Contents) -> None:
        self.source = source
        self.contents = contents
        self.channels = contents.channels
        self.chunks = contents.chunks
        self.counts = contents.counts
        self.start_time = contents.start_time
        self.end_time = contents.end_time
        self.profile = contents.profile
        self.extras = contents.extras
        self.losses = contents.losses

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

    @property
    def can_fork(self) -> bool:
        """Whether copies of this process may read it, too."""
        return self.source.can_fork

    def located(self, loss: Loss) -> Loss:
        """Return a loss in this file with the log times between which it lies, if known."""
        at_end = loss.offset and loss.offset + loss.bytes >= self.source.size
        return replace(loss, start_time=self.end_time) if at_end else loss

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


def wrong_statistics(log: Log, found: Mapping[int, int], losses: Sequence[Loss]) -> list[Loss]:
    """Compare a log's counts with its messages, after all of them were read.

    Args:
        log: the log. Counts that stand in its chunks' indexes were compared chunk by chunk.
        found: messages by channel id.
        losses: messages that are known to be missing explain a difference.
    """
    compared = all(chunk.counts is not None for chunk in log.chunks)
    if compared or lost_messages(losses) != 0:
        return []
    what = differing_counts(log.channels, log.counts, found)
    return [Loss(0, f"the log's statistics count {what}")] if what else []


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
