"""What is made of recorded messages while they are read: copies, byte for byte, and arrows."""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase

import numpy as np

from dogbot_logtool.core.scene.arrows import Arrows, classic_arrows
from dogbot_logtool.core.scene.styles import ARROW_STYLES
from dogbot_logtool.errors import CallError
from dogbot_logtool.options.convert import ConvertOptions
from dogbot_logtool.reader.containers.log import Batch, Channel, Chunk, Log
from dogbot_logtool.reader.messages.contacts import read_contacts
from dogbot_logtool.reader.messages.feet import FootChannels
from dogbot_logtool.robot.selection import Selection
from dogbot_logtool.writer.chunks import Compression, FinishedChunk, finish_chunks
from dogbot_logtool.writer.message_records import recorded


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class CopiedSpan:
    """What is made of the messages of some neighbouring chunks."""

    chunks: tuple[FinishedChunk | Chunk, ...]
    """A chunk of the log itself is copied as it stands."""
    arrows: Sequence[Arrows]
    """Of contact states as they are recorded, for a style that draws these."""
    counts: Counter[str]
    """Contact states that have none, by why."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Copier:
    """Copies the messages of a log while they are read, and draws their contact states."""

    copies: bool
    left_out: frozenset[int]
    """Ids of the channels that are not copied."""
    compression: Compression | None
    """None: zstd, and their own for chunks that are copied as they stand."""
    drawn: tuple[Channel, ...]
    """Channels whose contact states are drawn as they are recorded."""
    feet: FootChannels
    """Of these channels."""

    def __call__(self, log: Log, batch: Batch) -> CopiedSpan:
        """Return what is made of the messages of a batch."""
        arrows, counts = [], Counter[str]()
        for read in read_contacts(batch, self.drawn, self.feet):
            if read.pairs is not None:
                drawn, skipped = classic_arrows(read.pairs.contacts)
                arrows.append(drawn)
                counts += skipped
        kept = batch.without(self.left_out) if self.left_out else batch
        chunks = copied_chunks(log, kept, self.compression) if self.copies else ()
        return CopiedSpan(tuple(chunks), arrows, counts)


def copied_chunks(
    log: Log, batch: Batch, compression: Compression | None
) -> Iterator[FinishedChunk | Chunk]:
    """Yield the messages of a batch: sound chunks of an MCAP verbatim, others in new chunks."""
    partial: list[slice] = []
    for loaded in batch.chunks:
        chunk = loaded.chunk
        is_kept = log.copies_chunks and compression in {None, chunk.compression or "none"}
        if is_kept and loaded.whole and loaded.indexed:
            yield from _new_chunks(batch, partial, compression)
            partial = []
            # Where processes share the file, its bytes need not be sent from one to another.
            yield chunk if log.can_fork else as_it_stands(chunk, loaded.stored)
        else:
            partial.append(loaded.rows)
    yield from _new_chunks(batch, partial, compression)


def _new_chunks(
    batch: Batch, rows: list[slice], compression: Compression | None
) -> Iterator[FinishedChunk]:
    if not rows:
        return
    own = batch.messages.pick(slice(rows[0].start, rows[-1].stop))
    times = own.log_time, own.publish_time
    records = recorded(own.channel, own.sequence, *times, batch.buffer, own.start, own.end)
    yield from finish_chunks(records, compression or "zstd")


def as_it_stands(chunk: Chunk, stored: bytes | memoryview) -> FinishedChunk:
    """Return a chunk of an MCAP with its own index, both of which are known to be sound.

    Args:
        chunk: in the log.
        stored: its bytes, those of the index included.
    """
    record, index = np.split(np.frombuffer(stored, np.uint8), [chunk.end - chunk.offset])
    times = chunk.start_time or 0, chunk.end_time or 0
    return FinishedChunk(record, index, *times, chunk.compression, chunk.data_size, chunk.size)


def make_copier(log: Log, selection: Selection, options: ConvertOptions) -> Copier:
    """Decide what is made of recorded messages.

    Raises:
        CallError: topics are chosen, but nothing is copied.
    """
    return Copier(
        options.copy,
        channels_left_out(log, options),
        options.compression,
        selection.contacts if ARROW_STYLES[options.style].needs_contact_states else (),
        selection.foot_channels(),
    )


def channels_left_out(log: Log, options: ConvertOptions) -> frozenset[int]:
    """Return the ids of the channels that are not copied; annotations are made of all.

    Raises:
        CallError: topics are chosen, but nothing is copied.
    """
    if not options.topics:
        return frozenset()
    if not options.copy:
        raise CallError("--topics chooses what is copied; --no-copy copies nothing")
    return frozenset(
        channel.id
        for channel in log.channels.values()
        if (options.copied_topics and not _fits(channel.topic, options.copied_topics))
        or _fits(channel.topic, options.topics_left_out)
    )


def _fits(topic: str, globs: Sequence[str]) -> bool:
    return any(fnmatchcase(topic, glob) for glob in globs)
