"""Messages laid out in columns are what the mcap library writes one by one."""

from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from mcap import records
from mcap.data_stream import RecordBuilder
from numpy.typing import NDArray

from dogbot_logtool.writer.message_records import (
    MessageRecords,
    by_channel,
    in_time_order,
    recorded,
)
from tests.writer.stamping import stamped


@dataclass(frozen=True, slots=True)
class Sent:
    channel: int
    sequence: int
    log_time: int
    publish_time: int
    data: bytes


# Payloads are copied in pieces: short ones, and lengths about multiples of the widths.
PAYLOADS = st.one_of(
    st.binary(max_size=40),
    st.integers(0, 3).map(lambda size: b"abc"[:size]),
    st.integers(200, 1100).map(lambda size: bytes(place % 251 for place in range(size))),
)
SENT = st.builds(
    Sent,
    channel=st.integers(0, 2**16 - 1),
    sequence=st.integers(0, 2**32 - 1),
    log_time=st.integers(0, 2**63 - 1),
    publish_time=st.integers(0, 2**63 - 1),
    data=PAYLOADS,
)


def ints(numbers: list[int]) -> np.ndarray[tuple[int], np.dtype[np.int64]]:
    return np.array(numbers, np.int64)


def one_by_one(messages: list[Sent]) -> tuple[bytes, list[int]]:
    """Return the library's bytes, and where each record begins and the last ends."""
    builder = RecordBuilder()
    bounds = [0]
    data = b""
    for message in messages:
        records.Message(
            channel_id=message.channel,
            sequence=message.sequence,
            log_time=message.log_time,
            publish_time=message.publish_time,
            data=message.data,
        ).write(builder)
        data += builder.end()
        bounds.append(len(data))
    return data, bounds


def assert_laid_out(outgoing: MessageRecords, messages: list[Sent]) -> None:
    data, bounds = one_by_one(messages)
    assert outgoing.data.tobytes() == data
    assert outgoing.bounds.tolist() == bounds
    assert outgoing.channel.tolist() == [message.channel for message in messages]
    assert outgoing.log_time.tolist() == [message.log_time for message in messages]


def recorded_of(messages: list[Sent], order: list[int]) -> MessageRecords:
    """Return messages as a reader gives them: payloads anywhere in a buffer."""
    places: dict[int, int] = {}
    buffer = b"head"
    for number in order:
        places[number] = len(buffer)
        buffer += messages[number].data + b"-" * (number % 3)
    start = ints([places[number] for number in range(len(messages))])
    size = ints([len(message.data) for message in messages])
    return recorded(
        ints([message.channel for message in messages]),
        ints([message.sequence for message in messages]),
        ints([message.log_time for message in messages]),
        ints([message.publish_time for message in messages]),
        np.frombuffer(buffer, np.uint8),
        start,
        start + size,
    )


@given(st.data(), st.lists(SENT, max_size=40))
def test_recorded_messages(data: st.DataObject, messages: list[Sent]) -> None:
    order = data.draw(st.permutations(range(len(messages))))
    outgoing = recorded_of(messages, order)
    assert_laid_out(outgoing, messages)


@given(
    st.lists(
        st.tuples(
            st.integers(0, 2**16 - 1),
            st.integers(1, 30),
            st.lists(st.integers(0, 9), max_size=12),
        ),
        min_size=1,
        max_size=5,
    )
)
def test_stamped_messages_of_many_channels_merge_by_time(
    parts: list[tuple[int, int, list[int]]],
) -> None:
    rng = np.random.default_rng(1)
    stamped_out: list[NDArray[np.void]] = []
    messages: list[Sent] = []
    for channel, size, times in parts:
        payload = rng.integers(0, 256, (len(times), size), np.uint8)
        stamped_out.append(stamped(channel, ints(times), payload.view(f"V{size}").reshape(-1)))
        messages.extend(
            Sent(channel, 0, time, time, row.tobytes())
            for time, row in zip(times, payload, strict=True)
        )
    merged = in_time_order(stamped_out)
    # Python's sort is stable, so at equal times the earlier part comes first here too.
    assert_laid_out(merged, sorted(messages, key=lambda message: message.log_time))


@given(
    st.lists(
        st.tuples(
            st.sampled_from([1, 1000, 32 << 10]),
            st.lists(st.integers(0, 70), min_size=1, max_size=3),
        ),
        max_size=5,
    )
)
@example([(32 << 10, [1, 1]), (32 << 10, [1]), (1, [3, 0])])
def test_channels_with_many_messages_go_by_themselves(
    channels: list[tuple[int, list[int]]],
) -> None:
    parts: list[NDArray[np.void]] = []
    many: list[list[Sent]] = []
    few: list[Sent] = []
    rng = np.random.default_rng(1)
    for channel, (size, counts) in enumerate(channels):
        sent: list[Sent] = []
        for count in counts:
            times = rng.integers(0, 99, count).tolist()
            payload = bytes([len(parts) + 1]) * size
            parts.append(stamped(channel, ints(times), np.full(len(times), payload, f"V{size}")))
            sent += [Sent(channel, 0, time, time, payload) for time in times]
        if sum(31 + len(message.data) for message in sent) >= 64 << 10:
            many.append(sent)
        else:
            few += sent
    groups = list(by_channel(iter(parts)))
    for group, messages in zip(groups, [*many, *([few] if few else [])], strict=True):
        # Stable, as above.
        assert_laid_out(group, sorted(messages, key=lambda message: message.log_time))


@given(st.lists(SENT, min_size=1, max_size=12), st.data())
def test_a_part_stands_for_itself(messages: list[Sent], data: st.DataObject) -> None:
    first = data.draw(st.integers(0, len(messages)))
    last = data.draw(st.integers(first, len(messages)))
    part = recorded_of(messages, list(range(len(messages)))).part(slice(first, last))
    assert_laid_out(part, messages[first:last])


@pytest.mark.parametrize("parts", [[], [stamped(1, ints([]), np.empty(0, "V7"))]])
def test_nothing(parts: list[NDArray[np.void]]) -> None:
    nothing = in_time_order(parts)
    assert nothing.data.tobytes() == b""
    assert nothing.bounds.tolist() == [0]
