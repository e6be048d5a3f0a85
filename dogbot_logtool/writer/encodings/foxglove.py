"""Annotations as Foxglove's protobuf messages."""

from collections.abc import Mapping, Sequence
from typing import Any, Final, Self, cast

from foxglove_schemas_protobuf.Color_pb2 import Color
from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms
from foxglove_schemas_protobuf.LinePrimitive_pb2 import LinePrimitive
from foxglove_schemas_protobuf.Log_pb2 import Log
from foxglove_schemas_protobuf.Point3_pb2 import Point3
from foxglove_schemas_protobuf.SceneEntity_pb2 import SceneEntity
from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate
from foxglove_schemas_protobuf.SpherePrimitive_pb2 import SpherePrimitive
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

from dogbot_logtool.core.events.event import EventMessage, GaitState
from dogbot_logtool.writer.encodings.encoding import (
    EVENT_SOURCE,
    GAIT_NUMBERS,
    HEAD_TO_SHAFT,
    LABEL_COLOUR,
    LABEL_HEIGHT_M,
    LEG_COLOUR,
    LOAD_FIELDS,
    PRESSURE_LOOK,
    PROJECTION_LOOK,
    TOUCHDOWN_LOOK,
    ArrowLook,
    BallLook,
    MessageType,
    Rgb,
    SupportLook,
    SupportShape,
    leg_fields,
    leg_points,
    numbered,
    support_points,
)
from dogbot_logtool.writer.template import Kind, Number, Template, learn

_STAMP: Final = {"stamp.sec": Kind.VARINT, "stamp.nanosec": Kind.VARINT}
_POSE: Final = dict.fromkeys(("x", "y", "z", "qx", "qy", "qz", "qw"), Kind.FLOAT64)
_POINT: Final = dict.fromkeys("xyz", Kind.FLOAT64)
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
    """Build the load message: a time, whether the foot touches, its state, and its load.

    `in_contact` has presence, so that false is written out like true.
    """
    message, field = _stamped("Load"), FieldDescriptorProto
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
    message.field.add(name="state", number=5, type=field.TYPE_STRING, label=field.LABEL_OPTIONAL)
    message.oneof_decl.add(name="_in_contact")
    return _own_class(message)


def _gait_class() -> type[Message]:
    """Build the message of the gait: a time, its class and its figures."""
    message, field = _stamped("Gait"), FieldDescriptorProto
    message.field.add(name="gait", number=2, type=field.TYPE_STRING, label=field.LABEL_OPTIONAL)
    for number, name in enumerate(GAIT_NUMBERS, 3):
        message.field.add(
            name=name, number=number, type=field.TYPE_DOUBLE, label=field.LABEL_OPTIONAL
        )
    message.field.add(name="phases", number=5, type=field.TYPE_DOUBLE, label=field.LABEL_REPEATED)
    return _own_class(message)


def _stamped(name: str) -> DescriptorProto:
    """Return a message that has a time only."""
    message = DescriptorProto(name=name)
    message.field.add(
        name="timestamp",
        number=1,
        type=FieldDescriptorProto.TYPE_MESSAGE,
        type_name=".google.protobuf.Timestamp",
        label=FieldDescriptorProto.LABEL_OPTIONAL,
    )
    return message


def _own_class(message: DescriptorProto) -> type[Message]:
    """Build the class of a message that no library has."""
    file = FileDescriptorProto(
        name=f"dogbot_logtool/{message.name}.proto",
        package="dogbot_logtool",
        syntax="proto3",
        dependency=[TIMESTAMP_FILE.name],
        message_type=[message],
    )
    pool = DescriptorPool()
    pool.AddSerializedFile(TIMESTAMP_FILE.serialized_pb)
    pool.AddSerializedFile(file.SerializeToString())
    return GetMessageClass(pool.FindMessageTypeByName(f"dogbot_logtool.{message.name}"))


def _span_class() -> Any:  # noqa: ANN401 - older schemas have no such class
    """Return the class of events; None where the installed schemas are older than 0.4."""
    try:
        from foxglove_schemas_protobuf.Event_pb2 import Event  # noqa: PLC0415
    except ImportError:
        return None
    return Event


def _set_time(stamp: Timestamp, values: Mapping[str, Number], prefix: str = "") -> None:
    stamp.seconds = int(values[f"{prefix}stamp.sec"])
    stamp.nanos = int(values[f"{prefix}stamp.nanosec"])


def _add_transform(
    message: FrameTransforms,
    parent: str,
    child: str,
    values: Mapping[str, Number],
    prefix: str = "",
) -> None:
    one = message.transforms.add(parent_frame_id=parent, child_frame_id=child)
    _set_time(one.timestamp, values, prefix)
    _set_parts(one.translation, "xyz", values, prefix)
    _set_parts(one.rotation, "xyzw", values, f"{prefix}q")


def _set_parts(target: Message, parts: str, values: Mapping[str, Number], prefix: str = "") -> None:
    for part in parts:
        setattr(target, part, values[prefix + part])


class FoxgloveEncoding:
    """FrameTransforms, SceneUpdates and a load message of our own."""

    def __init__(self) -> None:
        self._load_class = _load_class()
        self.transform_type = _message_type(FrameTransforms)
        self.arrow_type = _message_type(SceneUpdate)
        self.load_type = _message_type(self._load_class)
        self.support_type = self.arrow_type
        self.event_type = _message_type(Log)
        self._gait_class = _gait_class()
        self.gait_type = _message_type(self._gait_class)
        self._span_class = _span_class()
        self.span_type: MessageType | None = (
            _message_type(self._span_class) if self._span_class else None
        )

    def __reduce__(self) -> "tuple[type[Self], tuple[()]]":
        """Be made anew in another process: classes of messages are made when it runs."""
        return type(self), ()

    def transform(self, parent: str, child: str) -> Template:
        """See `Encoding.transform`."""

        def serialise(values: Mapping[str, Number]) -> bytes:
            message = FrameTransforms()
            _add_transform(message, parent, child, values)
            return message.SerializeToString(deterministic=True)

        return learn(serialise, _STAMP | _POSE)

    def transforms(self, pairs: Sequence[tuple[str, str]]) -> Template:
        """See `Encoding.transforms`."""

        def serialise(values: Mapping[str, Number]) -> bytes:
            message = FrameTransforms()
            for index, (parent, child) in enumerate(pairs):
                _add_transform(message, parent, child, values, f"{index}.")
            return message.SerializeToString(deterministic=True)

        return learn(serialise, numbered(_STAMP | _POSE, len(pairs)))

    def arrow(self, foot: str, frame: str, style: ArrowLook) -> Template:
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

    def label(self, foot: str, frame: str, name: str, lifetime_s: float) -> Template:
        """See `Encoding.label`; its entity has another id than the arrow's."""
        message = SceneUpdate()
        entity = message.entities.add(id=foot, frame_id=frame)
        entity.lifetime.FromNanoseconds(round(lifetime_s * 1e9))
        label = entity.texts.add(billboard=True, font_size=LABEL_HEIGHT_M, scale_invariant=False)
        label.pose.orientation.w = 1.0
        label.color.r, label.color.g, label.color.b, label.color.a = LABEL_COLOUR

        def serialise(values: Mapping[str, Number]) -> bytes:
            _set_time(entity.timestamp, values)
            for axis in "xyz":
                setattr(label.pose.position, axis, values[axis])
            label.text = f"{name} {values['text']}"
            return message.SerializeToString(deterministic=True)

        return learn(serialise, _STAMP | _POINT | {"text": Kind.TEXT6})

    def load(self, state: str) -> Template:
        """See `Encoding.load`."""

        def serialise(values: Mapping[str, Number]) -> bytes:
            numbers: dict[str, Any] = {name: values[name] for name in LOAD_FIELDS}
            message = self._load_class(state=state, **numbers)
            _set_time(message.timestamp, values)  # type: ignore[attr-defined]
            return message.SerializeToString(deterministic=True)

        return learn(serialise, _STAMP | LOAD_FIELDS)

    def support(self, shape: SupportShape, frame: str, style: SupportLook) -> Template:
        """See `Encoding.support`; one entity holds it all, so that each replaces the last."""
        message = SceneUpdate()
        entity = message.entities.add(id="support", frame_id=frame)
        entity.lifetime.FromNanoseconds(round(style.lifetime_s * 1e9))
        points = support_points(shape)
        positions: dict[str, Point3 | Vector3] = {}
        colours: dict[str, Color] = {}
        line = LinePrimitive()
        if points.line:
            line = entity.lines.add(type=LinePrimitive.LINE_STRIP, thickness=style.line_m)
            # All zeros are no orientation.
            line.pose.orientation.w = 1.0
            positions |= {name: line.points.add() for name in points.line}
        for names, look in (
            (points.pressure, PRESSURE_LOOK),
            (points.projection, PROJECTION_LOOK),
            (points.touchdowns, TOUCHDOWN_LOOK),
        ):
            for name in names:
                ball = _add_ball(entity, look, style.mark_m)
                positions[name], colours[name] = ball.pose.position, ball.color

        def serialise(values: Mapping[str, Number]) -> bytes:
            _set_time(entity.timestamp, values)
            for name, position in positions.items():
                _set_parts(position, "xyz", values, f"{name}.")
            for name in points.touchdowns:
                _set_parts(colours[name], "rgb", values, f"{name}.")
            if points.line:
                _set_parts(line.color, "rgba", values)
            return message.SerializeToString(deterministic=True)

        colour = _COLOUR if points.line else {}
        return learn(
            serialise, {**_STAMP, **colour, **points.fields, **points.colours(Kind.FLOAT64)}
        )

    def legs(self, colours: Sequence[Rgb], frame: str, look: SupportLook) -> Template:
        """See `Encoding.legs`."""
        if not colours:
            return self.removal("legs", frame)
        message = SceneUpdate()
        entity = message.entities.add(id="legs", frame_id=frame)
        entity.lifetime.FromNanoseconds(round(look.lifetime_s * 1e9))
        lines = entity.lines.add(type=LinePrimitive.LINE_LIST, thickness=look.mark_m)
        lines.pose.orientation.w = 1.0
        points = {name: lines.points.add() for name in leg_points(len(colours))}
        for colour in colours:
            for red, green, blue in (LEG_COLOUR[:3], colour):
                lines.colors.add(r=red, g=green, b=blue, a=1.0)

        def serialise(values: Mapping[str, Number]) -> bytes:
            _set_time(entity.timestamp, values)
            for name, point in points.items():
                _set_parts(point, "xyz", values, f"{name}.")
            return message.SerializeToString(deterministic=True)

        return learn(serialise, {**_STAMP, **leg_fields(len(colours))})

    def event(self, event: EventMessage) -> bytes:
        """See `Encoding.event`."""
        message = Log(level=int(event.level), message=event.text, name=event.source)  # type: ignore[arg-type]
        message.file = EVENT_SOURCE
        message.timestamp.FromNanoseconds(event.time)
        return message.SerializeToString(deterministic=True)

    def span(self, event: EventMessage) -> bytes:
        """See `Encoding.span`."""
        message = self._span_class()
        message.start_time.FromNanoseconds(event.time)
        message.end_time.FromNanoseconds(event.end)
        for key, value in event.details.items():
            message.metadata.add(key=key, value=value)
        return bytes(message.SerializeToString(deterministic=True))

    def gait(self, state: GaitState) -> bytes:
        """See `Encoding.gait`."""
        numbers = {name: getattr(state, name) for name in GAIT_NUMBERS}
        message = self._gait_class(gait=state.gait, phases=state.phases, **numbers)
        message.timestamp.FromNanoseconds(state.time)  # type: ignore[attr-defined]
        return message.SerializeToString(deterministic=True)


def _add_ball(entity: SceneEntity, look: BallLook, mark_m: float) -> SpherePrimitive:
    """Add and return a sphere."""
    ball = entity.spheres.add()
    ball.pose.orientation.w = 1.0
    ball.size.x = ball.size.y = look.width * mark_m
    ball.size.z = look.height * mark_m
    ball.color.r, ball.color.g, ball.color.b, ball.color.a = look.colour
    return ball
