"""ROS 2 messages that are stamped out are those that rosbags serialises, and others read them."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_typestore

from dogbot_logtool.commands.convert import convert
from dogbot_logtool.robot.options import ConvertOptions, TopicOptions
from dogbot_logtool.writer.encodings.encoding import ArrowLook
from dogbot_logtool.writer.encodings.ros2 import Ros2Encoding
from dogbot_logtool.writer.template import Template
from tests.oracles import walks

NS = 1_000_000_000
TF, MARKER = "tf2_msgs/msg/TFMessage", "visualization_msgs/msg/Marker"
STORE = get_typestore(Stores.ROS2_JAZZY)
"""Another distribution than the one that is written with: viewers are not all of one."""
POSE = ("x", "y", "z", "qx", "qy", "qz", "qw")
NAMES = st.text(st.characters(codec="ascii", categories=["L", "N"]), min_size=1, max_size=9)
TIMES = st.integers(0, 2**31 * NS - 1)
NUMBERS = st.floats(allow_nan=False)
ENCODING = Ros2Encoding()


def stamped(template: Template, time: int, **numbers: float) -> bytes:
    copies = template.copies(2)
    template.write_time(copies, "stamp", np.array([0, time], np.int64))
    for name, number in numbers.items():
        copies[name] = number
    return bytes(copies[1].tobytes())


def stamp_of(message: Any) -> int:
    stamp = message.header.stamp
    return int(stamp.sec * NS + stamp.nanosec)


@settings(max_examples=30)
@given(NAMES, NAMES, TIMES, st.tuples(*[NUMBERS] * 7))
def test_transforms(parent: str, child: str, time: int, numbers: tuple[float, ...]) -> None:
    template = ENCODING.transform(parent, child)
    data = stamped(template, time, **dict(zip(POSE, numbers, strict=True)))
    message: Any = STORE.deserialize_cdr(data, TF)
    (one,) = message.transforms
    assert (one.header.frame_id, one.child_frame_id, stamp_of(one)) == (parent, child, time)
    place, turn = one.transform.translation, one.transform.rotation
    assert (place.x, place.y, place.z, turn.x, turn.y, turn.z, turn.w) == numbers
    assert bytes(STORE.serialize_cdr(message, TF)) == data


@settings(max_examples=30)
@given(NAMES, TIMES, st.tuples(*[NUMBERS] * 8), st.tuples(*[st.floats(0, 1, width=32)] * 4))
def test_arrows(
    frame: str, time: int, numbers: tuple[float, ...], colours: tuple[float, ...]
) -> None:
    template = ENCODING.arrow("front_left", frame, ArrowLook(0.04, 0.5))
    values = dict(zip((*POSE, "length", *"rgba"), (*numbers, *colours), strict=True))
    data = stamped(template, time, **values)
    message: Any = STORE.deserialize_cdr(data, MARKER)
    assert (message.header.frame_id, stamp_of(message)) == (frame, time)
    assert (message.type, message.action, message.ns, message.id) == (0, 0, "dogbot", 0)
    pose = message.pose
    assert (pose.position.x, pose.position.y, pose.position.z) == numbers[:3]
    turn = pose.orientation
    assert (turn.x, turn.y, turn.z, turn.w) == numbers[3:7]
    assert (message.scale.x, message.scale.y, message.scale.z) == (numbers[7], 0.04, 0.04)
    colour = message.color
    assert (colour.r, colour.g, colour.b, colour.a) == colours
    assert (message.lifetime.sec, message.lifetime.nanosec) == (0, NS // 2)
    assert bytes(STORE.serialize_cdr(message, MARKER)) == data


def test_removals() -> None:
    data = stamped(ENCODING.removal("front_left", "world"), 3 * NS + 7)
    message: Any = STORE.deserialize_cdr(data, MARKER)
    assert (message.action, message.header.frame_id, stamp_of(message)) == (2, "world", 3 * NS + 7)


@pytest.mark.parametrize(
    ("container", "copy"), [("mcap", False), ("mcap", True), ("rosbag2-sqlite3", True)]
)
def test_a_converted_log_is_read_by_others(tmp_path: Path, container: str, *, copy: bool) -> None:
    kind = "gazebo_msgs/msg/ContactsState"
    path = walks.write_walk(tmp_path, kind, container)
    options = ConvertOptions(
        TopicOptions(robot=str(walks.robot_file(tmp_path, kind))), encoding="ros2", copy=copy
    )
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
    assert sum(counts.values()) == sum(annotations.values()) + (5 * walks.SAMPLES if copy else 0)

    with AnyReader([target]) as log:
        seen: dict[str, int] = {}
        for connection, _, data in log.messages():
            log.deserialize(data, connection.msgtype)
            seen[connection.topic] = seen.get(connection.topic, 0) + 1
    assert seen == counts
