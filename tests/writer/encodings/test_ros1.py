"""ROS 1 messages that are stamped out equal those that rosbags serialises one by one."""

from functools import cache
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap import records
from mcap_ros1.decoder import DecoderFactory
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from dogbot_logtool.writer.encodings.encoding import ArrowLook, MessageType
from dogbot_logtool.writer.encodings.ros1 import Ros1Encoding

NS = 1_000_000_000
ENCODING = Ros1Encoding()
TYPES = (ENCODING.transform_type, ENCODING.arrow_type, ENCODING.load_type)
POSE = ("x", "y", "z", "qx", "qy", "qz", "qw")
TF, MARKER = "tf2_msgs/msg/TFMessage", "visualization_msgs/msg/Marker"
TIME = st.integers(0, 2**31 * NS - 1)
"""ROS 1 counts seconds without a sign, rosbags with one."""
STORE = get_typestore(Stores.ROS1_NOETIC)
STORE.register(get_types_from_msg("geometry_msgs/TransformStamped[] transforms", TF))
TRANSFORM = ENCODING.transform("world", "base_link")
ARROW = ENCODING.arrow("front_left", "world", ArrowLook(0.04, 0.5))
CLASSIC = ENCODING.arrow("front_left", "map", ArrowLook(0.1, 0.0))
REMOVAL = ENCODING.removal("back_left", "world")
LOAD = ENCODING.load("stance")
Rows = list[tuple[int, tuple[float, ...], tuple[float, ...]]]


def rows(wide: int, narrow: int) -> st.SearchStrategy[Rows]:
    """Draw times, numbers of eight bytes and numbers of four."""
    numbers = st.tuples(*[st.floats()] * wide)
    colours = st.tuples(*[st.floats(width=32)] * narrow)
    return st.lists(st.tuples(TIME, numbers, colours), min_size=1, max_size=5)


def make(name: str, *args: Any, **fields: Any) -> Any:
    return STORE.types[name](*args, **fields)


def header(time: int, frame: str) -> Any:
    stamp = make("builtin_interfaces/msg/Time", *divmod(time, NS))
    return make("std_msgs/msg/Header", 0, stamp, frame)


def stamp(template: Any, names: tuple[str, ...], narrow: str, values: Rows) -> list[bytes]:
    copies = template.copies(len(values))
    template.write_time(copies, "stamp", np.array([time for time, *_ in values], np.int64))
    for index, name in enumerate(names):
        copies[name] = [numbers[index] for _, numbers, _ in values]
    for index, name in enumerate(narrow):
        copies[name] = np.array([colours[index] for *_, colours in values], np.float32)
    return [copy.tobytes() for copy in copies]


@settings(max_examples=30)
@given(rows(7, 0))
def test_transforms(values: Rows) -> None:
    template = TRANSFORM
    for data, (time, numbers, _) in zip(stamp(template, POSE, "", values), values, strict=True):
        transform = make(
            "geometry_msgs/msg/Transform",
            make("geometry_msgs/msg/Vector3", *numbers[:3]),
            make("geometry_msgs/msg/Quaternion", *numbers[3:]),
        )
        one = make(
            "geometry_msgs/msg/TransformStamped", header(time, "world"), "base_link", transform
        )
        assert data == bytes(STORE.serialize_ros1(make(TF, [one]), TF))


@settings(max_examples=30)
@given(rows(8, 4))
def test_arrows(values: Rows) -> None:
    template = ARROW
    names = (*POSE, "length")
    decode = decoder(ENCODING.arrow_type)
    for data, (time, numbers, colours) in zip(
        stamp(template, names, "rgba", values), values, strict=True
    ):
        told = decode(data)
        assert (told.header.frame_id, told.header.seq) == ("world", 0)
        assert told.header.stamp.secs * NS + told.header.stamp.nsecs == time
        assert (told.ns, told.id, told.type, told.action) == ("dogbot", 0, 0, 0)
        place, turn = told.pose.position, told.pose.orientation
        np.testing.assert_equal(
            (place.x, place.y, place.z, turn.x, turn.y, turn.z, turn.w, told.scale.x), numbers
        )
        assert (told.scale.y, told.scale.z) == (0.04, 0.04)
        np.testing.assert_equal((told.color.r, told.color.g, told.color.b, told.color.a), colours)
        assert (told.lifetime.secs, told.lifetime.nsecs) == (0, NS // 2)
        assert (told.points, told.colors, told.text, told.mesh_resource) == ([], [], "", "")
        assert (told.frame_locked, told.mesh_use_embedded_materials) == (False, False)


@settings(max_examples=30)
@given(rows(8, 4))
def test_arrows_have_rosbags_bytes(values: Rows) -> None:
    template = CLASSIC
    names = (*POSE, "length")
    for data, (time, numbers, colours) in zip(
        stamp(template, names, "rgba", values), values, strict=True
    ):
        pose = make(
            "geometry_msgs/msg/Pose",
            make("geometry_msgs/msg/Point", *numbers[:3]),
            make("geometry_msgs/msg/Quaternion", *numbers[3:7]),
        )
        marker = make(
            MARKER,
            header=header(time, "map"),
            ns="dogbot",
            id=0,
            type=0,
            action=0,
            pose=pose,
            scale=make("geometry_msgs/msg/Vector3", numbers[7], 0.1, 0.1),
            color=make("std_msgs/msg/ColorRGBA", *colours),
            lifetime=make("builtin_interfaces/msg/Duration", 0, 0),
            frame_locked=False,
            points=[],
            colors=[],
            text="",
            mesh_resource="",
            mesh_use_embedded_materials=False,
        )
        assert data == bytes(STORE.serialize_ros1(marker, MARKER))


@settings(max_examples=30)
@given(rows(0, 0))
def test_removals(values: Rows) -> None:
    template = REMOVAL
    decode = decoder(ENCODING.arrow_type)
    for data, (time, _, _) in zip(stamp(template, (), "", values), values, strict=True):
        told = decode(data)
        assert (told.ns, told.id, told.type, told.action) == ("dogbot", 0, 0, 2)
        assert told.header.stamp.secs * NS + told.header.stamp.nsecs == time
        assert told.pose.orientation.w == 1.0


@settings(max_examples=30)
@given(st.lists(st.tuples(TIME, st.booleans(), st.floats(), st.floats()), min_size=1, max_size=5))
def test_loads(values: list[tuple[int, bool, float, float]]) -> None:
    template = LOAD
    copies = template.copies(len(values))
    template.write_time(copies, "stamp", np.array([time for time, *_ in values], np.int64))
    copies["in_contact"] = [touches for _, touches, _, _ in values]
    copies["force"] = [force for *_, force, _ in values]
    copies["force_bw"] = [share for *_, share in values]
    decode = decoder(ENCODING.load_type)
    for copy, (time, touches, force, share) in zip(copies, values, strict=True):
        told = decode(copy.tobytes())
        assert told.stamp.secs * NS + told.stamp.nsecs == time
        assert bool(told.in_contact) is touches
        np.testing.assert_equal((told.force, told.force_bw), (force, share))


@cache
def decoder(kind: MessageType) -> Any:
    """Return the mcap library's decoder: all it knows is what stands in the file."""
    schema = records.Schema(id=1, data=kind.schema, encoding=kind.schema_encoding, name=kind.name)
    found = DecoderFactory().decoder_for(kind.message_encoding, schema)
    assert found is not None
    return found


@pytest.mark.parametrize("kind", TYPES, ids=lambda kind: kind.name)
def test_types_are_named_as_ros1_names_them(kind: MessageType) -> None:
    assert (kind.schema_encoding, kind.message_encoding) == ("ros1msg", "ros1")
    assert kind.name in {"tf2_msgs/TFMessage", "visualization_msgs/Marker", "dogbot_logtool/Load"}


@pytest.mark.parametrize("kind", TYPES, ids=lambda kind: kind.name)
def test_definitions_can_be_parsed_anew(kind: MessageType) -> None:
    store = get_typestore(Stores.EMPTY)
    name = kind.name.replace("/", "/msg/")
    store.register(get_types_from_msg(kind.schema.decode(), name))
    assert name in store.fielddefs


def test_standard_types_have_ros_checksums() -> None:
    """As `rosmsg md5` gives them."""
    assert STORE.generate_msgdef(MARKER)[1] == "4048c9de2a16f4ae8e0538085ebf1b97"
    assert STORE.generate_msgdef(TF)[1] == "94810edda583a504dfda3829e70d7eec"
    assert ENCODING.arrow_type.schema == STORE.generate_msgdef(MARKER)[0].encode()
    assert ENCODING.transform_type.schema == STORE.generate_msgdef(TF)[0].encode()
