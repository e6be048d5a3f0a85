"""Logs are cut into windows of time, to the nanosecond: each message once, in little memory."""

import random
import struct
import tracemalloc
from collections.abc import Iterable
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from mcap.writer import CompressionType

from dogbot_logtool.comparison.logs.windows import (
    Track,
    indexed_track,
    load,
    measured_track,
    plan_windows,
)
from dogbot_logtool.reader.containers.log import Log
from dogbot_logtool.reader.opening import open_log
from tests.comparison.pairs import Pair, counts, tally
from tests.comparison.recordings import (
    RAW,
    START,
    Message,
    Packing,
    Recording,
    one_topic,
    recording,
)

LEAST, MOST = -(2**63), 2**63 - 1


def track(start: list[int], length_ns: int, size: int) -> Track:
    log: Any = SimpleNamespace()
    chunks: Any = [SimpleNamespace(size=size)] * len(start)
    first = np.array(start, np.int64)
    return Track(log, chunks, first, first + length_ns, {})


@pytest.mark.parametrize("origin", [0, 1_700_000_000 * 10**9, LEAST, MOST - 100])
def test_large_chunks_a_nanosecond_apart_are_parted(origin: int) -> None:
    windows = list(plan_windows([track([origin + ns for ns in range(12)], 0, 31 << 20)]))
    assert len(windows) == 6
    assert (windows[0].first, windows[-1].last) == (LEAST, MOST)
    assert all(after.first == before.last + 1 for before, after in pairwise(windows))
    assert [window.last - origin for window in windows[:-1]] == [1, 3, 5, 7, 9]


def test_times_may_be_as_far_apart_as_they_can() -> None:
    windows = list(plan_windows([track([LEAST, MOST - 1], 1, 20 << 20)], 1 << 20))
    assert (windows[0].first, windows[-1].last) == (LEAST, MOST)


def windows_of(log: Log, window_size: int, *, measured: bool) -> list[list[tuple[int, bytes]]]:
    """Times and payloads of the messages, window by window."""
    topic_of = {channel.id: 0 for channel in log.channels.values() if channel.topic != "/b"}
    track = (measured_track if measured else indexed_track)(log, topic_of)
    windows: list[list[tuple[int, bytes]]] = []
    for window in plan_windows([track], window_size):
        block = load(track, window)
        messages = block.messages
        windows.append(
            [
                (time, block.buffer[start:end].tobytes())
                for time, start, end in zip(
                    messages.log_time.tolist(),
                    messages.start.tolist(),
                    messages.end.tolist(),
                    strict=True,
                )
            ]
        )
    return windows


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


def shuffled(messages: Iterable[Message]) -> list[Message]:
    mixed_up = list(messages)
    random.Random(5).shuffle(mixed_up)  # noqa: S311 - no cryptography
    return mixed_up


@pytest.mark.parametrize("measured", [False, True])
@pytest.mark.parametrize("order", [list, shuffled, reversed])
def test_windows_hold_each_message_once_and_are_small(
    tmp_path: Path, order: Any, *, measured: bool
) -> None:
    numbered = [("/b" if i % 3 == 0 else "/a", i, struct.pack("<Q", i) * 20) for i in range(1000)]
    whole = recording({"/a": RAW, "/b": RAW}, *numbered)
    whole = replace(whole, messages=list(order(whole.messages)))
    packing = Packing(CompressionType.ZSTD, 1000)
    log = open_log(whole.write(tmp_path / "log.mcap", packing))
    windows = windows_of(log, 20_000, measured=measured)
    log.close()
    expected = [(m.time, m.data) for m in whole.messages if m.topic == "/a"]
    assert sorted(one for window in windows for one in window) == sorted(expected)
    assert len(windows) >= 8
    for earlier, later in pairwise(windows):
        assert max(earlier)[0] < min(later)[0]
    # What the chunks' times tell is less where they overlap, but still bounds a window.
    assert max(sum(len(data) for _, data in window) for window in windows) < 2 * 20_000


def test_memory_does_not_grow_with_the_file(pair: Pair) -> None:
    payloads = [struct.pack("<Q", i) * 12_500 for i in range(400)]
    one_topic(RAW, *payloads).write(pair.expected)
    payloads[399] += b"x"
    one_topic(RAW, *payloads).write(pair.actual, Packing(CompressionType.LZ4, 300_000))
    tracemalloc.start()
    result = pair.compare()
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert [d.index for d in result.differences] == [399]
    assert sum(len(data) for data in payloads) == 40_000_001
    assert peak < 35_000_000
