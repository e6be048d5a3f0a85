"""Copies of recorded messages, byte for byte, made while they are read."""

from collections.abc import Iterator, Sequence
from fnmatch import fnmatchcase

import numpy as np

from dogbot_logtool.errors import CallError
from dogbot_logtool.options.convert import ConvertOptions
from dogbot_logtool.reader.containers.log import Batch, Chunk, Log
from dogbot_logtool.writer.chunks import Compression, FinishedChunk, finish_chunks
from dogbot_logtool.writer.message_records import recorded

Copied = FinishedChunk | Chunk
"""A chunk of the log itself is copied as it stands."""


def copied_chunks(
    left_out: frozenset[int], compression: Compression | None, log: Log, batch: Batch
) -> list[Copied]:
    """Copy the messages of a batch: sound chunks of an MCAP verbatim, others in new chunks.

    Args:
        left_out: ids of the channels that are not copied.
        compression: None: zstd, and their own for chunks that are copied as they stand.
        log: the log.
        batch: of its messages.
    """
    batch = batch.without(left_out) if left_out else batch
    chunks: list[Copied] = []
    partial: list[slice] = []
    for loaded in batch.chunks:
        chunk = loaded.chunk
        is_kept = log.copies_chunks and compression in {None, chunk.compression or "none"}
        if is_kept and loaded.whole and loaded.indexed:
            chunks += _new_chunks(batch, partial, compression)
            partial = []
            # Where processes share the file, its bytes need not be sent from one to another.
            chunks.append(chunk if log.can_fork else as_it_stands(chunk, loaded.stored))
        else:
            partial.append(loaded.rows)
    return [*chunks, *_new_chunks(batch, partial, compression)]


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
