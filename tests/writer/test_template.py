"""Templates: places of numbers are learnt, and copies are what the serialiser would have made."""

import struct

import numpy as np
import pytest
from google.protobuf.timestamp_pb2 import Timestamp
from hypothesis import example, given
from hypothesis import strategies as st

from dogbot_logtool.writer.template import Fill, Kind, Slot, Template, learn, varints

PAIR = struct.Struct("<3sIId?fx")
NS = 1_000_000_000
INT64 = st.integers(-(2**63), 2**63 - 1)


def packed(fill: Fill) -> bytes:
    return PAIR.pack(
        b"abc",
        fill(Slot("t.sec"), Kind.UINT32),
        fill(Slot("t.nanosec"), Kind.UINT32),
        fill(Slot("force"), Kind.FLOAT64),
        fill(Slot("touches"), Kind.BOOL),
        fill(Slot("red"), Kind.FLOAT32),
    )


def timestamp(fill: Fill) -> bytes:
    seconds, nanoseconds = (fill(Slot(f"t.{part}"), Kind.VARINT) for part in ("sec", "nanosec"))
    stamp = Timestamp(seconds=int(seconds), nanos=int(nanoseconds))
    return stamp.SerializeToString(deterministic=True)


def timestamps() -> Template:
    return learn(timestamp)


@given(
    st.lists(
        st.tuples(
            st.integers(0, 2**32 * NS - 1),
            st.floats(),
            st.booleans(),
            st.floats(width=32),
        )
    )
)
def test_copies_are_what_the_serialiser_makes(
    rows: list[tuple[int, float, bool, float]],
) -> None:
    template = learn(packed)
    copies = template.copies(len(rows))
    template.write_time(copies, "t", np.array([time for time, *_ in rows], np.int64))
    copies["force"] = [force for _, force, _, _ in rows]
    copies["touches"] = [touches for _, _, touches, _ in rows]
    copies["red"] = np.array([red for *_, red in rows], np.float32)
    wanted = [
        PAIR.pack(b"abc", time // NS, time % NS, force, touches, red)
        for time, force, touches, red in rows
    ]
    told = [copy.tobytes() for copy in copies]
    # Not every NaN survives Python's conversions, so those are compared by being one.
    for got, want in zip(told, wanted, strict=True):
        np.testing.assert_equal(PAIR.unpack(got), PAIR.unpack(want))
        assert got[:11] == want[:11]


def test_a_number_in_two_places_is_refused() -> None:
    def serialise(fill: Fill) -> bytes:
        return struct.pack("<I10xI", *[fill(Slot("n"), Kind.UINT32)] * 2)

    with pytest.raises(AssertionError, match="n is not written once, in a fixed width"):
        learn(serialise)


def test_a_number_that_changes_other_bytes_too_is_refused() -> None:
    def serialise(fill: Fill) -> bytes:
        number = fill(Slot("n"), Kind.UINT32)
        return struct.pack("<Ifx", int(number), float(number))

    with pytest.raises(AssertionError, match="more changes than n"):
        learn(serialise)


@given(st.lists(INT64, min_size=1, max_size=20))
@example([0])
@example([1, 127, 128, 2**31 - 1, 2**32])
@example([2**35 - 1])
@example([2**35])
@example([2**35 - 1, 2**35, 0])
@example([-1, 0, 2**63 - 1, -(2**63)])
def test_padded_varints_are_read_by_protobuf(numbers: list[int]) -> None:
    template = timestamps()
    copies = template.copies(len(numbers))
    template.write_time(copies, "t", np.zeros(len(numbers), np.int64))
    copies["t.sec"] = varints(np.array(numbers, np.int64))
    told = [Timestamp.FromString(copy.tobytes()) for copy in copies]
    assert [stamp.seconds for stamp in told] == numbers
    assert {stamp.nanos for stamp in told} == {0}


@given(st.lists(INT64, min_size=1, max_size=20))
@example([0])
@example([-1])
@example([999_999_999, NS, NS + 1])
@example([(2**35 - 1) // 4 * NS])
def test_times_are_split_into_seconds_and_nanoseconds(times: list[int]) -> None:
    template = timestamps()
    copies = template.copies(len(times))
    template.write_time(copies, "t", np.array(times, np.int64))
    told = [Timestamp.FromString(copy.tobytes()) for copy in copies]
    assert [stamp.seconds * NS + stamp.nanos for stamp in told] == times
    assert all(0 <= stamp.nanos < NS for stamp in told)


@given(st.lists(st.integers(0, 2**32 * NS - 1), min_size=1, max_size=20))
def test_times_of_ros_fill_unsigned_words(times: list[int]) -> None:
    template = learn(packed)
    copies = template.copies(len(times))
    template.write_time(copies, "t", np.array(times, np.int64))
    assert [PAIR.unpack(copy.tobytes())[1:3] for copy in copies] == [
        divmod(time, NS) for time in times
    ]
