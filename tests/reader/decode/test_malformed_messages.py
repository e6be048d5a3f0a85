"""Malformed messages: they are unsound where rosbags refuses them, and none costs memory."""

import tracemalloc
from collections.abc import Callable
from typing import Any, Final

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dogbot_logtool.reader.decode.decode import MAX_VARIABLE_ELEMENTS
from tests.reader.decode.oracle import (
    WIRES,
    Author,
    Wire,
    assert_same,
    decode_alone,
    decode_messages,
    define,
    definitions,
    generated,
    ros_of,
)


def truncations(message: bytes) -> list[bytes]:
    return [message[:length] for length in range(len(message))]


def flips(message: bytes) -> list[bytes]:
    """One byte at a time, made huge, negated, or one more or less (as counts go wrong)."""
    changes: tuple[Callable[[int], int], ...] = (
        lambda byte: byte ^ 0xFF,
        lambda byte: (byte + 1) & 0xFF,
        lambda byte: (byte - 1) & 0xFF,
    )
    return [
        message[:place] + bytes([change(message[place])]) + message[place + 1 :]
        for place in range(len(message))
        for change in changes
    ]


def hostile_words(message: bytes) -> list[bytes]:
    """Four bytes at a time, as the largest and the most nearly negative counts."""
    words = (b"\xff\xff\xff\xff", b"\xff\xff\xff\x7f", b"\x7f\xff\xff\xff", b"\0\0\0\x80")
    return [
        message[:place] + word + message[place + 4 :]
        for place in range(len(message) - 3)
        for word in words
    ]


def extensions(message: bytes) -> list[bytes]:
    return [message + bytes(count) for count in range(1, 10)]


DAMAGES: Final[dict[str, Callable[[bytes], list[bytes]]]] = {
    "truncated": truncations,
    "with a byte changed": flips,
    "with a hostile count": hostile_words,
    "with bytes appended": extensions,
}


@pytest.mark.parametrize("damage", DAMAGES)
@pytest.mark.parametrize("wire", WIRES)
@settings(generated, max_examples=12)
@given(data=st.data(), seed=st.integers(0, 2**32))
def test_a_message_is_unsound_if_and_only_if_rosbags_refuses_it(
    wire: Wire, damage: str, data: st.DataObject, seed: int
) -> None:
    definition = data.draw(definitions(ros_of(wire)))
    layout = definition.layout(wire)
    author = Author(definition, wire, seed)
    first, damaged, last = author.write(3)
    messages = [first, *thinned(DAMAGES[damage](damaged), 200, seed), last]
    verdicts = [verdict(author, wire, message, first) for message in messages]

    decoded = decode_messages(layout, messages, seed)

    assert decoded.sound[[0, -1]].all()
    assert decoded.table.rows == decoded.sound.sum()
    clear = [row for row, (accepted, _) in enumerate(verdicts) if accepted is not None]
    decoded = decode_messages(layout, [messages[row] for row in clear], seed)
    assert decoded.sound.tolist() == [verdicts[row][0] for row in clear]
    assert_same(definition, decoded.table, [verdicts[row][1] for row in clear if verdicts[row][0]])


def thinned(messages: list[bytes], at_most: int, seed: int) -> list[bytes]:
    if len(messages) <= at_most:
        return messages
    chosen = np.random.default_rng(seed).choice(len(messages), at_most, replace=False)
    return [messages[index] for index in chosen]


def verdict(author: Author, wire: Wire, message: bytes, first: bytes) -> tuple[bool | None, Any]:
    """Whether a message is sound, and its value; None where no verdict can be had."""
    value = author.read(message)
    if value is None:
        return (None if author.is_excused else False), None
    if wire != "ros1" and message[1] != first[1]:
        return False, None  # the byte order is another one than its neighbours'
    return True, value


def test_a_truncated_message_alone_is_unsound_though_wanted_fields_lie_far_apart() -> None:
    text = "uint8[10] a\nuint8[900] b\nfloat64 c\nuint8[200] d\nfloat64 e"
    layout = define(1, text).layout("ros1", ("a", "c", "e"))

    for length in range(10 + 900 + 8 + 200 + 8):
        decoded = decode_alone(layout, bytes(length))

        assert decoded.sound.tolist() == [False]
        assert decoded.table.rows == 0


def test_counts_that_no_message_can_hold_allocate_nothing() -> None:
    definition = define(
        2,
        "string a\nfloat64[] b\nInner[] c\nstring[] d\nInner[2] e\nuint8[] f",
        Inner="uint8 x\nstring y\nuint32[] z\nEven[] even",
        Even="float64 x\nfloat64 y",
    )
    layout = definition.layout("cdr little-endian")
    worst = max(Author(definition, "cdr little-endian", 5).write(40), key=len)
    places = range(4, len(worst) - 3)
    hostile = [worst[:place] + b"\xff" * 4 + worst[place + 4 :] for place in places]
    decode_messages(layout, hostile)

    tracemalloc.start()
    try:
        decode_messages(layout, hostile)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()

    assert peak < 100 * sum(len(message) for message in hostile)


def test_absurdly_large_messages_allocate_nothing() -> None:
    layout = define(1, "uint8[2000000000] x").layout("ros1")
    assert not decode_messages(layout, [b"abc"] * 5000).sound.any()


@pytest.mark.parametrize(("excess", "sound"), [(0, True), (1, False)])
def test_arrays_of_uneven_elements_have_a_limit(excess: int, sound: bool) -> None:  # noqa: FBT001
    definition = define(1, "string[] texts")
    count = MAX_VARIABLE_ELEMENTS + excess
    message = count.to_bytes(4, "little") + bytes(4 * count)
    neighbour = (1).to_bytes(4, "little") + (2).to_bytes(4, "little") + b"ab"

    decoded = decode_messages(definition.layout("ros1"), [neighbour, message, neighbour])

    assert decoded.sound.tolist() == [True, sound, True]
