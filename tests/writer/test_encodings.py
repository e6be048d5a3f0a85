"""Messages of all encodings: how they are made, and how other readers take them."""

import struct
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from google.protobuf.timestamp_pb2 import Timestamp
from hypothesis import example, given, settings
from hypothesis import strategies as st
from rosbags.highlevel import AnyReader

import dogbot_logtool as dl
from dogbot_logtool.errors import LogtoolError
from dogbot_logtool.mcap_layout import MESSAGE_HEAD
from dogbot_logtool.writer.channels import added_channels
from dogbot_logtool.writer.chunks import CHUNK_SIZE, finish_chunks, indexed_channels, recorded
from dogbot_logtool.writer.encodings.encoding import MessageType
from dogbot_logtool.writer.encodings.foxglove import FoxgloveEncoding
from dogbot_logtool.writer.encodings.ros import Ros2Encoding
from dogbot_logtool.writer.template import Columns, Literal, Of, Slot, Template, learn
from tests.oracles import walks
from tests.oracles.annotated_file import read_written

NS = 1_000_000_000
KIND = MessageType("a/B", "ros1msg", b"", "ros1")


def test_a_converted_log_is_read_by_others(tmp_path: Path) -> None:
    kind = "gazebo_msgs/msg/ContactsState"
    path = walks.write_walk(tmp_path, kind, "rosbag2-sqlite3")
    target, robot = tmp_path / "out.mcap", walks.robot_file(tmp_path, kind)
    done = dl.convert(path, target, robot=str(robot), encoding="ros2")

    written = read_written(target)
    annotations = {topic: count for topic, count in done.annotations.items() if count}
    assert {topic: written.topics[topic] for topic in annotations} == annotations
    assert written.topics.total() == sum(annotations.values()) + 5 * walks.SAMPLES
    with AnyReader([target]) as log:
        seen: Counter[str] = Counter()
        for connection, _, data in log.messages():
            log.deserialize(data, connection.msgtype)
            seen[connection.topic] += 1
    assert seen == +written.topics


# --- Channels, and the file's edges ---------------------------------------------------------------


@settings(max_examples=10)
@given(st.sets(st.integers(65000, 65535)))
def test_ids_are_those_that_the_log_does_not_use(used: set[int]) -> None:
    free = [number for number in range(65000, 65536) if number not in used]
    types, ids = {f"/{number}": KIND for number in free}, used | set(range(1, 65000))
    _, channels = added_channels(types, (), ids, {})
    assert [channel.id for channel in channels.values()] == free
    with pytest.raises(LogtoolError, match="ids"):
        added_channels({**types, "/one more": KIND}, (), ids, {})


def test_a_message_larger_than_a_chunk_is_not_split() -> None:
    sizes = np.array([1, CHUNK_SIZE + 5, 1, 3 * CHUNK_SIZE, 1, 1])
    time, zero, end = np.arange(6), np.zeros(6, np.int64), np.cumsum(sizes)
    data = np.zeros(end[-1], np.uint8)
    messages = recorded(zero + 1, zero, time, time, data, end - sizes, end)
    chunks = list(finish_chunks(messages, "none"))
    assert sum(chunk.size for chunk in chunks) == sum(sizes) + 6 * (9 + 22)
    counts = [count for chunk in chunks for _, _, count in indexed_channels(chunk.index)]
    assert sum(counts) == 6
    assert len(chunks) >= 3


# --- Templates ------------------------------------------------------------------------------------


INT64 = st.integers(-(2**63), 2**63 - 1)
STAMP = {"sec": Slot("stamp.sec", of=Of.TIME), "nanosec": Slot("stamp.nanosec", of=Of.TIME)}


def timestamp(filled: Literal) -> bytes:
    stamp = Timestamp(seconds=filled["sec"], nanos=filled["nanosec"])
    return stamp.SerializeToString(deterministic=True)


def payloads(template: Template, columns: Columns, count: int) -> list[bytes]:
    records = template.records(3, np.arange(count), columns, np.arange(count))
    assert records["channel"].tolist() == [3] * count
    assert records["log_time"].tolist() == records["publish_time"].tolist() == list(range(count))
    return [each.tobytes()[MESSAGE_HEAD.itemsize :] for each in records]


@pytest.mark.parametrize("text", [b"!   ", b"a text", b'!!!     "!!     #!!     '])
def test_a_text_may_have_the_bytes_of_a_mark(text: bytes) -> None:
    width = len(text)
    form = struct.Struct(f"<{width}sd{width}s")
    template = learn(
        lambda filled: form.pack(text, filled["force"], text),
        {"force": Slot("force")},
        Ros2Encoding.kinds,
    )
    assert payloads(template, {"force": np.array([7.5])}, 1) == [form.pack(text, 7.5, text)]


@given(st.lists(INT64, min_size=1, max_size=20))
@example([0])
@example([-1])
@example([999_999_999, NS, NS + 1])
def test_times_are_split_into_seconds_and_nanoseconds(times: list[int]) -> None:
    columns = FoxgloveEncoding().stamp_columns(np.array(times, np.int64))
    template = learn(timestamp, STAMP, FoxgloveEncoding.kinds)
    told = [Timestamp.FromString(each) for each in payloads(template, columns, len(times))]
    assert [stamp.seconds * NS + stamp.nanos for stamp in told] == times
    assert all(0 <= stamp.nanos < NS for stamp in told)
