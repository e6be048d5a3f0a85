"""Which channels are declared, with which ids, under which topics, and what goes where."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from io import BytesIO
from typing import Any

import numpy as np
import pytest
from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate
from hypothesis import given
from hypothesis import strategies as st
from mcap import records
from mcap.data_stream import ReadDataStream
from mcap.stream_reader import StreamReader
from rosbags.typesys import Stores, get_typestore

from dogbot_logtool.core.base.odometry import Transforms
from dogbot_logtool.core.load.loads import Loads
from dogbot_logtool.core.scene.arrows import Arrows
from dogbot_logtool.core.scene.labels import Labels
from dogbot_logtool.errors import LogtoolError
from dogbot_logtool.writer.annotations import (
    AnnotationColumns,
    Annotations,
    WantedAnnotations,
)
from dogbot_logtool.writer.channels import AddedChannels, IdSource
from dogbot_logtool.writer.encodings.encoding import ArrowLook, Encoding, MessageType
from dogbot_logtool.writer.encodings.foxglove import FoxgloveEncoding
from dogbot_logtool.writer.encodings.ros1 import Ros1Encoding
from dogbot_logtool.writer.encodings.ros2 import Ros2Encoding
from dogbot_logtool.writer.mcap_writer import McapWriter
from dogbot_logtool.writer.messages.robot_description import description_type
from dogbot_logtool.writer.topics import arrow_topic, load_topic

FEET = ("left", "right")
ENCODINGS = (FoxgloveEncoding(), Ros1Encoding(), Ros2Encoding())


def declared(
    encoding: Encoding,
    feet: Sequence[str] = FEET,
    *,
    with_tf: bool = True,
    with_labels: bool = False,
    description: MessageType | None = None,
    used: frozenset[int] = frozenset(),
    resolve: Callable[[str, MessageType], str] = lambda topic, _: topic,
) -> Annotations:
    wanted = WantedAnnotations(
        feet,
        "world",
        "base",
        ArrowLook(0.04, 0.5),
        base_transform=with_tf,
        labels=with_labels,
        description=description,
    )
    return Annotations(encoding, wanted, AddedChannels(IdSource(used), IdSource(used), resolve))


@pytest.mark.parametrize("encoding", ENCODINGS, ids=lambda one: type(one).__name__)
def test_channels(encoding: Encoding) -> None:
    annotations = declared(encoding)
    topics = {channel.topic for channel in annotations.added.channels}
    wanted = {"/tf", *(f"/marker_basic_{foot}_foot" for foot in FEET)}
    assert topics == wanted | {f"/load/{foot}" for foot in FEET}
    assert len(annotations.added.schemas) == 3
    names = {schema.id: schema.name for schema in annotations.added.schemas}
    types = {channel.topic: names[channel.schema_id] for channel in annotations.added.channels}
    assert types["/tf"] == encoding.transform_type.name
    assert types[arrow_topic("left")] == types[arrow_topic("right")] == encoding.arrow_type.name
    assert types[load_topic("left")] == encoding.load_type.name
    assert annotations.added.topics() == {c.id: c.topic for c in annotations.added.channels}
    assert len(annotations.added.topics()) == 5


def test_without_tf_and_feet_there_is_nothing() -> None:
    annotations = declared(ENCODINGS[0], (), with_tf=False)
    assert (annotations.added.schemas, annotations.added.channels) == ([], [])
    assert list(annotations.messages(AnnotationColumns(no_transforms(), [], []))) == []


@pytest.mark.parametrize("used", [{1, 2, 3}, {65535}, {40, 65535, 1}, set(range(1, 65500))])
def test_ids_are_free_and_unique(used: set[int]) -> None:
    annotations = declared(ENCODINGS[0], used=frozenset(used))
    for ids in (
        [channel.id for channel in annotations.added.channels],
        [schema.id for schema in annotations.added.schemas],
    ):
        assert len(set(ids)) == len(ids)
        assert used.isdisjoint(ids)
        assert all(0 < number < 65536 for number in ids)
    if max(used) < 65000:
        assert min(channel.id for channel in annotations.added.channels) > max(used)


@given(st.sets(st.integers(65000, 65535)))
def test_ids_above_the_highest_come_first(used: set[int]) -> None:
    source = IdSource(used | set(range(1, 65000)))
    free = [number for number in range(1, 65536) if number not in used and number >= 65000]
    taken = [source.take() for _ in free]
    assert sorted(taken) == free
    highest = max(used | {64999})
    assert taken[: 65535 - highest] == list(range(highest + 1, 65536))
    with pytest.raises(LogtoolError, match="ids"):
        source.take()


def test_topics_are_resolved_with_their_types() -> None:
    asked: dict[str, str] = {}

    def resolve(topic: str, kind: MessageType) -> str:
        asked[topic] = kind.name
        return f"/elsewhere{topic}"

    annotations = declared(ENCODINGS[0], resolve=resolve)
    assert {channel.topic for channel in annotations.added.channels} == {
        f"/elsewhere{topic}" for topic in asked
    }
    assert asked["/tf"] == "foxglove.FrameTransforms"


def no_transforms() -> Transforms:
    nothing = np.empty(0, np.int64)
    return Transforms(nothing, nothing, np.empty((0, 3)), np.empty((0, 4)))


def arrows(foot: list[int], times: list[int], shown: list[bool]) -> Arrows:
    count = len(foot)
    return Arrows(
        foot=np.array(foot, np.int64),
        log_time=np.array(times, np.int64),
        stamp=np.array(times, np.int64) + 5,
        shown=np.array(shown, np.bool_),
        position=np.arange(count * 3.0).reshape(count, 3),
        orientation=np.tile([0.0, 0.0, 0.0, 1.0], (count, 1)),
        length=np.arange(1.0, count + 1.0),
        colour=np.tile(np.array([1.0, 0.5, 0.25, 1.0], np.float32), (count, 1)),
    )


def loads(foot: list[int], times: list[int]) -> Loads:
    count = len(foot)
    return Loads(
        foot=np.array(foot, np.int64),
        log_time=np.array(times, np.int64),
        stamp=np.array(times, np.int64),
        in_contact=np.ones(count, np.bool_),
        state=np.zeros(count, np.int64),
        force=np.arange(float(count)),
        body_weights=np.full(count, np.nan),
    )


def messages_of(annotations: Annotations, columns: AnnotationColumns) -> list[tuple[str, Any]]:
    laid = b"".join(group.data.tobytes() for group in annotations.messages(columns))
    stream = BytesIO(laid)
    topics = annotations.added.topics()
    found: list[tuple[str, Any]] = []
    while stream.tell() < len(laid):
        data = ReadDataStream(stream)
        assert data.read1() == 5
        message = records.Message.read(data, data.read8())
        found.append((topics[message.channel_id], message))
    return found


def test_messages_go_to_their_foot_in_the_order_of_time() -> None:
    annotations = declared(ENCODINGS[0])
    times = np.array([15], np.int64)
    transforms = Transforms(times, times, np.zeros((1, 3)), np.array([[0.0, 0.0, 0.0, 1.0]]))
    columns = AnnotationColumns(
        transforms,
        [arrows([0, 1, 0], [10, 20, 30], [True, True, False]), arrows([1], [12], [True])],
        [loads([0, 1, 0], [10, 20, 30])],
    )
    found = messages_of(annotations, columns)
    assert [(message.log_time, topic) for topic, message in found] == [
        (10, arrow_topic("left")),
        (10, load_topic("left")),
        (12, arrow_topic("right")),
        (15, "/tf"),
        (20, arrow_topic("right")),
        (20, load_topic("right")),
        (30, arrow_topic("left")),
        (30, load_topic("left")),
    ]
    assert all(message.publish_time == message.log_time for _, message in found)
    scenes = [SceneUpdate.FromString(m.data) for topic, m in found if "marker" in topic]
    assert [len(scene.entities) for scene in scenes] == [1, 1, 1, 0]
    assert scenes[3].deletions[0].id == "left"
    assert [scene.entities[0].id for scene in scenes[:3]] == ["left", "right", "right"]
    assert scenes[2].entities[0].timestamp.nanos == 25
    arrow = scenes[2].entities[0].arrows[0]
    assert (arrow.pose.position.x, arrow.pose.position.z) == (3.0, 5.0)
    np.testing.assert_allclose(arrow.shaft_length + arrow.head_length, 2.0)
    assert (arrow.color.r, arrow.color.g, arrow.color.b, arrow.color.a) == (1.0, 0.5, 0.25, 1.0)


def test_topics_of_feet() -> None:
    assert arrow_topic("front_left") == "/marker_basic_front_left_foot"
    assert load_topic("front_left") == "/load/front_left"


def test_the_library_reads_declared_channels() -> None:
    """Schemas and channels are what the mcap library can write and read."""
    for encoding in ENCODINGS:
        annotations = declared(encoding)
        sink = BytesIO()
        writer = McapWriter(sink, "")
        for schema in annotations.added.schemas:
            writer.add_schema(schema)
        for channel in annotations.added.channels:
            writer.add_channel(channel)
        writer.finish()
        read = list(StreamReader(BytesIO(sink.getvalue())).records)
        assert [r for r in read if isinstance(r, records.Schema)][:3] == annotations.added.schemas
        assert [r for r in read if isinstance(r, records.Channel)][:5] == annotations.added.channels


@pytest.mark.parametrize("encoding", ENCODINGS, ids=lambda one: type(one).__name__)
@pytest.mark.parametrize("profile", ["ros1", "ros2", ""])
def test_a_robot_description_is_a_string_of_ros(encoding: Encoding, profile: str) -> None:
    annotations = declared(encoding, with_tf=False, description=description_type(profile))
    urdf = '<robot name="d\u00f6g"/>'
    written = annotations.robot_description(urdf, 42).data.tobytes()
    stream = ReadDataStream(BytesIO(written))
    assert stream.read1() == 5
    message = records.Message.read(stream, stream.read8())
    channel = annotations.added.channels[-1]
    assert (message.channel_id, message.log_time) == (channel.id, 42)
    assert channel.topic == "/robot_description"
    store = get_typestore(Stores.ROS1_NOETIC if profile == "ros1" else Stores.ROS2_HUMBLE)
    read = store.deserialize_ros1 if profile == "ros1" else store.deserialize_cdr
    decoded: Any = read(message.data, "std_msgs/msg/String")
    assert decoded.data == urdf
    assert channel.message_encoding == ("ros1" if profile == "ros1" else "cdr")


@pytest.mark.parametrize("encoding", ENCODINGS, ids=lambda one: type(one).__name__)
def test_loads_say_their_state(encoding: Encoding) -> None:
    annotations = declared(encoding, with_tf=False)
    states = replace(loads([0, 0, 0], [1, 2, 3]), state=np.array([0, 1, 2]))
    found = messages_of(annotations, AnnotationColumns(no_transforms(), [], [states]))
    for (_, message), state in zip(found, ("stance", "swing", "unknown"), strict=True):
        assert state.encode() in message.data


def test_labels_are_written_and_removed() -> None:
    feet = ("front_left", "front_right")
    annotations = declared(ENCODINGS[0], feet, with_tf=False, with_labels=True)
    times = np.array([1, 2, 3], np.int64)
    labels = Labels(
        foot=np.array([0, 1, 1]),
        log_time=times,
        stamp=times,
        shown=np.array([True, True, False]),
        position=np.arange(9.0).reshape(3, 3),
        force=np.array([94.4, 1e300, 0.0]),
    )
    columns = AnnotationColumns(no_transforms(), [], [], labels=[labels])
    found = [
        (topic, SceneUpdate.FromString(message.data))
        for topic, message in messages_of(annotations, columns)
    ]
    assert [topic for topic, _ in found] == ["/label/front_left", *["/label/front_right"] * 2]
    (text,) = found[0][1].entities[0].texts
    assert text.text.split() == ["FL", "94", "N"]
    assert (text.pose.position.x, text.pose.position.z) == (0.0, 2.0)
    assert found[1][1].entities[0].texts[0].text == "FR >10 kN"
    assert [deletion.id for deletion in found[2][1].deletions] == ["front_right"]
