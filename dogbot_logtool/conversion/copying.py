"""Copy recorded messages into the output, byte for byte; choose the topics that are copied."""

from collections.abc import Iterator, Sequence
from fnmatch import fnmatchcase

import numpy as np

from dogbot_logtool.errors import CallError
from dogbot_logtool.finding import Finding
from dogbot_logtool.io.printable import listed
from dogbot_logtool.options import ConvertOptions
from dogbot_logtool.reader.containers.log import Batch, Chunk, LoadedChunk, Log, Messages, Span
from dogbot_logtool.writer.chunks import (
    Compression,
    FinishedChunk,
    as_indexed,
    chunk_rows,
    finish_chunk,
    indexed_chunk,
)
from dogbot_logtool.writer.message_records import MESSAGE_HEAD, record_bounds, recorded


def copied_chunks(
    batch: Batch, compression: Compression | None, *, verbatim: bool
) -> Iterator[FinishedChunk]:
    """Yield the messages of a batch: whole chunks verbatim, others in new chunks.

    Args:
        batch: what was read.
        compression: of the output; None: zstd, and their own for chunks that are copied verbatim.
        verbatim: whether the log is an MCAP, so that its chunks may be copied as they are.
    """
    partial: list[slice] = []
    for loaded in batch.chunks:
        stored = loaded.chunk.compression or "none"
        if verbatim and loaded.whole and compression in {None, stored}:
            yield from _new_chunks(batch, partial, compression)
            partial = []
            yield _unchanged(batch.messages, loaded)
        else:
            partial.append(loaded.rows)
    yield from _new_chunks(batch, partial, compression)


def _new_chunks(
    batch: Batch, rows: list[slice], compression: Compression | None
) -> Iterator[FinishedChunk]:
    if not rows:
        return
    messages = batch.messages.pick(slice(rows[0].start, rows[-1].stop))
    # One chunk at a time fits the processor's cache until it is compressed.
    for chunk in chunk_rows(record_bounds(messages.end - messages.start)):
        part = messages.pick(chunk)
        records = recorded(
            part.channel,
            part.sequence,
            part.log_time,
            part.publish_time,
            batch.buffer,
            part.start,
            part.end,
        )
        yield finish_chunk(records, compression or "zstd")


def unread_chunks(log: Log, span: Span) -> Iterator[FinishedChunk]:
    """Yield the chunks of an MCAP and their indexes as they stand; all are known to be sound."""
    ranges = [(chunk.offset, chunk.index_end - chunk.offset) for chunk in span]
    for chunk, stored in zip(span, log.source.read_many(ranges), strict=True):
        yield _as_it_stands(chunk, stored)


def _as_it_stands(chunk: Chunk, stored: bytes | memoryview) -> FinishedChunk:
    """Return a recorded chunk with its own index.

    Args:
        chunk: in the log.
        stored: its bytes, those of the index included.
    """
    record, index = np.split(np.frombuffer(stored, np.uint8), [chunk.end - chunk.offset])
    times = chunk.start_time or 0, chunk.end_time or 0
    sizes = chunk.data_size, chunk.size
    return as_indexed(record, index, times, chunk.compression, *sizes)


def _unchanged(messages: Messages, loaded: LoadedChunk) -> FinishedChunk:
    """Return a recorded chunk verbatim, with a new message index if its own is not sound."""
    chunk = loaded.chunk
    if loaded.indexed:
        return _as_it_stands(chunk, loaded.stored)
    rows = messages.pick(loaded.rows)
    return indexed_chunk(
        np.frombuffer(loaded.stored[: chunk.end - chunk.offset], np.uint8),
        rows.channel,
        rows.log_time,
        rows.start - MESSAGE_HEAD.itemsize - loaded.base,
        chunk.compression,
        chunk.data_size,
        chunk.size,
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


def copy_findings(log: Log, options: ConvertOptions, left_out: frozenset[int]) -> Iterator[Finding]:
    """Say what is left out, and which patterns fit no topic."""
    topics = {channel.topic for channel in log.channels.values()}
    for glob in options.topics:
        if not any(fnmatchcase(topic, glob.removeprefix("!")) for topic in topics):
            yield Finding("COPY", f"--topics {glob} fits no topic of the log")
    if left_out:
        names = sorted({log.channels[number].topic for number in left_out})
        messages = sum(log.counts.get(number, 0) for number in left_out)
        text = f"{messages:,} messages of topics left out of the copy: {listed(names)}"
        yield Finding("COPY", text)


def _fits(topic: str, globs: Sequence[str]) -> bool:
    return any(fnmatchcase(topic, glob) for glob in globs)
