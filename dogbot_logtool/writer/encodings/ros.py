"""Annotations as messages of ROS 1 and ROS 2: TFMessage, markers and messages of our own."""

from typing import Any, ClassVar, Final

import numpy as np
from rosbags.interfaces import Nodetype
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from dogbot_logtool.core.events.event import EventMessage
from dogbot_logtool.writer.drawing import Drawing, Primitive, Shape
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
from dogbot_logtool.writer.template import Kind, Literal, Of, Slot

_TF: Final = "tf2_msgs/msg/TFMessage"
_MARKER: Final = "visualization_msgs/msg/Marker"
_MARKERS: Final = "visualization_msgs/msg/MarkerArray"
_LOAD: Final = "dogbot_logtool/msg/Load"
_LOAD_DEFINITION: Final = """
# The load on a foot at the time of one contact message.
builtin_interfaces/Time stamp
bool in_contact   # as the sensor reports it
string state      # stance, swing or unknown
float64 force     # N, magnitude; NaN when not known
float64 force_bw  # body weights; NaN when the robot's mass is not known
"""
_GAIT: Final = "dogbot_logtool/msg/Gait"
_GAIT_DEFINITION: Final = """
# The gait from this time on.
builtin_interfaces/Time stamp
string gait                  # class, or unknown
float64 stride_frequency_hz  # NaN without strides
float64 duty_factor
float64[] phases             # cycles, of each foot
"""
_DELETE: Final = 2
_MARKER_TYPES: Final = {
    Shape.ARROW: 0,
    Shape.LINE_STRIP: 4,
    Shape.LINE_LIST: 5,
    Shape.BALLS: 7,
    Shape.TEXT: 9,
}


class Ros2Encoding(Encoding):
    """CDR, definitions of Humble; those of later distributions are the same."""

    kinds: ClassVar = {
        Of.NUMBER: Kind.FLOAT64,
        Of.COLOUR: Kind.FLOAT32,
        Of.TIME: Kind.UINT32,
        Of.FLAG: Kind.BOOL,
        Of.TEXT: Kind.TEXT6,
    }
    time_name = "stamp"
    time_fields = "sec", "nanosec"
    is_ros1: ClassVar[bool] = False
    log_name: ClassVar[str] = "rcl_interfaces/msg/Log"

    def __init__(self) -> None:
        self._store = get_typestore(Stores.ROS1_NOETIC if self.is_ros1 else Stores.ROS2_HUMBLE)
        own = {_LOAD: _LOAD_DEFINITION, _GAIT: _GAIT_DEFINITION}
        if self.is_ros1:
            own = {n: text.replace("builtin_interfaces/Time", "time") for n, text in own.items()}
            own[_TF] = "geometry_msgs/TransformStamped[] transforms"
        for name, text in own.items():
            self._store.register(get_types_from_msg(text, name))
        self._names: dict[MessageType, str] = {}
        self.transform_type = self._message_type(_TF)
        self.arrow_type = self._message_type(_MARKER)
        self.load_type = self._message_type(_LOAD)
        self.support_type = self._message_type(_MARKERS)
        self.event_type = self._message_type(self.log_name)
        self.gait_type = self._message_type(_GAIT)

    def _message_type(self, name: str) -> MessageType:
        definition, _ = self._store.generate_msgdef(name, ros_version=1 if self.is_ros1 else 2)
        kind = MessageType(name, "ros2msg", definition.encode(), "cdr")
        if self.is_ros1:
            ours = name.replace("/msg/", "/")
            kind = MessageType(ours, "ros1msg", definition.encode(), "ros1")
        self._names[kind] = name
        return kind

    def serialise(self, kind: MessageType, literal: Literal) -> bytes:
        """See `Encoding.serialise`."""
        name = self._names[kind]
        message = self._made(name, literal)
        if self.is_ros1:
            return bytes(self._store.serialize_ros1(message, name))
        return bytes(self._store.serialize_cdr(message, name, little_endian=True))

    def _made(self, name: str, literal: Literal) -> Any:  # noqa: ANN401 - made at run time
        """Make a message; what the literal does not give is zero, empty or false."""
        _, fields = self._store.fielddefs[name]
        values = {field: self._value(kind, of, literal.get(field)) for field, (kind, of) in fields}
        return self._store.types[name](**values)

    def _value(self, kind: Nodetype, of: Any, given: Any) -> Any:  # noqa: ANN401
        """Return the value of a field.

        Args:
            kind: of the field.
            of: name of its type, or kind and name of its elements.
            given: in the literal; None: nothing.
        """
        if kind == Nodetype.NAME:
            return self._made(of, given or {})
        if kind == Nodetype.BASE:
            default: Any = "" if of[0] == "string" else 0
            return default if given is None else given
        element, name = of[0]
        if element == Nodetype.BASE and name[0] != "string":
            return np.array(given or [], name[0])
        return [self._value(element, name, each) for each in given or []]

    def _header(self, frame: str) -> Literal:
        return {"stamp": self.stamp(), "frame_id": frame}

    def _transform(self, parent: str, child: str, prefix: str) -> Literal:
        return {
            "header": self._header(parent),
            "child_frame_id": child,
            "transform": {"translation": position(prefix), "rotation": orientation(prefix)},
        }

    def _drawing(self, drawing: Drawing) -> Literal:
        if len(drawing.primitives) == 1:
            return self._marker(drawing, 0)
        return {"markers": [self._marker(drawing, row) for row in range(len(drawing.primitives))]}

    def _marker(self, drawing: Drawing, row: int) -> Literal:
        one = drawing.primitives[row]
        marker = {
            "header": self._header(drawing.frame),
            "ns": drawing.namespace,
            "id": row,
            "pose": {"orientation": UPRIGHT},
        }
        if one is None:
            return {**marker, "action": _DELETE}
        lifetime = self.time(round(drawing.lifetime_s * 1e9))
        return {
            **marker,
            "type": _MARKER_TYPES[one.shape],
            "lifetime": lifetime,
            "color": {} if one.colour is None else colour(one.colour),
            **_geometry(one),
        }

    def _removal(self, drawing: Drawing) -> Literal:
        header, pose = self._header(drawing.frame), {"orientation": UPRIGHT}
        return {"header": header, "ns": drawing.namespace, "action": _DELETE, "pose": pose}

    def event(self, event: EventMessage) -> bytes:
        """See `Encoding.event`."""
        time = self.time(event.time)
        literal = {
            # Levels of ROS 1 are powers of two, those of ROS 2 tens.
            "level": 1 << (event.level - 1) if self.is_ros1 else 10 * event.level,
            "name": event.source,
            "msg": event.text,
            "file": EVENT_SOURCE,
            **({"header": {"stamp": time}} if self.is_ros1 else {"stamp": time}),
        }
        return self.serialise(self.event_type, literal)


def _geometry(one: Primitive) -> Literal:
    """Return the fields of a marker that say where it is, and how large."""
    if one.shape is Shape.ARROW:
        pose = {"position": vector(one.points[0]), "orientation": orientation()}
        return {"pose": pose, "scale": vector((Slot("length"), one.width, one.width))}
    if one.shape is Shape.TEXT:
        pose = {"position": vector(one.points[0]), "orientation": UPRIGHT}
        return {"pose": pose, "scale": {"z": one.height}, "text": one.text}
    balls = one.shape is Shape.BALLS
    scale = (one.width, one.width, one.height) if balls else (one.width, 0.0, 0.0)
    return {
        "points": [vector(point) for point in one.points],
        "scale": vector(scale),
        "colors": [colour(each) for each in one.colours],
    }


class Ros1Encoding(Ros2Encoding):
    """ROS 1 serialisation, definitions of Noetic."""

    is_ros1 = True
    log_name = "rosgraph_msgs/msg/Log"
