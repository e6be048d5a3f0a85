"""Recorded messages on their way into the output, byte for byte."""

from collections.abc import Iterator

import numpy as np

from dogbot_logtool.reader.containers.log import Batch, LoadedChunk, Messages
from dogbot_logtool.writer.chunks import (
    Compression,
    FinishedChunk,
    chunk_rows,
    finish_chunk,
    indexed_chunk,
)
from dogbot_logtool.writer.outgoing import MESSAGE_HEAD, record_bounds, recorded


def copied_chunks(
    batch: Batch, compression: Compression | None, *, as_they_stand: bool
) -> Iterator[FinishedChunk]:
    """Yield the messages of a batch: whole chunks as they stand, others laid out anew.

    Args:
        batch: what was read.
        compression: of the output; None: zstd, and that of chunks which stay as they stand.
        as_they_stand: whether the log's chunks are of the output's kind.
    """
    torn: list[slice] = []
    for loaded in batch.chunks:
        stored = loaded.chunk.compression or "none"
        if as_they_stand and loaded.whole and compression in {None, stored}:
            yield from _laid_out_anew(batch, torn, compression)
            torn = []
            yield _verbatim(batch.messages, loaded)
        else:
            torn.append(loaded.rows)
    yield from _laid_out_anew(batch, torn, compression)


def _laid_out_anew(
    batch: Batch, rows: list[slice], compression: Compression | None
) -> Iterator[FinishedChunk]:
    if not rows:
        return
    messages = batch.messages.pick(slice(rows[0].start, rows[-1].stop))
    # Chunk by chunk: so much stays in the processor's cache until it is compressed.
    for of_chunk in chunk_rows(record_bounds(messages.end - messages.start)):
        part = messages.pick(of_chunk)
        outgoing = recorded(
            part.channel,
            part.sequence,
            part.log_time,
            part.publish_time,
            batch.buffer,
            part.start,
            part.end,
        )
        yield finish_chunk(outgoing, compression or "zstd")


def _verbatim(messages: Messages, loaded: LoadedChunk) -> FinishedChunk:
    """Return a recorded chunk as it stands, with a message index of what was found in it."""
    chunk = loaded.chunk
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
