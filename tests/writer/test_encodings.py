"""Messages of all encodings, as the official libraries and other readers take them."""

from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from google.protobuf.descriptor_pb2 import FileDescriptorSet
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader

from dogbot_logtool.commands.convert import convert
from dogbot_logtool.errors import LogtoolError
from dogbot_logtool.options.convert import ConvertOptions
from dogbot_logtool.writer.channels import added_channels
from dogbot_logtool.writer.chunks import CHUNK_SIZE, finish_chunk, finish_chunks, indexed_channels
from dogbot_logtool.writer.encodings.encoding import MessageType
from dogbot_logtool.writer.encodings.registry import ENCODINGS
from dogbot_logtool.writer.mcap_writer import McapWriter
from dogbot_logtool.writer.message_records import MessageRecords, recorded
from tests.oracles import walks
from tests.oracles.annotated_file import annotations, read_written
from tests.oracles.conversion import xyz
from tests.oracles.ros1_logs import BASE, FEET, write_standing_log

NS = 1_000_000_000
KIND = MessageType("a/B", "ros1msg", b"", "ros1")


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_labels_stand_at_the_feet(tmp_path: Path, encoding: str) -> None:
    log = write_standing_log(tmp_path / "log.mcap")
    convert(log, tmp_path / "out.mcap", ConvertOptions(encoding=encoding, copy=False))
    written = read_written(tmp_path / "out.mcap")
    kind = "foxglove.SceneUpdate" if encoding == "foxglove" else "visualization_msgs/Marker"
    for foot, offset in FEET.items():
        shown = removed = 0
        for _, message in annotations(written, f"/label/{foot}", encoding, kind):
            is_ros = hasattr(message, "header")
            if message.action == 2 if is_ros else message.deletions:
                # Viewers know what to remove by its name.
                assert (
                    (message.ns, message.id) == ("label", 0)
                    if is_ros
                    else message.deletions[0].id == foot
                )
                removed += 1
                continue
            one = message if is_ros else message.entities[0].texts[0]
            assert one.text.endswith(" N ") or one.text.endswith(" N")
            expected = [a + b for a, b in zip(BASE, offset, strict=True)]
            assert xyz(one.pose.position)[:2] == pytest.approx(expected[:2], abs=0.1)
            shown += 1
        assert shown


def test_schemas_of_protobuf_are_complete(tmp_path: Path) -> None:
    log = write_standing_log(tmp_path / "log.mcap")
    convert(log, tmp_path / "out.mcap", ConvertOptions(copy=False))
    schemas = read_written(tmp_path / "out.mcap").schemas.values()
    complete = [schema for schema in schemas if schema.encoding == "protobuf"]
    assert len(complete) >= 4
    for schema in complete:
        files = FileDescriptorSet.FromString(schema.data).file
        seen: set[str] = set()
        for file in files:
            assert set(file.dependency) <= seen, "a dependency must stand before what needs it"
            seen.add(file.name)
        names = {f"{file.package}.{each.name}" for file in files for each in file.message_type}
        assert schema.name in names


def test_a_converted_log_is_read_by_others(tmp_path: Path) -> None:
    kind = "gazebo_msgs/msg/ContactsState"
    path = walks.write_walk(tmp_path, kind, "rosbag2-sqlite3")
    options = ConvertOptions(robot=str(walks.robot_file(tmp_path, kind)), encoding="ros2")
    target = tmp_path / "out.mcap"
    done = convert(path, target, options)

    counts: dict[str, int] = {}
    with target.open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True, decoder_factories=[DecoderFactory()])
        assert reader.get_header().profile == "ros2"
        for schema, channel, _, message in reader.iter_decoded_messages():
            assert schema is not None
            assert channel.message_encoding == "cdr"
            counts[channel.topic] = counts.get(channel.topic, 0) + 1
            if channel.topic == "/load/front_left":
                sample = (
                    message.stamp.sec * NS + message.stamp.nanosec - walks.START
                ) // walks.STEP
                assert message.in_contact == walks.TOUCHES["front_left"][sample]
                assert message.force == walks.FORCES["front_left"][sample, 2]
    annotations = {topic: count for topic, count in done.annotations.items() if count}
    assert {topic: counts[topic] for topic in annotations} == annotations
    assert annotations["/tf"] == 300
    assert sum(counts.values()) == sum(annotations.values()) + 5 * walks.SAMPLES

    with AnyReader([target]) as log:
        seen: dict[str, int] = {}
        for connection, _, data in log.messages():
            log.deserialize(data, connection.msgtype)
            seen[connection.topic] = seen.get(connection.topic, 0) + 1
    assert seen == counts


# --- Channels, and the file's edges ---------------------------------------------------------------


@settings(max_examples=10)
@given(st.sets(st.integers(65000, 65535)))
def test_ids_are_free_and_those_above_the_highest_come_first(used: set[int]) -> None:
    free = [number for number in range(65000, 65536) if number not in used]
    types, ids = {f"/{number}": KIND for number in free}, used | set(range(1, 65000))
    _, channels = added_channels(types, channel_ids=ids)
    taken = [channel.id for channel in channels.values()]
    assert sorted(taken) == free
    highest = max(used | {64999})
    assert taken[: 65535 - highest] == list(range(highest + 1, 65536))
    with pytest.raises(LogtoolError, match="ids"):
        added_channels({**types, "/one more": KIND}, channel_ids=ids)


def messages(channel: int, times: list[int], sizes: list[int]) -> MessageRecords:
    """Return messages of zeros."""
    log_time, zero, end = np.array(times), np.zeros(len(times), np.int64), np.cumsum(sizes)
    data = np.zeros(sum(sizes), np.uint8)
    start = end - np.array(sizes)
    return recorded(zero + channel, zero, log_time, log_time, data, start, end)


def test_a_message_larger_than_a_chunk_is_not_split() -> None:
    sizes = [1, CHUNK_SIZE + 5, 1, 3 * CHUNK_SIZE, 1, 1]
    chunks = list(finish_chunks(messages(1, [*range(6)], sizes), "none"))
    assert sum(chunk.size for chunk in chunks) == sum(sizes) + 6 * (9 + 22)
    counts = [count for chunk in chunks for _, _, count in indexed_channels(chunk.index)]
    assert sum(counts) == 6
    assert len(chunks) >= 3


@pytest.mark.parametrize("times", [[], [5, 0, 7]])
def test_a_file_may_be_empty_and_may_start_at_time_zero(times: list[int]) -> None:
    sink = BytesIO()
    writer, (schemas, channels) = McapWriter(sink, ""), added_channels({"/one": KIND})
    channel = channels["/one"].id
    writer.add(*schemas, *channels.values())
    for time in times:
        writer.add_chunk(finish_chunk(messages(channel, [time], [1]), "none"))
    writer.finish()
    reader = make_reader(BytesIO(sink.getvalue()), validate_crcs=True)
    summary = reader.get_summary()
    assert summary is not None
    assert summary.statistics is not None
    statistics = summary.statistics
    assert (statistics.message_count, statistics.chunk_count) == (len(times), len(times))
    assert statistics.message_start_time == 0
    assert statistics.message_end_time == max(times, default=0)
    assert [message.log_time for _, _, message in reader.iter_messages()] == sorted(times)
