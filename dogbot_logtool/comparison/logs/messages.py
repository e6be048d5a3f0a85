"""The messages of two logs compared: whole windows by their bytes, what then is left one by one.

Messages belong together when topic and log time are the same, and, where several of a topic have
the same log time, when they have the same index among those in the order of the file.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from dogbot_logtool.comparison.fields import Findings, compare_fields
from dogbot_logtool.comparison.logs.decoders import Decoder, Undecodable, decoder_of
from dogbot_logtool.comparison.logs.topics import Topic, kind_of
from dogbot_logtool.comparison.logs.windows import Block
from dogbot_logtool.comparison.outcome import Difference, Differences, Kind
from dogbot_logtool.core.arrays import Flags, Ints
from dogbot_logtool.reader.containers.log import Channel
from dogbot_logtool.reader.decode.columns import gather

_PAIR: Final = 0
_MISSING: Final = 1
_EXTRA: Final = 2


@dataclass(frozen=True, slots=True)
class Pairing:
    """Rows of two blocks, by topic and in the order of time."""

    expected: Ints
    """(n,) rows of the pairs."""
    actual: Ints
    """(n,)."""
    missing: Ints
    """(m,) rows that only the expected block has."""
    extra: Ints
    """(k,) rows that only the actual block has."""


def time_order(block: Block) -> Ints:
    """Return the rows by topic, in it by log time, in that in file order."""
    return np.lexsort((block.messages.log_time, block.topic))


def pair_messages(
    expected: Block, expected_order: Ints, actual: Block, actual_order: Ints
) -> Pairing:
    """Pair the messages of two blocks.

    Args:
        expected: the one.
        expected_order: its `time_order`.
        actual: the other.
        actual_order: its `time_order`.
    """
    one = expected.topic[expected_order], expected.messages.log_time[expected_order]
    other = actual.topic[actual_order], actual.messages.log_time[actual_order]
    if np.array_equal(one[0], other[0]) and np.array_equal(one[1], other[1]):
        nothing = np.empty(0, np.int64)
        return Pairing(expected_order, actual_order, nothing, nothing)
    row = np.concatenate([expected_order, actual_order])
    topic = np.concatenate([one[0], other[0]])
    time = np.concatenate([one[1], other[1]])
    nth = np.concatenate([_index_among_equals(*one), _index_among_equals(*other)])
    is_actual = np.arange(len(row)) >= len(expected_order)
    order = np.lexsort((is_actual, nth, time, topic))
    row, topic, time, nth = row[order], topic[order], time[order], nth[order]
    is_actual = is_actual[order]
    # The two of a pair stand side by side now.
    first = np.flatnonzero(
        (topic[1:] == topic[:-1]) & (time[1:] == time[:-1]) & (nth[1:] == nth[:-1])
    )
    alone = np.ones(len(row), np.bool_)
    alone[first] = alone[first + 1] = False
    return Pairing(row[first], row[first + 1], row[alone & ~is_actual], row[alone & is_actual])


def _index_among_equals(topic: Ints, time: Ints) -> Ints:
    """Return the index of each row among those of the same topic and time, which stand together."""
    row = np.arange(len(topic))
    begins = np.ones(len(topic), np.bool_)
    begins[1:] = (topic[1:] != topic[:-1]) | (time[1:] != time[:-1])
    return row - np.maximum.accumulate(np.where(begins, row, 0))


def same_bytes(expected: Block, actual: Block, pairing: Pairing) -> Flags:
    """Tell of each pair whether the payloads are the same, byte for byte."""
    one, other = expected.messages, actual.messages
    size = one.end[pairing.expected] - one.start[pairing.expected]
    same: Flags = size == other.end[pairing.actual] - other.start[pairing.actual]
    candidates = np.flatnonzero(same & (size > 0))
    by_size = candidates[np.argsort(size[candidates], kind="stable")]
    sizes, begins = np.unique(size[by_size], return_index=True)
    for length, pairs in zip(sizes.tolist(), np.split(by_size, begins[1:]), strict=False):
        left = gather(expected.buffer, one.start[pairing.expected[pairs]], length)
        right = gather(actual.buffer, other.start[pairing.actual[pairs]], length)
        same[pairs] = left == right
    return same


class _Side:
    """The channels of one of the logs, and how many of their messages were read."""

    def __init__(self, topics: Sequence[Topic], channels: Sequence[Channel]) -> None:
        self._channels = {channel.id: channel for channel in channels}
        self._decoders: dict[int, Decoder] = {}
        self._seen = np.zeros(len(topics), np.int64)

    def kinds(self, block: Block, rows: Ints, numbers: dict[str, int]) -> Ints:
        """Return (n,) numbers of the kinds of messages, counted on in `numbers`."""
        channels, which = np.unique(block.messages.channel[rows], return_inverse=True)
        kinds = [
            numbers.setdefault(kind_of(self._channels[channel]), len(numbers))
            for channel in channels.tolist()
        ]
        return np.array(kinds, np.int64)[which]

    def positions(self, block: Block, order: Ints) -> Ints:
        """Return (n,) the index of each row among its topic's messages, from the log's first."""
        topic = block.topic[order]
        counts = np.bincount(topic, minlength=len(self._seen))
        first = np.cumsum(counts) - counts
        position = np.empty(len(order), np.int64)
        position[order] = np.arange(len(order)) - first[topic] + self._seen[topic]
        self._seen += counts
        return position

    def channel(self, block: Block, row: int) -> Channel:
        return self._channels[int(block.messages.channel[row])]

    def decoder(self, channel: Channel) -> Decoder:
        """Return a channel's decoder.

        Raises:
            Undecodable: there is none.
        """
        if channel.id not in self._decoders:
            self._decoders[channel.id] = decoder_of(channel)
        return self._decoders[channel.id]


def _payload(block: Block, row: int) -> bytes:
    start, end = int(block.messages.start[row]), int(block.messages.end[row])
    return block.buffer[start:end].tobytes()


class MessageSweep:
    """Goes through both logs window by window and fills the topics' tallies."""

    def __init__(self, topics: Sequence[Topic], origin: int, differences: Differences) -> None:
        """Begin.

        Args:
            topics: the topics; a block's topic numbers count them.
            origin: ns, the time from which times of messages are counted.
            differences: where to note what is found.
        """
        self._topics = topics
        self._origin = origin
        self._differences = differences
        self._expected = _Side(topics, [c for topic in topics for c in topic.expected])
        self._actual = _Side(topics, [c for topic in topics for c in topic.actual])
        self._one_sided = np.array([topic.one_sided for topic in topics], np.bool_)

    def compare(self, expected: Block, actual: Block) -> None:
        """Compare the messages of a window."""
        order = time_order(expected), time_order(actual)
        pairing = pair_messages(expected, order[0], actual, order[1])
        positions = (
            self._expected.positions(expected, order[0]),
            self._actual.positions(actual, order[1]),
        )
        equal = self._equal(expected, actual, pairing)
        self._count(expected, actual, pairing, equal)
        for what, number in self._in_time_order(expected, actual, pairing, equal):
            if what == _PAIR:
                row = int(pairing.expected[number])
                position = int(positions[0][row])
                self._compare_pair(expected, row, actual, int(pairing.actual[number]), position)
            elif what == _MISSING:
                row = int(pairing.missing[number])
                self._unpaired(Kind.MISSING, expected, row, int(positions[0][row]))
            else:
                row = int(pairing.extra[number])
                self._unpaired(Kind.EXTRA, actual, row, int(positions[1][row]))

    def _equal(self, expected: Block, actual: Block, pairing: Pairing) -> Flags:
        """Tell of each pair whether it needs no closer look."""
        numbers: dict[str, int] = {}
        kinds = (
            self._expected.kinds(expected, pairing.expected, numbers),
            self._actual.kinds(actual, pairing.actual, numbers),
        )
        published = (
            expected.messages.publish_time[pairing.expected],
            actual.messages.publish_time[pairing.actual],
        )
        equal = same_bytes(expected, actual, pairing)
        equal &= (kinds[0] == kinds[1]) & (published[0] == published[1])
        return equal

    def _count(self, expected: Block, actual: Block, pairing: Pairing, equal: Flags) -> None:
        def counts(topic: Ints) -> list[int]:
            numbers: list[int] = np.bincount(topic, minlength=len(self._topics)).tolist()
            return numbers

        for topic, in_expected, in_actual, same, missing, extra in zip(
            self._topics,
            counts(expected.topic),
            counts(actual.topic),
            counts(expected.topic[pairing.expected[equal]]),
            counts(expected.topic[pairing.missing]),
            counts(actual.topic[pairing.extra]),
            strict=True,
        ):
            topic.tally.expected += in_expected
            topic.tally.actual += in_actual
            topic.tally.equal += same
            topic.tally.missing += missing
            topic.tally.extra += extra

    def _in_time_order(
        self, expected: Block, actual: Block, pairing: Pairing, equal: Flags
    ) -> Iterator[tuple[int, int]]:
        """Yield what to report: pair, missing or extra, and its index in the pairing.

        Topics that only one log has were named once and for all.
        """
        pairs = np.flatnonzero(~equal)
        missing = np.flatnonzero(~self._one_sided[expected.topic[pairing.missing]])
        extra = np.flatnonzero(~self._one_sided[actual.topic[pairing.extra]])
        sources = (
            (expected, pairing.expected[pairs]),
            (expected, pairing.missing[missing]),
            (actual, pairing.extra[extra]),
        )
        time = np.concatenate([block.messages.log_time[rows] for block, rows in sources])
        topic = np.concatenate([block.topic[rows] for block, rows in sources])
        number = np.concatenate([pairs, missing, extra])
        what = np.repeat([_PAIR, _MISSING, _EXTRA], [len(pairs), len(missing), len(extra)])
        order = np.lexsort((number, what, topic, time))
        yield from zip(what[order].tolist(), number[order].tolist(), strict=True)

    def _unpaired(self, kind: Kind, block: Block, row: int, position: int) -> None:
        topic = self._topics[int(block.topic[row])]
        time_s = self._time_s(block, row)
        self._differences.add(Difference(kind, topic.name, index=position, time_s=time_s))

    def _compare_pair(
        self, expected: Block, row: int, actual: Block, actual_row: int, position: int
    ) -> None:
        topic = self._topics[int(expected.topic[row])]
        tally = topic.tally
        findings = Findings(self._differences.room)
        one = self._expected.channel(expected, row)
        other = self._actual.channel(actual, actual_row)
        if kind_of(one) == kind_of(other):
            payloads = _payload(expected, row), _payload(actual, actual_row)
            findings = self._compare_payloads(topic, (one, other), payloads)
            published = (
                int(expected.messages.publish_time[row]),
                int(actual.messages.publish_time[actual_row]),
            )
            compare_fields(*published, topic.rules, findings, "publish_time")
        elif not tally.faults:
            findings.differ("type", kind_of(one), kind_of(other))
        else:
            # Named once, with the topic.
            tally.different += 1
            return
        if findings.count:
            tally.different += 1
        elif findings.loose:
            tally.within_tolerance += 1
        else:
            tally.equal += 1
        tally.deviate(f"[{position}] {findings.deviation_path}", findings.deviation)
        time_s = self._time_s(expected, row)
        self._differences.take(findings, topic.name, Kind.FIELD, position, time_s)

    def _compare_payloads(
        self, topic: Topic, channels: tuple[Channel, Channel], payloads: tuple[bytes, bytes]
    ) -> Findings:
        findings = Findings(self._differences.room)
        if payloads[0] == payloads[1]:
            return findings
        try:
            one = self._expected.decoder(channels[0])(payloads[0])
            other = self._actual.decoder(channels[1])(payloads[1])
            compare_fields(one, other, topic.rules, findings)
        except Undecodable as undecodable:
            reason = str(undecodable)
        except RecursionError:
            reason = "a message is nested too deeply"
        else:
            return findings
        topic.tally.note = f"compared as bytes: {reason}"
        findings = Findings(self._differences.room)
        compare_fields(*payloads, topic.rules, findings, "payload")
        return findings

    def _time_s(self, block: Block, row: int) -> float:
        return (int(block.messages.log_time[row]) - self._origin) / 1e9
