"""Annotations as ROS messages: what ROS 1 and ROS 2 have in common."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Any, ClassVar, Final

from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from dogbot_logtool.writer.encoding import LOAD_FIELDS, ArrowStyle, MessageType
from dogbot_logtool.writer.template import Kind, Number, Template, learn

TF: Final = "tf2_msgs/msg/TFMessage"
MARKER: Final = "visualization_msgs/msg/Marker"
_LOAD: Final = "dogbot_logtool/msg/Load"
_LOAD_DEFINITION: Final = """
# The load on a foot at the time of one contact message.
builtin_interfaces/Time stamp
bool in_contact
float64 force     # N, magnitude
float64 force_bw  # body weights; NaN when the robot's mass is not known
"""
_NAMESPACE: Final = "dogbot"
_ARROW_TYPE, _ADD, _DELETE = 0, 0, 2
_STAMP: Final = {"stamp.sec": Kind.UINT32, "stamp.nanosec": Kind.UINT32}
_POSE: Final = dict.fromkeys(("x", "y", "z", "qx", "qy", "qz", "qw"), Kind.FLOAT64)
_COLOUR: Final = dict.fromkeys("rgba", Kind.FLOAT32)
_HIDDEN: Final = dict.fromkeys((*_POSE, *_COLOUR, "length"), 0.0) | {"qw": 1.0}


class RosEncoding(ABC):
    """tf2_msgs/TFMessage, visualization_msgs/Marker and a load message of our own."""

    distribution: ClassVar[Stores]
    """Whose message definitions are used."""
    definitions: ClassVar[Mapping[str, str]] = {}
    """Definitions that rosbags' store of it lacks."""
    load_definition: ClassVar[str] = _LOAD_DEFINITION

    def __init__(self) -> None:
        self._store = get_typestore(self.distribution)
        for name, text in {**self.definitions, _LOAD: self.load_definition}.items():
            self._store.register(get_types_from_msg(text, name))
        self.transform_type = self._message_type(TF)
        self.arrow_type = self._message_type(MARKER)
        self.load_type = self._message_type(_LOAD)

    @abstractmethod
    def _message_type(self, name: str) -> MessageType:
        """Return how an MCAP file names a type."""

    @abstractmethod
    def _serialise(self, message: Any, name: str) -> bytes:  # noqa: ANN401 - made at run time
        """Serialise a message."""

    @abstractmethod
    def _header_extras(self) -> Mapping[str, Any]:
        """Return what a header has besides stamp and frame."""

    @abstractmethod
    def _marker_extras(self) -> Mapping[str, Any]:
        """Return what a marker has besides the fields of all versions."""

    def make(self, name: str, **fields: object) -> Any:  # noqa: ANN401 - types made at run time
        """Make a message."""
        return self._store.types[name](**fields)  # type: ignore[arg-type]

    def _time(self, values: Mapping[str, Number]) -> Any:  # noqa: ANN401
        return self.make(
            "builtin_interfaces/msg/Time",
            sec=values["stamp.sec"],
            nanosec=values["stamp.nanosec"],
        )

    def header(self, frame: str, values: Mapping[str, Number]) -> Any:  # noqa: ANN401
        """Make a header."""
        stamp = self._time(values)
        return self.make(
            "std_msgs/msg/Header", stamp=stamp, frame_id=frame, **self._header_extras()
        )

    def _quaternion(self, values: Mapping[str, Number]) -> Any:  # noqa: ANN401
        parts = {axis: values[f"q{axis}"] for axis in "xyzw"}
        return self.make("geometry_msgs/msg/Quaternion", **parts)

    def transform(self, parent: str, child: str) -> Template:
        """See `Encoding.transform`."""

        def serialise(values: Mapping[str, Number]) -> bytes:
            place = {axis: values[axis] for axis in "xyz"}
            one = self.make(
                "geometry_msgs/msg/TransformStamped",
                header=self.header(parent, values),
                child_frame_id=child,
                transform=self.make(
                    "geometry_msgs/msg/Transform",
                    translation=self.make("geometry_msgs/msg/Vector3", **place),
                    rotation=self._quaternion(values),
                ),
            )
            return self._serialise(self.make(TF, transforms=[one]), TF)

        return learn(serialise, _STAMP | _POSE)

    def arrow(self, foot: str, frame: str, style: ArrowStyle) -> Template:
        """See `Encoding.arrow`; every foot has a topic of its own, so all markers have one id."""
        del foot

        def serialise(values: Mapping[str, Number]) -> bytes:
            return self._marker(frame, _ADD, style, values)

        return learn(serialise, _STAMP | _POSE | _COLOUR | {"length": Kind.FLOAT64})

    def removal(self, foot: str, frame: str) -> Template:
        """See `Encoding.removal`."""
        del foot
        unseen = ArrowStyle(shaft_diameter_m=0.0, lifetime_s=0.0)

        def serialise(values: Mapping[str, Number]) -> bytes:
            return self._marker(frame, _DELETE, unseen, {**_HIDDEN, **values})

        return learn(serialise, _STAMP)

    def _marker(
        self, frame: str, action: int, style: ArrowStyle, values: Mapping[str, Number]
    ) -> bytes:
        diameter = style.shaft_diameter_m
        place = {axis: values[axis] for axis in "xyz"}
        seconds, nanoseconds = divmod(round(style.lifetime_s * 1e9), 1_000_000_000)
        marker = self.make(
            MARKER,
            header=self.header(frame, values),
            ns=_NAMESPACE,
            id=0,
            type=_ARROW_TYPE,
            action=action,
            pose=self.make(
                "geometry_msgs/msg/Pose",
                position=self.make("geometry_msgs/msg/Point", **place),
                orientation=self._quaternion(values),
            ),
            scale=self.make(
                "geometry_msgs/msg/Vector3", x=values["length"], y=diameter, z=diameter
            ),
            color=self.make("std_msgs/msg/ColorRGBA", **{part: values[part] for part in "rgba"}),
            lifetime=self.make("builtin_interfaces/msg/Duration", sec=seconds, nanosec=nanoseconds),
            frame_locked=False,
            points=[],
            colors=[],
            text="",
            mesh_resource="",
            mesh_use_embedded_materials=False,
            **self._marker_extras(),
        )
        return self._serialise(marker, MARKER)

    def load(self) -> Template:
        """See `Encoding.load`."""

        def serialise(values: Mapping[str, Number]) -> bytes:
            numbers: dict[str, Any] = {name: values[name] for name in LOAD_FIELDS}
            load = self.make(_LOAD, stamp=self._time(values), **numbers)
            return self._serialise(load, _LOAD)

        return learn(serialise, _STAMP | LOAD_FIELDS)
