"""Which message of the one log belongs to which of the other, and which pairs are equal bytes.

Messages belong together when topic and log time are the same, and, where several of a topic have
the same log time, when they have the same index among those in the order of the file.
"""

import numpy as np

from dogbot_logtool.comparison.logs.windows import Block
from dogbot_logtool.core.geometry.arrays import Flags, Ints
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.reader.decode.columns import gather


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
