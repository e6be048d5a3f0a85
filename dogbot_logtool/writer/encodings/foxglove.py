"""Annotations as Foxglove's protobuf messages."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import Any, ClassVar, Final, cast

from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms
from foxglove_schemas_protobuf.LinePrimitive_pb2 import LinePrimitive
from foxglove_schemas_protobuf.Log_pb2 import Log
from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate
from google.protobuf.descriptor import FieldDescriptor, FileDescriptor
from google.protobuf.descriptor_pb2 import DescriptorProto, FileDescriptorProto, FileDescriptorSet
from google.protobuf.descriptor_pool import DescriptorPool
from google.protobuf.message import Message
from google.protobuf.message_factory import GetMessageClass
from google.protobuf.timestamp_pb2 import DESCRIPTOR as TIMESTAMP_FILE

from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.writer import described, markers
from dogbot_logtool.writer.described import OWN_FIELDS, Described
from dogbot_logtool.writer.encodings.encoding import Encoding, MessageType
from dogbot_logtool.writer.template import TEXT, VARINT, Columns, Literal, Of, varints

HEAD_TO_SHAFT: Final = 2.0
"""Diameter of an arrow's head over its shaft's."""
_SHAFT: Final = 0.77
"""The shaft's share of an arrow's length, as viewers draw ROS markers."""
_TYPES: Final = {
    "bool": FieldDescriptor.TYPE_BOOL,
    "string": FieldDescriptor.TYPE_STRING,
    "float64": FieldDescriptor.TYPE_DOUBLE,
}


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


def _own_class(name: str) -> type[Message]:
    """Build the class of a message that no library has: a time, and its `OWN_FIELDS`.

    Flags have presence, so that false is written out like true.
    """
    short = name.rpartition("/")[2]
    message = DescriptorProto(name=short)
    message.field.add(
        name="timestamp",
        number=1,
        type=FieldDescriptor.TYPE_MESSAGE,
        type_name=".google.protobuf.Timestamp",
        label=FieldDescriptor.LABEL_OPTIONAL,
    )
    for field, kind, number in sorted(OWN_FIELDS[name], key=lambda each: each[2]):
        element, many = kind.removesuffix("[]"), kind.endswith("[]")
        label = FieldDescriptor.LABEL_REPEATED if many else FieldDescriptor.LABEL_OPTIONAL
        added = message.field.add(name=field, number=number, type=_TYPES[element], label=label)
        if kind == "bool":
            added.proto3_optional, added.oneof_index = True, len(message.oneof_decl)
            message.oneof_decl.add(name=f"_{field}")
    file = FileDescriptorProto(
        name=f"dogbot_logtool/{short}.proto",
        package="dogbot_logtool",
        syntax="proto3",
        dependency=[TIMESTAMP_FILE.name],
        message_type=[message],
    )
    pool = DescriptorPool()
    pool.AddSerializedFile(TIMESTAMP_FILE.serialized_pb)
    pool.AddSerializedFile(file.SerializeToString())
    return GetMessageClass(pool.FindMessageTypeByName(f"dogbot_logtool.{short}"))


class FoxgloveEncoding(Encoding):
    """FrameTransforms, SceneUpdates and messages of our own."""

    kinds: ClassVar = {
        Of.NUMBER: "<f8",
        Of.COLOUR: "<f8",
        Of.TIME: VARINT,
        Of.TEXT: TEXT,
    }

    def __init__(self) -> None:
        self._classes: dict[str, type[Message]] = {
            described.TF: FrameTransforms,
            described.MARKER: SceneUpdate,
            described.MARKERS: SceneUpdate,
            described.LOG: Log,
            **{name: _own_class(name) for name in OWN_FIELDS},
        }
        try:
            from foxglove_schemas_protobuf.Event_pb2 import Event  # noqa: PLC0415

            self._classes[described.SPAN] = Event
        except ImportError:  # schemas older than 0.4
            pass
        self.types = {name: _message_type(kind) for name, kind in self._classes.items()}

    def own_terms(self, message: Described) -> Literal:
        """See `Encoding.own_terms`."""
        return _TERMS[message.name](message)

    def serialise(self, name: str, literal: Literal) -> bytes:
        """See `Encoding.serialise`."""
        return self._classes[name](**literal).SerializeToString(deterministic=True)

    def stamp_columns(self, time: Ints) -> Columns:
        """See `Encoding.stamp_columns`."""
        columns = super().stamp_columns(time)
        return {slot: varints(numbers) for slot, numbers in columns.items()}


def _time(time: Literal) -> Literal:
    return {"seconds": time["sec"], "nanos": time["nanosec"]}


def _transforms(message: Described) -> Literal:
    each = [
        {
            "timestamp": _time(one["header"]["stamp"]),
            "parent_frame_id": one["header"]["frame_id"],
            "child_frame_id": one["child_frame_id"],
            **one["transform"],
        }
        for one in message.literal["transforms"]
    ]
    return {"transforms": each}


def _own(message: Described) -> Literal:
    fields = dict(message.literal)
    return {"timestamp": _time(fields.pop("stamp")), **fields}


def _log(message: Described) -> Literal:
    fields = dict(_own(message))
    text, level = fields.pop("msg"), fields.pop("level") // 10
    return {**fields, "message": text, "level": level}


def _span(message: Described) -> Literal:
    times = {name: _time(message.literal[name]) for name in ("start_time", "end_time")}
    return {**message.literal, **times}


def _scene(message: Described) -> Literal:
    """Draw markers as an entity, which replaces the one before it; or remove that."""
    drawn = message.literal.get("markers", [message.literal])
    header = drawn[0]["header"]
    entity: dict[str, Any] = {"id": message.entity, "timestamp": _time(header["stamp"])}
    if message.literal.get("action") == markers.DELETE:
        return {"deletions": [entity]}
    entity["frame_id"] = header["frame_id"]
    entity["lifetime"] = _time(described.time(round(message.lifetime_s * 1e9)))
    for marker in drawn:
        for field, literal in () if "type" not in marker else _primitives(marker):
            entity.setdefault(field, []).append(literal)
    return {"entities": [entity]}


def _primitives(marker: Literal) -> Iterator[tuple[str, Literal]]:
    """Yield what an entity has of a marker, with the field that it stands in."""
    scale, points, colours = (marker.get(name, []) for name in ("scale", "points", "colors"))
    own = {name: marker[name] for name in ("pose", "color") if name in marker}
    match marker["type"]:
        case markers.ARROW:
            shaft, head = (replace(scale["x"], share=share) for share in (_SHAFT, 1.0 - _SHAFT))
            lengths = {"shaft_length": shaft, "head_length": head}
            widths = {"shaft_diameter": scale["y"], "head_diameter": HEAD_TO_SHAFT * scale["y"]}
            yield "arrows", {**own, **lengths, **widths}
        case markers.TEXT:
            look = {"billboard": True, "font_size": scale["z"]}
            yield "texts", {**own, "text": marker["text"], **look}
        case markers.BALLS:
            for row, point in enumerate(points):
                colour = {"color": colours[row]} if colours else {}
                pose = {"position": point, **markers.UPRIGHT}
                yield "spheres", {**own, "pose": pose, "size": scale, **colour}
        case markers.LINE_STRIP | markers.LINE_LIST as kind:
            strip = kind == markers.LINE_STRIP
            shape = LinePrimitive.LINE_STRIP if strip else LinePrimitive.LINE_LIST
            line = {"type": shape, "thickness": scale["x"], "points": points, "colors": colours}
            yield "lines", {**own, **line}


_TERMS: Final[Mapping[str, Callable[[Described], Literal]]] = {
    described.TF: _transforms,
    described.MARKER: _scene,
    described.MARKERS: _scene,
    described.LOG: _log,
    described.LOAD: _own,
    described.GAIT: _own,
    described.SPAN: _span,
}
