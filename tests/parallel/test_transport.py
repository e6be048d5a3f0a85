"""What one process sends, another receives: by a pipe alone, or with a tray."""

import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, BinaryIO

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dogbot_logtool.parallel.transport import NeighbourDied, Tray, receive, send

MIB = 1 << 20
trays = pytest.mark.parametrize("with_tray", [False, True])
sizes = st.lists(st.sampled_from([0, 1, 63, 64, 100_000, 7 * MIB, 16 * MIB, 16 * MIB + 1]))


@contextmanager
def pipe() -> Iterator[tuple[BinaryIO, BinaryIO]]:
    """Yield the ends at which things arrive and leave."""
    arrive, leave = os.pipe()
    with open(arrive, "rb") as reader, open(leave, "wb") as writer:  # noqa: PTH123
        yield reader, writer


def arrays(*counts: int) -> list[np.ndarray]:
    return [
        np.arange(count, dtype=np.uint32).astype(np.uint8) + number
        for number, count in enumerate(counts)
    ]


def passed_on(thing: object, tray: Tray | None, *, lent: bool = False) -> Any:
    """Send and receive at once, since a pipe holds little."""
    with pipe() as (reader, writer):
        sender = threading.Thread(target=send, args=(writer, thing, tray))
        sender.start()
        received = receive(reader, tray, lent=lent)
        sender.join()
        return received


@trays
@pytest.mark.parametrize("lent", [False, True])
@settings(max_examples=25, deadline=None)
@given(counts=sizes)
def test_things_arrive_as_they_were_sent(*, with_tray: bool, lent: bool, counts: list[int]) -> None:
    """What does not fit on the tray, any more or at all, goes through the pipe."""
    tray = Tray() if with_tray else None
    plain, vectors, rest = arrays(*counts), np.ones((3, 2))[::2], ("text", 1.5, None)
    got_plain, got_vectors, got_rest = passed_on((plain, vectors, rest), tray, lent=lent)
    assert got_rest == rest
    assert np.array_equal(got_vectors, vectors)
    for one, other in zip(got_plain, plain, strict=True):
        assert one.dtype == other.dtype
        assert np.array_equal(one, other)


@pytest.mark.parametrize("lent", [False, True])
def test_what_is_lent_lies_in_the_tray_and_what_is_not_outlasts_it(*, lent: bool) -> None:
    tray = Tray()
    (sent,) = arrays(1000)
    (first,) = passed_on([sent], tray, lent=lent)
    passed_on([np.full(1000, 7, np.uint8)], tray, lent=lent)
    assert (first == 7).all() == lent
    assert np.array_equal(first, sent) != lent


@trays
def test_several_things_follow_each_other(*, with_tray: bool) -> None:
    """A tray holds those of one thing at a time."""
    tray = Tray() if with_tray else None
    with pipe() as (reader, writer):
        for number in range(3):
            send(writer, arrays(number, 10 * number), tray)
            assert [len(array) for array in receive(reader, tray)] == [number, 10 * number]


@pytest.mark.parametrize("kept", [0, 1, 10, 30_000])
def test_half_a_thing_is_none(kept: int) -> None:
    with pipe() as (reader, writer):
        send(writer, arrays(50_000))
        whole = os.read(reader.fileno(), 100_000)
    assert len(whole) > 50_000
    with pipe() as (reader, writer):
        writer.write(whole[:kept])
        writer.close()
        with pytest.raises(NeighbourDied):
            receive(reader)
