"""Reads a log to its end through the public surface of the reader, for tests."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from dogbot_logtool.reader.containers.log import Extra, LoadedChunk, wrong_statistics
from dogbot_logtool.reader.containers.loss import Loss
from dogbot_logtool.reader.opening import open_log


class Read(NamedTuple):
    """One message as it came out."""

    topic: str
    log_time: int
    payload: bytes


@dataclass(frozen=True)
class Reading:
    messages: tuple[Read, ...]
    """In the order of the file."""
    losses: tuple[Loss, ...]
    counts: dict[str, int]
    """What opening the log counted, by topic."""
    topics: tuple[tuple[str, str, bytes], ...]
    """Topic, type and definition of each channel."""
    chunks: tuple[LoadedChunk, ...]
    rows: tuple[slice, ...]
    """The messages of each chunk."""
    extras: Sequence[Extra]
    profile: str
    times: tuple[int | None, int | None]

    @property
    def lost(self) -> int | None:
        """Messages known to be lost; None if a number is not known."""
        numbers = [loss.messages for loss in self.losses]
        return None if None in numbers else sum(number or 0 for number in numbers)

    @property
    def sentences(self) -> str:
        return "; ".join(loss.what for loss in self.losses)


def read_file(path: Path) -> Reading:
    log = open_log(path)
    try:
        messages: list[Read] = []
        losses = list(log.losses)
        chunks: list[LoadedChunk] = []
        chunk_rows: list[slice] = []
        batches = [log.read(span) for span in log.spans()]
        for batch in batches:
            losses.extend(batch.losses)
            chunks.extend(batch.chunks)
            chunk_rows.extend(
                slice(len(messages) + chunk.rows.start, len(messages) + chunk.rows.stop)
                for chunk in batch.chunks
            )
            rows = batch.messages
            messages.extend(
                Read(
                    log.channels[int(rows.channel[row])].topic,
                    int(rows.log_time[row]),
                    batch.buffer[int(rows.start[row]) : int(rows.end[row])].tobytes(),
                )
                for row in range(len(rows))
            )
        found = Counter(number for batch in batches for number in batch.messages.channel.tolist())
        losses += wrong_statistics(log, found, losses)
        counts: dict[str, int] = {}
        for number, count in log.counts.items():
            topic = log.channels[number].topic
            counts[topic] = counts.get(topic, 0) + count
        return Reading(
            tuple(messages),
            tuple(losses),
            counts,
            tuple(
                (c.topic, c.type_name, c.schema.data if c.schema else b"")
                for c in log.channels.values()
            ),
            tuple(chunks),
            tuple(chunk_rows),
            log.extras,
            log.profile,
            (log.start_time, log.end_time),
        )
    finally:
        log.close()


def read_bytes(folder: Path, data: bytes) -> Reading:
    path = folder / "log"
    path.write_bytes(data)
    return read_file(path)
