"""The robot description as a message."""

from io import BytesIO
from typing import Any

import pytest
from mcap import records
from mcap.data_stream import ReadDataStream
from rosbags.typesys import Stores, get_typestore

from dogbot_logtool.writer.annotations import description_type
from dogbot_logtool.writer.encodings.encoding import Encoding
from tests.writer.annotated import ENCODINGS, declared


@pytest.mark.parametrize("encoding", ENCODINGS, ids=lambda one: type(one).__name__)
@pytest.mark.parametrize("profile", ["ros1", "ros2", ""])
def test_a_robot_description_is_a_string_of_ros(encoding: Encoding, profile: str) -> None:
    annotations = declared(encoding, with_tf=False, description=description_type(profile))
    urdf = '<robot name="d\u00f6g"/>'
    written = annotations.robot_description(urdf, 42).data.tobytes()
    stream = ReadDataStream(BytesIO(written))
    assert stream.read1() == 5
    message = records.Message.read(stream, stream.read8())
    (channel,) = [c for c in annotations.added.channels if c.topic == "/robot_description"]
    assert (message.channel_id, message.log_time) == (channel.id, 42)
    assert channel.topic == "/robot_description"
    store = get_typestore(Stores.ROS1_NOETIC if profile == "ros1" else Stores.ROS2_HUMBLE)
    read = store.deserialize_ros1 if profile == "ros1" else store.deserialize_cdr
    decoded: Any = read(message.data, "std_msgs/msg/String")
    assert decoded.data == urdf
    assert channel.message_encoding == ("ros1" if profile == "ros1" else "cdr")
