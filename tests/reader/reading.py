"""Reads a log to its end through the public surface of the reader, for tests."""

from collections import Counter
from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from dogbot_logtool.reader.containers.log import Extra, LoadedChunk, wrong_statistics
from dogbot_logtool.reader.containers.loss import Loss, lost_messages
from dogbot_logtool.reader.opening import open_log


class Read(NamedTuple):
    """One message as it came out."""

    topic: str
    log_time: int
    payload: bytes


def small_chunks(chunks: int, each: int) -> list[list[tuple[int, int, bytes]]]:
    """Return number of the topic, time and payload of the messages of a small log."""
    return [
        [
            (
                (chunk + row) % 2,
                1_600_000_000_000_000_000 + (chunk * each + row) * 10_000_000,
                (9).to_bytes(4, "little") + f"payload{chunk}{row}".encode(),
            )
            for row in range(each)
        ]
        for chunk in range(chunks)
    ]


@dataclass(frozen=True)
class Reading:
    messages: tuple[Read, ...]
    """In the order of the file."""
    losses: tuple[Loss, ...]
    counts: Counter[str]
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
        return lost_messages(self.losses)

    @property
    def sentences(self) -> str:
        return "; ".join(loss.what for loss in self.losses)


def read_file(path: Path) -> Reading:
    with closing(open_log(path)) as log:
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
        counts: Counter[str] = Counter()
        for number, count in log.counts.items():
            counts[log.channels[number].topic] += count
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


def read_bytes(folder: Path, data: bytes) -> Reading:
    path = folder / "log"
    path.write_bytes(data)
    return read_file(path)
