"""Annotations as Foxglove's protobuf messages."""

from collections.abc import Iterator, Sequence
from typing import Any, ClassVar, Final, cast

from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms
from foxglove_schemas_protobuf.LinePrimitive_pb2 import LinePrimitive
from foxglove_schemas_protobuf.Log_pb2 import Log
from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate
from google.protobuf.descriptor import FieldDescriptor, FileDescriptor
from google.protobuf.descriptor_pb2 import (
    DescriptorProto,
    FileDescriptorProto,
    FileDescriptorSet,
)
from google.protobuf.descriptor_pool import DescriptorPool
from google.protobuf.message import Message
from google.protobuf.message_factory import GetMessageClass
from google.protobuf.timestamp_pb2 import DESCRIPTOR as TIMESTAMP_FILE

from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.core.events.event import EventMessage
from dogbot_logtool.writer.drawing import HEAD_TO_SHAFT, Drawing, Primitive, Shape
from dogbot_logtool.writer.encodings.encoding import (
    EVENT_SOURCE,
    UPRIGHT,
    Encoding,
    MessageType,
    colour,
    orientation,
    position,
    vector,
)
from dogbot_logtool.writer.template import Columns, Kind, Literal, Of, Slot, varints

_ONE: Final = FieldDescriptor.LABEL_OPTIONAL
_LOAD: Final = (
    ("in_contact", FieldDescriptor.TYPE_BOOL, _ONE),
    ("force", FieldDescriptor.TYPE_DOUBLE, _ONE),
    ("force_bw", FieldDescriptor.TYPE_DOUBLE, _ONE),
    ("state", FieldDescriptor.TYPE_STRING, _ONE),
)
_GAIT: Final = (
    ("gait", FieldDescriptor.TYPE_STRING, _ONE),
    ("stride_frequency_hz", FieldDescriptor.TYPE_DOUBLE, _ONE),
    ("duty_factor", FieldDescriptor.TYPE_DOUBLE, _ONE),
    ("phases", FieldDescriptor.TYPE_DOUBLE, FieldDescriptor.LABEL_REPEATED),
)


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


def _own_class(name: str, fields: Sequence[tuple[str, int, int]]) -> type[Message]:
    """Build the class of a message that no library has: a time, and some fields.

    Flags have presence, so that false is written out like true.

    Args:
        name: of the message.
        fields: name, type and label of each, as descriptors have them, by number from 2 on.
    """
    message = DescriptorProto(name=name)
    message.field.add(
        name="timestamp",
        number=1,
        type=FieldDescriptor.TYPE_MESSAGE,
        type_name=".google.protobuf.Timestamp",
        label=FieldDescriptor.LABEL_OPTIONAL,
    )
    for number, (field, kind, label) in enumerate(fields, 2):
        added = message.field.add(name=field, number=number, type=kind, label=label)
        if kind == FieldDescriptor.TYPE_BOOL:
            added.proto3_optional, added.oneof_index = True, len(message.oneof_decl)
            message.oneof_decl.add(name=f"_{field}")
    file = FileDescriptorProto(
        name=f"dogbot_logtool/{name}.proto",
        package="dogbot_logtool",
        syntax="proto3",
        dependency=[TIMESTAMP_FILE.name],
        message_type=[message],
    )
    pool = DescriptorPool()
    pool.AddSerializedFile(TIMESTAMP_FILE.serialized_pb)
    pool.AddSerializedFile(file.SerializeToString())
    return GetMessageClass(pool.FindMessageTypeByName(f"dogbot_logtool.{name}"))


class FoxgloveEncoding(Encoding):
    """FrameTransforms, SceneUpdates and messages of our own."""

    kinds: ClassVar = {
        Of.NUMBER: Kind.FLOAT64,
        Of.COLOUR: Kind.FLOAT64,
        Of.TIME: Kind.VARINT,
        Of.FLAG: Kind.BOOL,
        Of.TEXT: Kind.TEXT6,
    }
    time_name = "timestamp"
    time_fields = "seconds", "nanos"

    def __init__(self) -> None:
        self._classes: dict[str, type[Message]] = {}
        self.transform_type = self._registered(FrameTransforms)
        self.arrow_type = self.support_type = self._registered(SceneUpdate)
        self.load_type = self._registered(_own_class("Load", _LOAD))
        self.event_type = self._registered(Log)
        self.gait_type = self._registered(_own_class("Gait", _GAIT))
        try:
            from foxglove_schemas_protobuf.Event_pb2 import Event  # noqa: PLC0415
        except ImportError:  # schemas older than 0.4
            return
        self.span_type = self._registered(Event)

    def _registered(self, message: type[Message]) -> MessageType:
        kind = _message_type(message)
        self._classes[kind.name] = message
        return kind

    def serialise(self, kind: MessageType, literal: Literal) -> bytes:
        """See `Encoding.serialise`."""
        return self._classes[kind.name](**literal).SerializeToString(deterministic=True)

    def stamp_columns(self, time: Ints) -> Columns:
        """See `Encoding.stamp_columns`."""
        columns = super().stamp_columns(time)
        return {slot: varints(numbers) for slot, numbers in columns.items()}

    def _transform(self, parent: str, child: str, prefix: str) -> Literal:
        return {
            "timestamp": self.stamp(),
            "parent_frame_id": parent,
            "child_frame_id": child,
            "translation": position(prefix),
            "rotation": orientation(prefix),
        }

    def _drawing(self, drawing: Drawing) -> Literal:
        entity: dict[str, Any] = {
            "id": drawing.name,
            "frame_id": drawing.frame,
            "timestamp": self.stamp(),
            "lifetime": self.time(round(drawing.lifetime_s * 1e9)),
        }
        for one in drawing.primitives:
            for field, literal in () if one is None else _primitives(one):
                entity.setdefault(field, []).append(literal)
        return {"entities": [entity]}

    def _removal(self, drawing: Drawing) -> Literal:
        return {"deletions": [{"id": drawing.name, "timestamp": self.stamp()}]}

    def event(self, event: EventMessage) -> bytes:
        """See `Encoding.event`."""
        literal = {"level": int(event.level), "message": event.text, "name": event.source}
        stamp = self.time(event.time)
        return self.serialise(
            self.event_type, {**literal, "timestamp": stamp, "file": EVENT_SOURCE}
        )

    def span(self, event: EventMessage) -> bytes:
        """See `Encoding.span`."""
        if self.span_type is None:
            return super().span(event)
        details = [{"key": key, "value": value} for key, value in event.details.items()]
        times = {"start_time": self.time(event.time), "end_time": self.time(event.end)}
        return self.serialise(self.span_type, {**times, "metadata": details})


def _primitives(one: Primitive) -> Iterator[tuple[str, Literal]]:
    """Yield what an entity has of a primitive, with the field that it stands in."""
    own = {} if one.colour is None else {"color": colour(one.colour)}
    match one.shape:
        case Shape.ARROW:
            pose = {"position": vector(one.points[0]), "orientation": orientation()}
            yield (
                "arrows",
                {
                    "pose": pose,
                    "shaft_length": Slot("shaft"),
                    "shaft_diameter": one.width,
                    "head_length": Slot("head"),
                    "head_diameter": HEAD_TO_SHAFT * one.width,
                    **own,
                },
            )
        case Shape.TEXT:
            pose = {"position": vector(one.points[0]), "orientation": UPRIGHT}
            look = {"billboard": True, "font_size": one.height, **own}
            yield "texts", {"pose": pose, "text": one.text, **look}
        case Shape.BALLS:
            size = vector((one.width, one.width, one.height))
            for row, point in enumerate(one.points):
                pose = {"position": vector(point), "orientation": UPRIGHT}
                tint = {"color": colour(one.colours[row])} if one.colours else own
                yield "spheres", {"pose": pose, "size": size, **tint}
        case Shape.LINE_STRIP | Shape.LINE_LIST:
            strip = one.shape is Shape.LINE_STRIP
            yield (
                "lines",
                {
                    "type": LinePrimitive.LINE_STRIP if strip else LinePrimitive.LINE_LIST,
                    # All zeros are no orientation.
                    "pose": {"orientation": UPRIGHT},
                    "thickness": one.width,
                    "points": [vector(point) for point in one.points],
                    "colors": [colour(each) for each in one.colours],
                    **own,
                },
            )
