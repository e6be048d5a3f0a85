"""An index of a log's messages: their times, and a hash of what each holds.

Chunks need not be in the order of time, and may overlap, so that both logs are read whole before
messages are paired. Payloads are not kept: where they differ, their chunks are read again.
"""

from bisect import bisect_right
from collections.abc import Collection
from dataclasses import dataclass
from functools import lru_cache
from typing import Final, NamedTuple

import numpy as np

from dogbot_logtool.comparison.descriptions import kind_of
from dogbot_logtool.core.arrays import Ints, concatenated, picked, rows_by_group
from dogbot_logtool.reader.containers.log import Batch, Channel, Chunk, Log
from dogbot_logtool.reader.containers.loss import Loss

_CHUNKS_KEPT: Final = 16
"""Chunks of a log that are kept in memory: messages of about one time may lie in several."""


@dataclass(frozen=True, slots=True, eq=False)
class Rows:
    """Messages of a topic."""

    log_time: Ints
    """(n,) ns."""
    digest: Ints
    """(n,) hash of the kind of channel (see `kind_of`), the publish time and the payload."""
    position: Ints
    """(n,) index of each message in the file."""


class Message(NamedTuple):
    """A message that was read again."""

    channel: Channel
    publish_time: int
    payload: bytes


class MessageIndex:
    """The messages of some topics of a log."""

    def __init__(self, log: Log, topics: Collection[str]) -> None:
        """Read the log.

        Args:
            log: the log.
            topics: those that are wanted.
        """
        self._log = log
        self.losses: list[Loss] = [*log.losses]
        self._chunks: list[Chunk] = []
        self._first: list[int] = []
        """Position of each chunk's first message."""
        self._count = 0
        self._loaded = lru_cache(_CHUNKS_KEPT)(lambda number: log.read((self._chunks[number],)))
        self._parts = {name: [Rows(*[np.empty(0, np.int64)] * 3)] for name in topics}
        self._kinds = {n: kind_of(each) for n, each in log.channels.items() if each.topic in topics}
        for span in log.spans():
            self._add(log.read(span))

    def _add(self, batch: Batch) -> None:
        """Take the messages of the next chunks."""
        self.losses += batch.losses
        for each in batch.chunks:
            self._chunks.append(each.chunk)
            self._first.append(self._count + each.rows.start)
        data, all_of_them = batch.buffer.tobytes(), batch.messages
        for number, rows in rows_by_group(all_of_them.channel):
            if kind := self._kinds.get(number):
                found = all_of_them.pick(rows)
                columns = found.publish_time, found.start, found.end
                messages = zip(*(column.tolist() for column in columns), strict=True)
                digest = [hash((kind, time, data[start:end])) for time, start, end in messages]
                part = Rows(found.log_time, np.array(digest, np.int64), self._count + rows)
                self._parts[self._log.channels[number].topic].append(part)
        self._count += len(all_of_them)

    def take(self, topic: str) -> Rows:
        """Return the messages of a topic by log time, those of one time as they stand in the file.

        They are not kept.
        """
        found = concatenated(self._parts.pop(topic))
        return picked(found, np.lexsort((found.position, found.log_time)))

    def message(self, position: int) -> Message:
        """Read a message again."""
        number = bisect_right(self._first, position) - 1
        batch, row = self._loaded(number), position - self._first[number]
        messages = batch.messages
        payload = batch.buffer[messages.start[row] : messages.end[row]].tobytes()
        channel = self._log.channels[int(messages.channel[row])]
        return Message(channel, int(messages.publish_time[row]), payload)


def pair_messages(one: Rows, other: Rows) -> tuple[Ints, Ints, Ints, Ints]:
    """Pair messages of one topic by log time, and those of the same log time by their order.

    Returns:
        (n,) rows of the pairs in one table and (n,) in the other; (m,) rows that only the one has;
        (k,) rows that only the other has.
    """
    sides = one.log_time, other.log_time
    _, time = np.unique(np.concatenate(sides), return_inverse=True)
    nth = np.concatenate([_index_at_its_time(each) for each in sides])
    first, second = np.split(time * (nth.max(initial=0) + 1) + nth, [len(one.log_time)])
    _, rows, others = np.intersect1d(first, second, assume_unique=True, return_indices=True)
    missing = np.delete(np.arange(len(first)), rows)
    extra = np.delete(np.arange(len(second)), others)
    return rows, others, missing, extra


def _index_at_its_time(time: Ints) -> Ints:
    """Return the index of each message among those of its time, (n,)."""
    return np.arange(len(time)) - np.searchsorted(time, time)
