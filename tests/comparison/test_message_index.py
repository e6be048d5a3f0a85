"""Messages are found again wherever they stand, and their payloads take little memory."""

import random
import struct
import tracemalloc
from collections.abc import Callable, Sequence
from dataclasses import replace

import pytest
from mcap.writer import CompressionType

from tests.comparison.pairs import Pair, counts, tally
from tests.comparison.recordings import RAW, START, Message, Packing, Recording, one_topic

Order = Callable[[Sequence[Message]], Sequence[Message]]


def shuffled(messages: Sequence[Message]) -> Sequence[Message]:
    return random.Random(5).sample(messages, len(messages))  # noqa: S311 - no cryptography


def backwards(messages: Sequence[Message]) -> Sequence[Message]:
    return messages[::-1]


def test_times_may_lie_as_far_apart_as_they_can(pair: Pair) -> None:
    times = [*range(100), 2**61, 2**62 + 1, 2**62 + 2, 2**63 - 2, 2**63 - 1]
    whole = Recording({"/a": RAW}, [Message("/a", time, bytes(300_000)) for time in times])
    other = replace(whole, messages=[*whole.messages[:-1], Message("/a", times[-1], b"x")])
    whole.write(pair.expected, Packing(CompressionType.NONE, 1))
    other.write(pair.actual)
    result = pair.compare()
    assert [d.index for d in result.differences] == [104]
    assert counts(tally(result, "/a")) == (105, 105, 104, 0, 1, 0, 0)


def test_messages_of_one_time_stay_together(pair: Pair) -> None:
    payloads = [struct.pack("<Q", i) * 10_000 for i in range(300)]
    messages = [Message("/a", START, data) for data in payloads]
    whole = Recording({"/a": RAW}, messages)
    whole.write(pair.expected, Packing(chunk_size=1))
    replace(whole, messages=[*messages[1:], messages[0]]).write(pair.actual)
    assert counts(tally(pair.compare(), "/a")) == (300, 300, 0, 0, 300, 0, 0)


@pytest.mark.parametrize(
    ("order", "indexed"), [(shuffled, True), (list, False), (backwards, False)]
)
def test_memory_does_not_grow_with_the_file(pair: Pair, order: Order, *, indexed: bool) -> None:
    payloads = [struct.pack("<Q", i) * 12_500 for i in range(400)]
    whole = one_topic(RAW, *payloads)
    replace(whole, messages=order(whole.messages)).write(
        pair.expected, Packing(chunk_size=300_000, summary=indexed)
    )
    changed = replace(whole.messages[399], data=payloads[399] + b"x")
    replace(whole, messages=order([*whole.messages[:399], changed])).write(
        pair.actual, Packing(CompressionType.LZ4, 300_000)
    )
    tracemalloc.start()
    result = pair.compare()
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert [d.index for d in result.differences] == [399]
    assert sum(len(data) for data in payloads) == 40_000_000
    assert peak < 35_000_000
