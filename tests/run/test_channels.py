"""Results that go through shared memory and a pipe arrive as they were sent."""

import os
import threading
from collections.abc import Iterator
from contextlib import ExitStack
from typing import Any, BinaryIO

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dogbot_logtool.run.channels import PeerEndedError, Pipe, ResultChannel


class Ends:
    """The pipes of a channel, and the channel."""

    def __init__(self, stack: ExitStack) -> None:
        self._stack = stack
        self.results, self.taken = self._pipe(), self._pipe()
        self.channel = ResultChannel(self.results, self.taken)

    def _pipe(self) -> Pipe:
        reader, writer = os.pipe()
        ends: list[BinaryIO] = [os.fdopen(reader, "rb"), os.fdopen(writer, "wb")]
        for end in ends:
            self._stack.enter_context(end)
        return ends[0], ends[1]


@pytest.fixture
def ends() -> Iterator[Ends]:
    with ExitStack() as stack:
        yield Ends(stack)


def sent(ends: Ends, *results: Any) -> list[Any]:
    """Send results from another thread, and receive them."""

    def send_all() -> None:
        for result in results:
            ends.channel.send(result)

    sender = threading.Thread(target=send_all)
    sender.start()
    got = [ends.channel.receive() for _ in results]
    sender.join()
    return got


ARRAYS = st.builds(
    lambda size, kind, step: np.arange(size * step).astype(kind)[::step],
    st.sampled_from([0, 1, 511, 512, 513, 4096, 70_000]),
    st.sampled_from(["u1", "<i8", "<f8"]),
    st.integers(1, 3),
)


@settings(max_examples=30)
@given(st.lists(st.lists(ARRAYS, max_size=6), max_size=4))
def test_arrays_of_all_sizes_arrive(results: list[list[np.ndarray]]) -> None:
    with ExitStack() as stack:
        got = sent(Ends(stack), *results)
    for arrived, result in zip(got, results, strict=True):
        for one, other in zip(arrived, result, strict=True):
            assert one.dtype == other.dtype
            np.testing.assert_array_equal(one, other)


def test_what_does_not_fit_goes_through_the_pipe(ends: Ends) -> None:
    large = [np.full(9 << 20, number, np.uint8) for number in range(3)]
    (got,) = sent(ends, large)
    assert [(len(each), each[0], each[-1]) for each in got] == [
        (9 << 20, number, number) for number in range(3)
    ]


def test_a_result_stays_as_it_is_when_the_next_one_arrives(ends: Ends) -> None:
    first, second = sent(ends, *(np.full(100_000, number) for number in (1, 2)))
    assert (first == 1).all()
    assert (second == 2).all()
    first[:] = 3


def test_a_result_waits_until_the_one_before_is_received(ends: Ends) -> None:
    ends.channel.send(np.zeros(10_000))
    second = threading.Thread(target=ends.channel.send, args=(np.ones(10_000),))
    second.start()
    assert (ends.channel.receive() == 0).all()
    assert (ends.channel.receive() == 1).all()
    second.join()


def test_both_ends_learn_that_the_other_one_ended(ends: Ends) -> None:
    ends.channel.send(np.zeros(10_000))
    ends.channel.receive()
    for end in (ends.results[1], ends.taken[1]):
        end.close()
    with pytest.raises(PeerEndedError):
        ends.channel.receive()
    ends.taken[0].read(1)
    with pytest.raises(PeerEndedError):
        ends.channel.send(1)


def test_half_a_result_is_none(ends: Ends) -> None:
    ends.results[1].write(b"\x80\x05\x95\xff")
    ends.results[1].close()
    with pytest.raises(PeerEndedError):
        ends.channel.receive()
