"""Annotations as Foxglove's protobuf messages."""

from collections.abc import Mapping
from typing import Final, cast

from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms
from foxglove_schemas_protobuf.LinePrimitive_pb2 import LinePrimitive
from foxglove_schemas_protobuf.Point3_pb2 import Point3
from foxglove_schemas_protobuf.SceneEntity_pb2 import SceneEntity
from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate
from foxglove_schemas_protobuf.Vector3_pb2 import Vector3
from google.protobuf.descriptor import FileDescriptor
from google.protobuf.descriptor_pb2 import (
    DescriptorProto,
    FieldDescriptorProto,
    FileDescriptorProto,
    FileDescriptorSet,
)
from google.protobuf.descriptor_pool import DescriptorPool
from google.protobuf.message import Message
from google.protobuf.message_factory import GetMessageClass
from google.protobuf.timestamp_pb2 import DESCRIPTOR as TIMESTAMP_FILE
from google.protobuf.timestamp_pb2 import Timestamp

from dogbot_logtool.writer.encodings.encoding import (
    FOOTFALL_LOOK,
    HEAD_TO_SHAFT,
    LOAD_FIELDS,
    PRESSURE_LOOK,
    PROJECTION_LOOK,
    ArrowStyle,
    BallLook,
    MessageType,
    SupportShape,
    SupportStyle,
    support_points,
)
from dogbot_logtool.writer.template import Kind, Number, Template, learn

_STAMP: Final = {"stamp.sec": Kind.VARINT, "stamp.nanosec": Kind.VARINT}
_POSE: Final = dict.fromkeys(("x", "y", "z", "qx", "qy", "qz", "qw"), Kind.FLOAT64)
_COLOUR: Final = dict.fromkeys("rgba", Kind.FLOAT64)
_ARROW: Final = dict.fromkeys(("shaft", "head", "r", "g", "b", "a"), Kind.FLOAT64)


def _descriptor_set(file: FileDescriptor) -> bytes:
    """Serialise a file's descriptor with all that it depends on, dependencies first."""
    files: dict[str, FileDescriptor] = {}

    def collect(one: FileDescriptor) -> None:
        if one.name not in files:
            for dependency in one.dependencies:
                collect(dependency)
            files[one.name] = one

    collect(file)
    collected = FileDescriptorSet()
    for one in files.values():
        one.CopyToProto(collected.file.add())
    return collected.SerializeToString(deterministic=True)


def _message_type(kind: type[Message]) -> MessageType:
    schema = _descriptor_set(cast("FileDescriptor", kind.DESCRIPTOR.file))
    return MessageType(kind.DESCRIPTOR.full_name, "protobuf", schema, "protobuf")


def _load_class() -> type[Message]:
    """Build the load message: a time, whether the foot touches, and its load.

    `in_contact` has presence, so that false is written out like true.
    """
    message = DescriptorProto(name="Load")
    field = FieldDescriptorProto
    message.field.add(
        name="timestamp",
        number=1,
        type=field.TYPE_MESSAGE,
        type_name=".google.protobuf.Timestamp",
        label=field.LABEL_OPTIONAL,
    )
    message.field.add(
        name="in_contact",
        number=2,
        type=field.TYPE_BOOL,
        label=field.LABEL_OPTIONAL,
        proto3_optional=True,
        oneof_index=0,
    )
    for number, name in ((3, "force"), (4, "force_bw")):
        message.field.add(
            name=name, number=number, type=field.TYPE_DOUBLE, label=field.LABEL_OPTIONAL
        )
    message.oneof_decl.add(name="_in_contact")
    file = FileDescriptorProto(
        name="dogbot_logtool/Load.proto",
        package="dogbot_logtool",
        syntax="proto3",
        dependency=[TIMESTAMP_FILE.name],
        message_type=[message],
    )
    pool = DescriptorPool()
    pool.AddSerializedFile(TIMESTAMP_FILE.serialized_pb)
    pool.AddSerializedFile(file.SerializeToString())
    return GetMessageClass(pool.FindMessageTypeByName("dogbot_logtool.Load"))


def _set_time(stamp: Timestamp, values: Mapping[str, Number]) -> None:
    stamp.seconds = int(values["stamp.sec"])
    stamp.nanos = int(values["stamp.nanosec"])


class FoxgloveEncoding:
    """FrameTransforms, SceneUpdates and a load message of our own."""

    def __init__(self) -> None:
        self._load_class = _load_class()
        self.transform_type = _message_type(FrameTransforms)
        self.arrow_type = _message_type(SceneUpdate)
        self.load_type = _message_type(self._load_class)
        self.support_type = self.arrow_type

    def transform(self, parent: str, child: str) -> Template:
        """See `Encoding.transform`."""

        def serialise(values: Mapping[str, Number]) -> bytes:
            message = FrameTransforms()
            one = message.transforms.add(parent_frame_id=parent, child_frame_id=child)
            _set_time(one.timestamp, values)
            for axis in "xyz":
                setattr(one.translation, axis, values[axis])
            for axis in "xyzw":
                setattr(one.rotation, axis, values[f"q{axis}"])
            return message.SerializeToString(deterministic=True)

        return learn(serialise, _STAMP | _POSE)

    def arrow(self, foot: str, frame: str, style: ArrowStyle) -> Template:
        """See `Encoding.arrow`."""

        def serialise(values: Mapping[str, Number]) -> bytes:
            message = SceneUpdate()
            entity = message.entities.add(id=foot, frame_id=frame)
            _set_time(entity.timestamp, values)
            entity.lifetime.FromNanoseconds(round(style.lifetime_s * 1e9))
            arrow = entity.arrows.add(
                shaft_length=values["shaft"],
                shaft_diameter=style.shaft_diameter_m,
                head_length=values["head"],
                head_diameter=HEAD_TO_SHAFT * style.shaft_diameter_m,
            )
            for axis in "xyz":
                setattr(arrow.pose.position, axis, values[axis])
            for axis in "xyzw":
                setattr(arrow.pose.orientation, axis, values[f"q{axis}"])
            for part in "rgba":
                setattr(arrow.color, part, values[part])
            return message.SerializeToString(deterministic=True)

        return learn(serialise, _STAMP | _POSE | _ARROW)

    def removal(self, foot: str, frame: str) -> Template:
        """See `Encoding.removal`; an entity is removed by its id, in whatever frame it is."""
        del frame

        def serialise(values: Mapping[str, Number]) -> bytes:
            message = SceneUpdate()
            deletion = message.deletions.add(id=foot)
            _set_time(deletion.timestamp, values)
            return message.SerializeToString(deterministic=True)

        return learn(serialise, _STAMP)

    def load(self) -> Template:
        """See `Encoding.load`."""

        def serialise(values: Mapping[str, Number]) -> bytes:
            message = self._load_class(**{name: values[name] for name in LOAD_FIELDS})
            _set_time(message.timestamp, values)  # type: ignore[attr-defined]
            return message.SerializeToString(deterministic=True)

        return learn(serialise, _STAMP | LOAD_FIELDS)

    def support(self, shape: SupportShape, frame: str, style: SupportStyle) -> Template:
        """See `Encoding.support`; one entity holds it all, so that each replaces the last."""
        message = SceneUpdate()
        entity = message.entities.add(id="support", frame_id=frame)
        entity.lifetime.FromNanoseconds(round(style.lifetime_s * 1e9))
        points = support_points(shape)
        places: dict[str, Point3 | Vector3] = {}
        line = LinePrimitive()
        if points.line:
            line = entity.lines.add(type=LinePrimitive.LINE_STRIP, thickness=style.line_m)
            # All zeros are no orientation.
            line.pose.orientation.w = 1.0
            places |= {name: line.points.add() for name in points.line}
        for names, look in (
            (points.pressure, PRESSURE_LOOK),
            (points.projection, PROJECTION_LOOK),
            (points.footfalls, FOOTFALL_LOOK),
        ):
            places |= {name: _add_ball(entity, look, style.mark_m) for name in names}

        def serialise(values: Mapping[str, Number]) -> bytes:
            _set_time(entity.timestamp, values)
            for name, place in places.items():
                place.x, place.y, place.z = (values[f"{name}.{axis}"] for axis in "xyz")
            if points.line:
                colour = line.color
                colour.r, colour.g, colour.b, colour.a = (values[part] for part in "rgba")
            return message.SerializeToString(deterministic=True)

        colour = _COLOUR if points.line else {}
        return learn(serialise, {**_STAMP, **colour, **points.fields})


def _add_ball(entity: SceneEntity, look: BallLook, mark_m: float) -> Vector3:
    """Add a sphere; return its place."""
    ball = entity.spheres.add()
    ball.pose.orientation.w = 1.0
    ball.size.x = ball.size.y = look.width * mark_m
    ball.size.z = look.height * mark_m
    ball.color.r, ball.color.g, ball.color.b, ball.color.a = look.colour
    return ball.pose.position
