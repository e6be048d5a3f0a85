"""Templates: places of numbers are learnt, and copies are what the serialiser would have made."""

import struct

import numpy as np
import pytest
from google.protobuf.timestamp_pb2 import Timestamp
from hypothesis import example, given
from hypothesis import strategies as st

from dogbot_logtool.io.mcap_layout import MESSAGE_HEAD
from dogbot_logtool.writer.encodings.foxglove import FoxgloveEncoding
from dogbot_logtool.writer.encodings.ros import Ros2Encoding
from dogbot_logtool.writer.template import (
    Columns,
    Literal,
    Of,
    Slot,
    Template,
    learn,
    varints,
)

PAIR = struct.Struct("<3sIIdfx")
NS = 1_000_000_000
INT64 = st.integers(-(2**63), 2**63 - 1)
STAMP = {"sec": Slot("stamp.sec", of=Of.TIME), "nanosec": Slot("stamp.nanosec", of=Of.TIME)}
VALUES = {
    "force": Slot("force"),
    "red": Slot("red", of=Of.COLOUR),
}
NUMBER = {"n": Slot("n", of=Of.TIME)}
KINDS = Ros2Encoding.kinds


def packed() -> Template:
    return learn(lambda filled: PAIR.pack(b"abc", *filled.values()), {**STAMP, **VALUES}, KINDS)


def timestamp(filled: Literal) -> bytes:
    stamp = Timestamp(seconds=filled["sec"], nanos=filled["nanosec"])
    return stamp.SerializeToString(deterministic=True)


def payloads(template: Template, columns: Columns, count: int) -> list[bytes]:
    records = template.records(3, np.arange(count), columns, np.arange(count))
    assert records["channel"].tolist() == [3] * count
    assert records["log_time"].tolist() == records["publish_time"].tolist() == list(range(count))
    return [each.tobytes()[MESSAGE_HEAD.itemsize :] for each in records]


def timestamps() -> Template:
    return learn(timestamp, STAMP, FoxgloveEncoding.kinds)


@given(
    st.lists(
        st.tuples(
            st.integers(0, 2**32 * NS - 1),
            st.floats(),
            st.floats(width=32),
        )
    )
)
def test_copies_are_what_the_serialiser_makes(
    rows: list[tuple[int, float, float]],
) -> None:
    template = packed()
    columns = {
        **Ros2Encoding().stamp_columns(np.array([time for time, *_ in rows], np.int64)),
        "force": np.array([force for _, force, _ in rows]),
        "red": np.array([red for *_, red in rows], np.float32),
    }
    wanted = [PAIR.pack(b"abc", time // NS, time % NS, force, red) for time, force, red in rows]
    told = payloads(template, columns, len(rows))
    # Not every NaN survives Python's conversions, so those are compared by being one.
    for got, want in zip(told, wanted, strict=True):
        np.testing.assert_equal(PAIR.unpack(got), PAIR.unpack(want))
        assert got[:11] == want[:11]


def test_a_number_may_stand_in_two_places() -> None:
    two = {"first": NUMBER["n"], "second": NUMBER["n"]}
    template = learn(lambda filled: struct.pack("<I10xI", *filled.values()), two, KINDS)
    written = payloads(template, {"n": np.array([7, 8])}, 2)
    assert written == [struct.pack("<I10xI", number, number) for number in (7, 8)]


@pytest.mark.parametrize("text", [b"!   ", b"a text", b'!!!     "!!     #!!     '])
def test_a_text_may_have_the_bytes_of_a_mark(text: bytes) -> None:
    width = len(text)
    form = struct.Struct(f"<{width}sd{width}s")
    template = learn(
        lambda filled: form.pack(text, filled["force"], text), {"force": Slot("force")}, KINDS
    )
    assert payloads(template, {"force": np.array([7.5])}, 1) == [form.pack(text, 7.5, text)]


def test_what_cannot_be_learnt_is_refused() -> None:
    with pytest.raises(AssertionError, match="not of a fixed width"):
        learn(lambda filled: str(filled["n"]).encode(), NUMBER, KINDS)


@given(st.lists(INT64, min_size=1, max_size=20))
@example([0])
@example([1, 127, 128, 2**31 - 1, 2**32])
@example([2**35 - 1])
@example([2**35])
@example([2**35 - 1, 2**35, 0])
@example([-1, 0, 2**63 - 1, -(2**63)])
def test_padded_varints_are_read_by_protobuf(numbers: list[int]) -> None:
    seconds = np.array(numbers, np.int64)
    columns = {"stamp.sec": varints(seconds), "stamp.nanosec": varints(0 * seconds)}
    told = [Timestamp.FromString(each) for each in payloads(timestamps(), columns, len(numbers))]
    assert [stamp.seconds for stamp in told] == numbers
    assert {stamp.nanos for stamp in told} == {0}


@given(st.lists(INT64, min_size=1, max_size=20))
@example([0])
@example([-1])
@example([999_999_999, NS, NS + 1])
@example([(2**35 - 1) // 4 * NS])
def test_times_are_split_into_seconds_and_nanoseconds(times: list[int]) -> None:
    columns = FoxgloveEncoding().stamp_columns(np.array(times, np.int64))
    told = [Timestamp.FromString(each) for each in payloads(timestamps(), columns, len(times))]
    assert [stamp.seconds * NS + stamp.nanos for stamp in told] == times
    assert all(0 <= stamp.nanos < NS for stamp in told)


@given(st.lists(st.integers(0, 2**32 * NS - 1), min_size=1, max_size=20))
def test_times_of_ros_fill_unsigned_words(times: list[int]) -> None:
    nothing = np.zeros(len(times))
    columns = {
        **Ros2Encoding().stamp_columns(np.array(times, np.int64)),
        **dict.fromkeys(("force", "red"), nothing),
    }
    written = payloads(packed(), columns, len(times))
    assert [PAIR.unpack(each)[1:3] for each in written] == [divmod(time, NS) for time in times]
