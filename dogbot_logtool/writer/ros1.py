"""Annotations as ROS 1 messages."""

from collections.abc import Mapping
from typing import Any, Final

from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from dogbot_logtool.writer.encoding import LOAD_FIELDS, ArrowStyle, MessageType
from dogbot_logtool.writer.template import Kind, Number, Template, learn

_TF: Final = "tf2_msgs/msg/TFMessage"
_MARKER: Final = "visualization_msgs/msg/Marker"
_LOAD: Final = "dogbot_logtool/msg/Load"
_LOAD_DEFINITION: Final = """
# The load on a foot at the time of one contact message.
time stamp
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


class Ros1Encoding:
    """tf2_msgs/TFMessage, visualization_msgs/Marker and a load message of our own."""

    def __init__(self) -> None:
        self._store = get_typestore(Stores.ROS1_NOETIC)
        self._store.register(get_types_from_msg("geometry_msgs/TransformStamped[] transforms", _TF))
        self._store.register(get_types_from_msg(_LOAD_DEFINITION, _LOAD))
        self.transform_type = self._message_type(_TF)
        self.arrow_type = self._message_type(_MARKER)
        self.load_type = self._message_type(_LOAD)

    def _message_type(self, name: str) -> MessageType:
        definition, _ = self._store.generate_msgdef(name)
        return MessageType(name.replace("/msg/", "/"), "ros1msg", definition.encode(), "ros1")

    def _make(self, name: str, **fields: object) -> Any:  # noqa: ANN401 - types made at run time
        return self._store.types[name](**fields)  # type: ignore[arg-type]

    def _time(self, values: Mapping[str, Number]) -> Any:  # noqa: ANN401
        return self._make(
            "builtin_interfaces/msg/Time",
            sec=values["stamp.sec"],
            nanosec=values["stamp.nanosec"],
        )

    def _header(self, frame: str, values: Mapping[str, Number]) -> Any:  # noqa: ANN401
        stamp = self._time(values)
        return self._make("std_msgs/msg/Header", seq=0, stamp=stamp, frame_id=frame)

    def _quaternion(self, values: Mapping[str, Number]) -> Any:  # noqa: ANN401
        parts = {axis: values[f"q{axis}"] for axis in "xyzw"}
        return self._make("geometry_msgs/msg/Quaternion", **parts)

    def transform(self, parent: str, child: str) -> Template:
        """See `Encoding.transform`."""

        def serialise(values: Mapping[str, Number]) -> bytes:
            place = {axis: values[axis] for axis in "xyz"}
            one = self._make(
                "geometry_msgs/msg/TransformStamped",
                header=self._header(parent, values),
                child_frame_id=child,
                transform=self._make(
                    "geometry_msgs/msg/Transform",
                    translation=self._make("geometry_msgs/msg/Vector3", **place),
                    rotation=self._quaternion(values),
                ),
            )
            return bytes(self._store.serialize_ros1(self._make(_TF, transforms=[one]), _TF))

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
        marker = self._make(
            _MARKER,
            header=self._header(frame, values),
            ns=_NAMESPACE,
            id=0,
            type=_ARROW_TYPE,
            action=action,
            pose=self._make(
                "geometry_msgs/msg/Pose",
                position=self._make("geometry_msgs/msg/Point", **place),
                orientation=self._quaternion(values),
            ),
            scale=self._make(
                "geometry_msgs/msg/Vector3", x=values["length"], y=diameter, z=diameter
            ),
            color=self._make("std_msgs/msg/ColorRGBA", **{part: values[part] for part in "rgba"}),
            lifetime=self._make(
                "builtin_interfaces/msg/Duration", sec=seconds, nanosec=nanoseconds
            ),
            frame_locked=False,
            points=[],
            colors=[],
            text="",
            mesh_resource="",
            mesh_use_embedded_materials=False,
        )
        return bytes(self._store.serialize_ros1(marker, _MARKER))

    def load(self) -> Template:
        """See `Encoding.load`."""

        def serialise(values: Mapping[str, Number]) -> bytes:
            numbers: dict[str, Any] = {name: values[name] for name in LOAD_FIELDS}
            load = self._make(_LOAD, stamp=self._time(values), **numbers)
            return bytes(self._store.serialize_ros1(load, _LOAD))

        return learn(serialise, _STAMP | LOAD_FIELDS)
