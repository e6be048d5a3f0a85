"""Messages laid out in columns are what the mcap library writes one by one."""

from dataclasses import dataclass

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from mcap import records
from mcap.data_stream import RecordBuilder

from dogbot_logtool.writer.outgoing import Outgoing, in_time_order, lay_out, recorded, stamped


@dataclass(frozen=True, slots=True)
class Sent:
    channel: int
    sequence: int
    log_time: int
    publish_time: int
    data: bytes


SENT = st.builds(
    Sent,
    channel=st.integers(0, 2**16 - 1),
    sequence=st.integers(0, 2**32 - 1),
    log_time=st.integers(0, 2**63 - 1),
    publish_time=st.integers(0, 2**63 - 1),
    data=st.one_of(
        st.binary(max_size=40), st.integers(0, 3).map(lambda n: b"abc"[:n]), st.just(bytes(2000))
    ),
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


def columns_of(messages: list[Sent], order: list[int]) -> Outgoing:
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
    laid, bounds = lay_out(columns_of(messages, order))
    wanted, wanted_bounds = one_by_one(messages)
    assert laid.tobytes() == wanted
    assert bounds.tolist() == wanted_bounds


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
    outgoing: list[Outgoing] = []
    messages: list[Sent] = []
    for channel, size, times in parts:
        payload = rng.integers(0, 256, (len(times), size), np.uint8)
        outgoing.append(stamped(channel, ints(times), payload.view(f"V{size}").reshape(-1)))
        messages.extend(
            Sent(channel, 0, time, time, row.tobytes())
            for time, row in zip(times, payload, strict=True)
        )
    merged = in_time_order(outgoing)
    laid, _ = lay_out(merged)
    # Python's sort is stable, so at equal times the earlier part comes first here too.
    wanted, _ = one_by_one(sorted(messages, key=lambda message: message.log_time))
    assert laid.tobytes() == wanted


@given(st.lists(SENT, max_size=20), st.lists(SENT, max_size=20))
def test_recorded_messages_merge_by_time(first: list[Sent], second: list[Sent]) -> None:
    parts = [columns_of(part, list(range(len(part)))) for part in (first, second)]
    laid, _ = lay_out(in_time_order(parts))
    merged = sorted([*first, *second], key=lambda message: message.log_time)
    assert laid.tobytes() == one_by_one(merged)[0]


def test_nothing() -> None:
    laid, bounds = lay_out(stamped(1, ints([]), np.empty(0, "V7")))
    assert laid.tobytes() == b""
    assert bounds.tolist() == [0]
