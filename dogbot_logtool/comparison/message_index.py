"""An index of a log's messages: their times, and a hash of what each holds.

Chunks need not be in the order of time, and may overlap, so that both logs are read whole before
messages are paired. Payloads are not kept: where they differ, their chunks are read again.
"""

from bisect import bisect_right
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Final

import numpy as np

from dogbot_logtool.comparison.descriptions import kind_of
from dogbot_logtool.core.arrays import Ints, concatenated, picked, rows_by_group
from dogbot_logtool.reader.containers.log import Batch, Channel, Chunk, Log, Loss, Messages

_CHUNKS_KEPT: Final = 16
"""Chunks of a log that are kept in memory: messages of about one time may lie in several."""


@dataclass(frozen=True, slots=True, eq=False)
class Rows:
    """Messages of a topic."""

    kind: Ints
    """(n,) number of the kind of channel (see `kind_of`)."""
    log_time: Ints
    """(n,) ns. Likewise `publish_time`."""
    publish_time: Ints
    digest: Ints
    """(n,) hash of the payload."""
    position: Ints
    """(n,) index of each message in the file."""


@dataclass(frozen=True, slots=True)
class Message:
    """A message that was read again."""

    channel: Channel
    publish_time: int
    payload: bytes


class MessageIndex:
    """The messages of some topics of a log."""

    def __init__(self, log: Log, topics: Mapping[str, int], kinds: dict[str, int]) -> None:
        """Read the log.

        Args:
            log: the log.
            topics: numbers of the topics that are wanted.
            kinds: numbers of kinds of channels, to which new ones are added.
        """
        self._log = log
        self.losses: list[Loss] = [*log.losses]
        self._chunks: list[Chunk] = []
        self._first: list[int] = []
        """Position of each chunk's first message."""
        self._count = 0
        self._loaded = lru_cache(_CHUNKS_KEPT)(self._load)
        self._parts = {number: [Rows(*[np.empty(0, np.int64)] * 5)] for number in topics.values()}
        wanted = [(n, each) for n, each in sorted(log.channels.items()) if each.topic in topics]
        self._channels = np.array([number for number, _ in wanted], np.int64)
        self._topics = np.array([topics[each.topic] for _, each in wanted], np.int64)
        numbers = [kinds.setdefault(kind_of(each), len(kinds)) for _, each in wanted]
        self._kinds = np.array(numbers, np.int64)
        for span in log.spans():
            self._add(log.read(span))

    def _add(self, batch: Batch) -> None:
        """Take the messages of the next chunks."""
        self.losses += batch.losses
        for each in batch.chunks:
            self._chunks.append(each.chunk)
            self._first.append(self._count + each.rows.start)
        position = np.flatnonzero(np.isin(batch.messages.channel, self._channels))
        messages = batch.messages.pick(position)
        of = np.searchsorted(self._channels, messages.channel)
        times = messages.log_time, messages.publish_time
        found = Rows(self._kinds[of], *times, _digests(batch, messages), self._count + position)
        for number, rows in rows_by_group(self._topics[of]):
            self._parts[number].append(picked(found, rows))
        self._count += len(batch.messages)

    def take(self, topic: int) -> Rows:
        """Return the messages of a topic by log time, those of one time as they stand in the file.

        They are not kept.
        """
        found = concatenated(self._parts.pop(topic))
        return picked(found, np.argsort(found.log_time, kind="stable"))

    def message(self, position: int) -> Message:
        """Read a message again."""
        number = bisect_right(self._first, position) - 1
        batch, row = self._loaded(number), position - self._first[number]
        messages = batch.messages
        payload = batch.buffer[messages.start[row] : messages.end[row]].tobytes()
        channel = self._log.channels[int(messages.channel[row])]
        return Message(channel, int(messages.publish_time[row]), payload)

    def _load(self, number: int) -> Batch:
        return self._log.read((self._chunks[number],))


def _digests(batch: Batch, messages: Messages) -> Ints:
    """Return a hash of each payload, (n,)."""
    data = batch.buffer.tobytes()
    bounds = zip(messages.start.tolist(), messages.end.tolist(), strict=True)
    return np.array([hash(data[start:end]) for start, end in bounds], np.int64)


def pair_messages(one: Rows, other: Rows) -> tuple[Ints, Ints, Ints, Ints]:
    """Pair messages of one topic by log time, and those of the same log time by their order.

    Returns:
        (n,) rows of the pairs in one table and (n,) in the other; (m,) rows that only the one has;
        (k,) rows that only the other has.
    """
    count = len(one.log_time)
    time = np.concatenate([one.log_time, other.log_time])
    nth = np.concatenate([_index_at_its_time(each.log_time) for each in (one, other)])
    order = np.lexsort((nth, time))
    # The two of a pair stand side by side now, that of the first table before the other's.
    first = np.flatnonzero((np.diff(time[order]) == 0) & (np.diff(nth[order]) == 0))
    alone = np.ones(len(order), np.bool_)
    alone[first] = alone[first + 1] = False
    left = order[alone]
    return order[first], order[first + 1] - count, left[left < count], left[left >= count] - count


def _index_at_its_time(time: Ints) -> Ints:
    """Return the index of each message among those of its time, (n,)."""
    return np.arange(len(time)) - np.searchsorted(time, time)
