"""Messages of all encodings, as the official libraries and other readers take them."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from google.protobuf.descriptor_pb2 import FileDescriptorSet
from mcap import records
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory as ProtobufDecoders
from mcap_ros1.decoder import DecoderFactory as Ros1Decoders
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader

from dogbot_logtool.commands.convert import convert
from dogbot_logtool.options import ConvertOptions
from dogbot_logtool.writer import drawing
from dogbot_logtool.writer.drawing import ArrowLook, SupportLook, SupportShape
from dogbot_logtool.writer.encodings.encoding import Encoding, MessageType
from dogbot_logtool.writer.template import MESSAGE_HEAD, Template
from tests.oracles import walks
from tests.writer.annotated import ENCODINGS

NS = 1_000_000_000
TIME = 1_700_000_000 * NS + 7
LOOK = SupportLook(0.02, 0.04, 0.5)
DECODERS: tuple[Any, ...] = (ProtobufDecoders, Ros1Decoders, DecoderFactory)
each_encoding = pytest.mark.parametrize("encoding", ENCODINGS, ids=lambda one: type(one).__name__)


def decoder(kind: MessageType) -> Any:
    """Return the mcap library's decoder: all it knows is what stands in the file."""
    schema = records.Schema(id=1, data=kind.schema, encoding=kind.schema_encoding, name=kind.name)
    found = (each().decoder_for(kind.message_encoding, schema) for each in DECODERS)
    return next(decode for decode in found if decode is not None)


def decoded(
    encoding: Encoding, template: Template, kind: MessageType
) -> tuple[Any, dict[str, float]]:
    """Return a message with another number in every slot, and these numbers."""
    names = dict.fromkeys(template.slots.values())
    numbers = {name: count / 64 for count, name in enumerate(names, 1)}
    columns = {
        **{name: np.array([number]) for name, number in numbers.items()},
        **encoding.stamp_columns(np.array([TIME])),
        "in_contact": np.array([False]),
        "text": np.array([b" 123 N"]),
    }
    records = template.records(0, np.array([TIME]), columns, np.array([0]))
    return decoder(kind)(records[0].tobytes()[MESSAGE_HEAD.itemsize :]), numbers


def xyz(vector: Any) -> tuple[float, ...]:
    return vector.x, vector.y, vector.z


def rgba(colour: Any) -> tuple[float, ...]:
    return colour.r, colour.g, colour.b, colour.a


def named(numbers: dict[str, float], names: Iterable[str], prefix: str = "") -> tuple[float, ...]:
    return tuple(numbers[prefix + name] for name in names)


def time_of(stamp: Any) -> int:
    if hasattr(stamp, "seconds"):
        return int(stamp.seconds * NS + stamp.nanos)
    seconds = getattr(stamp, "secs", None)
    if seconds is not None:
        return int(seconds * NS + stamp.nsecs)
    return int(stamp.sec * NS + stamp.nanosec)


@each_encoding
def test_transforms(encoding: Encoding) -> None:
    template = encoding.transforms([("world", "base"), ("base", "leg")])
    message, numbers = decoded(encoding, template, encoding.transform_type)
    assert len(message.transforms) == 2
    for index, one in enumerate(message.transforms):
        is_ros = hasattr(one, "header")
        parts = one.transform if is_ros else one
        parent = one.header.frame_id if is_ros else one.parent_frame_id
        assert (parent, one.child_frame_id) == (("world", "base"), ("base", "leg"))[index]
        assert time_of(one.header.stamp if is_ros else one.timestamp) == TIME
        assert xyz(parts.translation) == named(numbers, "xyz", f"{index}.")
        turn = (*xyz(parts.rotation), parts.rotation.w)
        assert turn == named(numbers, "xyzw", f"{index}.q")


@each_encoding
def test_arrows(encoding: Encoding) -> None:
    arrow = encoding.drawing(drawing.arrow("left", "world", ArrowLook(0.04, 0.5)))
    message, numbers = decoded(encoding, arrow, encoding.arrow_type)
    is_ros = hasattr(message, "header")
    one = message if is_ros else message.entities[0].arrows[0]
    assert xyz(one.pose.position) == named(numbers, "xyz")
    assert rgba(one.color) == named(numbers, "rgba")
    if is_ros:
        assert xyz(one.scale) == (numbers["length"], 0.04, 0.04)
        assert (one.type, one.action, one.header.frame_id) == (0, 0, "world")
    else:
        assert (one.shaft_length, one.head_length) == (numbers["shaft"], numbers["head"])
        assert (one.shaft_diameter, one.head_diameter) == (0.04, 0.08)
        assert (message.entities[0].id, message.entities[0].frame_id) == ("left", "world")


@each_encoding
def test_removals(encoding: Encoding) -> None:
    label = drawing.label("left", "world", "L")
    message, _ = decoded(encoding, encoding.removal(label), encoding.arrow_type)
    if hasattr(message, "header"):
        shown, _ = decoded(encoding, encoding.drawing(label), encoding.arrow_type)
        assert (message.action, time_of(message.header.stamp)) == (2, TIME)
        # Viewers know a marker by its namespace and id.
        assert (message.ns, message.id) == (shown.ns, shown.id)
    else:
        (deletion,) = message.deletions
        assert (deletion.id, time_of(deletion.timestamp)) == ("left", TIME)


@each_encoding
def test_labels(encoding: Encoding) -> None:
    label = encoding.drawing(drawing.label("left", "world", "L"))
    message, numbers = decoded(encoding, label, encoding.arrow_type)
    one = message if hasattr(message, "header") else message.entities[0].texts[0]
    assert one.text == "L  123 N"
    assert xyz(one.pose.position) == named(numbers, "xyz")


@each_encoding
@pytest.mark.parametrize("line", [0, 3])
@pytest.mark.parametrize("balls", [False, True])
def test_support(encoding: Encoding, line: int, *, balls: bool) -> None:
    """All that there is, or some of it: markers are deleted, an entity does without."""
    shape = SupportShape(line, balls, balls, 2 * balls)
    template = encoding.drawing(drawing.support(shape, "world", LOOK))
    message, numbers = decoded(encoding, template, encoding.support_type)
    found: list[tuple[float, ...]] = []
    if hasattr(message, "markers"):
        assert [marker.action for marker in message.markers] == [2 * (not line)] + 3 * [
            2 * (not balls)
        ]
        assert [marker.id for marker in message.markers] == [0, 1, 2, 3]
        assert {time_of(marker.header.stamp) for marker in message.markers} == {TIME}
        found = [xyz(point) for marker in message.markers for point in marker.points]
        tints = [rgba(colour)[:3] for colour in message.markers[3].colors]
    else:
        (entity,) = message.entities
        found = [xyz(point) for each in entity.lines for point in each.points]
        found += [xyz(ball.pose.position) for ball in entity.spheres]
        tints = [rgba(ball.color)[:3] for ball in entity.spheres[2:]]
        assert time_of(entity.timestamp) == TIME
    names = [f"{name}{row}" for name, count in shape._asdict().items() for row in range(count)]
    assert found == [named(numbers, "xyz", f"{name}.") for name in names]
    assert tints == [named(numbers, "rgb", f"touchdown{row}.") for row in range(2 * balls)]


@each_encoding
def test_legs(encoding: Encoding) -> None:
    template = encoding.drawing(drawing.legs((1, 3), "world", LOOK))
    message, numbers = decoded(encoding, template, encoding.arrow_type)
    one = message if hasattr(message, "header") else message.entities[0].lines[0]
    names = ("hip1", "foot1", "hip3", "foot3")
    assert [xyz(each) for each in one.points] == [named(numbers, "xyz", f"{n}.") for n in names]
    assert len(one.colors) == 4


@each_encoding
def test_loads(encoding: Encoding) -> None:
    message, numbers = decoded(encoding, encoding.load("swing"), encoding.load_type)
    assert message.state == "swing"
    # A foot in the air says so; it does not merely leave the field out.
    assert message.in_contact is False
    assert not hasattr(message, "HasField") or message.HasField("in_contact")
    assert (message.force, message.force_bw) == named(numbers, ["force", "force_bw"])
    assert time_of(getattr(message, "timestamp", None) or message.stamp) == TIME


def test_schemas_of_protobuf_are_complete() -> None:
    foxglove = ENCODINGS[0]
    for kind in (foxglove.transform_type, foxglove.arrow_type, foxglove.load_type):
        files = FileDescriptorSet.FromString(kind.schema).file
        seen: set[str] = set()
        for file in files:
            assert set(file.dependency) <= seen, "a dependency must stand before what needs it"
            seen.add(file.name)
        names = {f"{file.package}.{each.name}" for file in files for each in file.message_type}
        assert kind.name in names


@pytest.mark.parametrize(
    ("container", "copy"), [("mcap", False), ("mcap", True), ("rosbag2-sqlite3", True)]
)
def test_a_converted_log_is_read_by_others(tmp_path: Path, container: str, *, copy: bool) -> None:
    kind = "gazebo_msgs/msg/ContactsState"
    path = walks.write_walk(tmp_path, kind, container)
    options = ConvertOptions(
        robot=str(walks.robot_file(tmp_path, kind)), encoding="ros2", copy=copy
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
