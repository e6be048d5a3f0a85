"""Foxglove messages that are stamped out equal those that are built one by one."""

from typing import Any

import numpy as np
import pytest
from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms
from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate
from google.protobuf.descriptor_pb2 import FileDescriptorSet
from hypothesis import given
from hypothesis import strategies as st
from mcap import records
from mcap_protobuf.decoder import DecoderFactory

from dogbot_logtool.writer.encodings.encoding import ArrowLook, MessageType
from dogbot_logtool.writer.encodings.foxglove import FoxgloveEncoding

NS = 1_000_000_000
ENCODING = FoxgloveEncoding()
TYPES = (ENCODING.transform_type, ENCODING.arrow_type, ENCODING.load_type)
POSE = ("x", "y", "z", "qx", "qy", "qz", "qw")
ARROW = (*POSE, "shaft", "head", "r", "g", "b", "a")
TIME = st.integers(-(2**63), 2**63 - 1)


def rows(width: int) -> st.SearchStrategy[list[tuple[int, tuple[float, ...]]]]:
    numbers = st.tuples(*[st.floats()] * width)
    return st.lists(st.tuples(TIME, numbers), min_size=1, max_size=10)


def stamp(
    template: Any, names: tuple[str, ...], values: list[tuple[int, tuple[float, ...]]]
) -> Any:
    copies = template.copies(len(values))
    template.write_time(copies, "stamp", np.array([time for time, _ in values], np.int64))
    for index, name in enumerate(names):
        copies[name] = [numbers[index] for _, numbers in values]
    return [copy.tobytes() for copy in copies]


def set_pose(place: Any, turn: Any, numbers: tuple[float, ...]) -> None:
    place.x, place.y, place.z = numbers[:3]
    turn.x, turn.y, turn.z, turn.w = numbers[3:7]


def set_time(target: Any, time: int) -> None:
    target.seconds, target.nanos = divmod(time, NS)


def same(told: Any, wanted: Any) -> bool:
    """Compare messages by their bytes in the library's own form: NaN equals NaN there."""
    return bool(
        told.SerializeToString(deterministic=True) == wanted.SerializeToString(deterministic=True)
    )


@given(rows(len(POSE)))
def test_transforms(values: list[tuple[int, tuple[float, ...]]]) -> None:
    template = ENCODING.transform("world", "base_link")
    for data, (time, numbers) in zip(stamp(template, POSE, values), values, strict=True):
        wanted = FrameTransforms()
        one = wanted.transforms.add(parent_frame_id="world", child_frame_id="base_link")
        set_time(one.timestamp, time)
        set_pose(one.translation, one.rotation, numbers)
        assert same(FrameTransforms.FromString(data), wanted)


@given(rows(len(ARROW)))
def test_arrows(values: list[tuple[int, tuple[float, ...]]]) -> None:
    template = ENCODING.arrow("front_left", "world", ArrowLook(0.04, 0.5))
    for data, (time, numbers) in zip(stamp(template, ARROW, values), values, strict=True):
        wanted = SceneUpdate()
        entity = wanted.entities.add(id="front_left", frame_id="world")
        set_time(entity.timestamp, time)
        entity.lifetime.FromMilliseconds(500)
        arrow = entity.arrows.add(
            shaft_length=numbers[7],
            shaft_diameter=0.04,
            head_length=numbers[8],
            head_diameter=0.08,
        )
        set_pose(arrow.pose.position, arrow.pose.orientation, numbers)
        colour = arrow.color
        colour.r, colour.g, colour.b, colour.a = numbers[9:]
        assert same(SceneUpdate.FromString(data), wanted)


@given(rows(0))
def test_removals(values: list[tuple[int, tuple[float, ...]]]) -> None:
    template = ENCODING.removal("back_left", "world")
    for data, (time, _) in zip(stamp(template, (), values), values, strict=True):
        wanted = SceneUpdate()
        set_time(wanted.deletions.add(id="back_left").timestamp, time)
        assert same(SceneUpdate.FromString(data), wanted)
        assert SceneUpdate.FromString(data).deletions[0].type == 0


@given(st.lists(st.tuples(TIME, st.booleans(), st.floats(), st.floats()), min_size=1, max_size=10))
def test_loads(values: list[tuple[int, bool, float, float]]) -> None:
    template = ENCODING.load("stance")
    copies = template.copies(len(values))
    template.write_time(copies, "stamp", np.array([time for time, *_ in values], np.int64))
    copies["in_contact"] = [touches for _, touches, _, _ in values]
    copies["force"] = [force for *_, force, _ in values]
    copies["force_bw"] = [share for *_, share in values]
    decode = decoder(ENCODING.load_type)
    for copy, (time, touches, force, share) in zip(copies, values, strict=True):
        told = decode(copy.tobytes())
        assert told.timestamp.seconds * NS + told.timestamp.nanos == time
        # A foot in the air says so; it does not merely leave the field out.
        assert told.HasField("in_contact")
        assert told.in_contact is touches
        np.testing.assert_equal((told.force, told.force_bw), (force, share))


def decoder(kind: MessageType) -> Any:
    """Return the mcap library's decoder: all it knows is what stands in the file."""
    schema = records.Schema(id=1, data=kind.schema, encoding=kind.schema_encoding, name=kind.name)
    found = DecoderFactory().decoder_for(kind.message_encoding, schema)
    assert found is not None
    return found


@pytest.mark.parametrize("kind", TYPES, ids=lambda kind: kind.name)
def test_schemas_are_complete(kind: MessageType) -> None:
    assert (kind.schema_encoding, kind.message_encoding) == ("protobuf", "protobuf")
    files = FileDescriptorSet.FromString(kind.schema).file
    seen: set[str] = set()
    for file in files:
        assert set(file.dependency) <= seen, "a dependency must stand before what needs it"
        seen.add(file.name)
    assert len(seen) == len(files)
    names = {f"{file.package}.{message.name}" for file in files for message in file.message_type}
    assert kind.name in names


def test_names() -> None:
    assert [kind.name for kind in TYPES] == [
        "foxglove.FrameTransforms",
        "foxglove.SceneUpdate",
        "dogbot_logtool.Load",
    ]


@pytest.mark.parametrize("lifetime_s", [0.0, 0.5, 2.25])
def test_lifetime_and_diameter_of_a_style(lifetime_s: float) -> None:
    data = ENCODING.arrow("paw", "map", ArrowLook(0.1, lifetime_s)).message
    (entity,) = SceneUpdate.FromString(data).entities
    assert (entity.id, entity.frame_id) == ("paw", "map")
    assert entity.lifetime.ToNanoseconds() == round(lifetime_s * NS)
    assert (entity.arrows[0].shaft_diameter, entity.arrows[0].head_diameter) == (0.1, 0.2)


def test_names_of_any_letters() -> None:
    template = ENCODING.transform("Welt/ß", "基")
    (one,) = FrameTransforms.FromString(template.message).transforms
    assert (one.parent_frame_id, one.child_frame_id) == ("Welt/ß", "基")


def test_two_encodings_do_not_meddle() -> None:
    """Each builds its own load type; neither may spoil the other's."""
    other = FoxgloveEncoding()
    assert other.load_type == ENCODING.load_type
    assert other.load("stance").message == ENCODING.load("stance").message
