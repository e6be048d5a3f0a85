"""Annotations as ROS messages: what ROS 1 and ROS 2 have in common."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, Final, Self

import numpy as np
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from dogbot_logtool.core.events.event import EventMessage, GaitState, Level
from dogbot_logtool.writer.encodings.encoding import (
    EVENT_SOURCE,
    GAIT_NUMBERS,
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

TF: Final = "tf2_msgs/msg/TFMessage"
MARKER: Final = "visualization_msgs/msg/Marker"
MARKERS: Final = "visualization_msgs/msg/MarkerArray"
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
_NAMESPACE: Final = "dogbot"
_ADD, _DELETE = 0, 2
_ARROW_TYPE, _LINE_STRIP_TYPE, _LINE_LIST_TYPE, _SPHERE_LIST_TYPE, _TEXT_TYPE = 0, 4, 5, 7, 9
_SUPPORT_MARKERS: Final = 4
"""Outline, centre of pressure, projection and touchdowns, in the order of their ids."""
_STAMP: Final = {"stamp.sec": Kind.UINT32, "stamp.nanosec": Kind.UINT32}
_POSE: Final = dict.fromkeys(("x", "y", "z", "qx", "qy", "qz", "qw"), Kind.FLOAT64)
_POINT: Final = dict.fromkeys("xyz", Kind.FLOAT64)
_COLOUR: Final = dict.fromkeys("rgba", Kind.FLOAT32)
_UPRIGHT: Final = {"qx": 0.0, "qy": 0.0, "qz": 0.0, "qw": 1.0}


class RosEncoding(ABC):
    """tf2_msgs/TFMessage, visualization_msgs' markers and a load message of our own."""

    distribution: ClassVar[Stores]
    """The distribution whose message definitions are used."""
    definitions: ClassVar[Mapping[str, str]] = {}
    """Definitions that rosbags' type store lacks."""
    load_definition: ClassVar[str] = _LOAD_DEFINITION
    gait_definition: ClassVar[str] = _GAIT_DEFINITION
    log_name: ClassVar[str]
    """The distribution's log message."""
    log_levels: ClassVar[Mapping[Level, int]]
    """Its numbers of the levels."""
    span_type: MessageType | None = None

    def __init__(self) -> None:
        self._store = get_typestore(self.distribution)
        own = {_LOAD: self.load_definition, _GAIT: self.gait_definition}
        for name, text in {**self.definitions, **own}.items():
            self._store.register(get_types_from_msg(text, name))
        self.transform_type = self._message_type(TF)
        self.arrow_type = self._message_type(MARKER)
        self.load_type = self._message_type(_LOAD)
        self.support_type = self._message_type(MARKERS)
        self.event_type = self._message_type(self.log_name)
        self.gait_type = self._message_type(_GAIT)

    def __reduce__(self) -> "tuple[type[Self], tuple[()]]":
        """Be made anew in another process: classes of messages are made when it runs."""
        return type(self), ()

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
    def _log_extras(self, stamp: Mapping[str, Number]) -> Mapping[str, Any]:
        """Return what a log message has besides the fields of all versions."""

    @abstractmethod
    def _marker_extras(self) -> Mapping[str, Any]:
        """Return what a marker has besides the fields of all versions."""

    def make(self, name: str, /, **fields: object) -> Any:  # noqa: ANN401 - types made at run time
        """Make a message."""
        return self._store.types[name](**fields)  # type: ignore[arg-type]

    def time_of(self, values: Mapping[str, Number], name: str = "stamp") -> Any:  # noqa: ANN401
        """Make a time."""
        return self.make(
            "builtin_interfaces/msg/Time",
            sec=values[f"{name}.sec"],
            nanosec=values[f"{name}.nanosec"],
        )

    def header(self, frame: str, values: Mapping[str, Number], stamp_name: str = "stamp") -> Any:  # noqa: ANN401
        """Make a header."""
        stamp = self.time_of(values, stamp_name)
        return self.make(
            "std_msgs/msg/Header", stamp=stamp, frame_id=frame, **self._header_extras()
        )

    def _quaternion(self, values: Mapping[str, Number], prefix: str = "") -> Any:  # noqa: ANN401
        parts = {axis: values[f"{prefix}q{axis}"] for axis in "xyzw"}
        return self.make("geometry_msgs/msg/Quaternion", **parts)

    def transform(self, parent: str, child: str) -> Template:
        """See `Encoding.transform`."""

        def serialise(values: Mapping[str, Number]) -> bytes:
            one = self._transform(parent, child, values)
            return self._serialise(self.make(TF, transforms=[one]), TF)

        return learn(serialise, _STAMP | _POSE)

    def transforms(self, pairs: Sequence[tuple[str, str]]) -> Template:
        """See `Encoding.transforms`."""

        def serialise(values: Mapping[str, Number]) -> bytes:
            each = [
                self._transform(parent, child, values, f"{index}.")
                for index, (parent, child) in enumerate(pairs)
            ]
            return self._serialise(self.make(TF, transforms=each), TF)

        return learn(serialise, numbered(_STAMP | _POSE, len(pairs)))

    def _transform(
        self, parent: str, child: str, values: Mapping[str, Number], prefix: str = ""
    ) -> Any:  # noqa: ANN401
        """Make a transform."""
        position = {axis: values[prefix + axis] for axis in "xyz"}
        return self.make(
            "geometry_msgs/msg/TransformStamped",
            header=self.header(parent, values, f"{prefix}stamp"),
            child_frame_id=child,
            transform=self.make(
                "geometry_msgs/msg/Transform",
                translation=self.make("geometry_msgs/msg/Vector3", **position),
                rotation=self._quaternion(values, prefix),
            ),
        )

    def arrow(self, foot: str, frame: str, style: ArrowLook) -> Template:
        """See `Encoding.arrow`; every foot has a topic of its own, so all markers have one id."""
        del foot

        def serialise(values: Mapping[str, Number]) -> bytes:
            length, diameter = values["length"], style.shaft_diameter_m
            arrow = self.marker(
                self.header(frame, values),
                type=_ARROW_TYPE,
                pose=self._pose(self.point(values), values),
                scale=self._vector(length, diameter, diameter),
                color=self._colour([values[part] for part in "rgba"]),
                lifetime=self._duration(style.lifetime_s),
            )
            return self._serialise(arrow, MARKER)

        return learn(serialise, _STAMP | _POSE | _COLOUR | {"length": Kind.FLOAT64})

    def removal(self, foot: str, frame: str) -> Template:
        """See `Encoding.removal`."""
        del foot

        def serialise(values: Mapping[str, Number]) -> bytes:
            header = self.header(frame, values)
            return self._serialise(self.marker(header, type=_ARROW_TYPE, action=_DELETE), MARKER)

        return learn(serialise, _STAMP)

    def support(self, shape: SupportShape, frame: str, style: SupportLook) -> Template:
        """See `Encoding.support`; a marker without points is deleted."""
        points = support_points(shape)
        lifetime = self._duration(style.lifetime_s)
        stamps = [f"stamp{number}" for number in range(_SUPPORT_MARKERS)]

        def serialise(values: Mapping[str, Number]) -> bytes:
            looks = (
                self._line(points.line, style, values),
                self._balls(points.pressure, PRESSURE_LOOK, style, values),
                self._balls(points.projection, PROJECTION_LOOK, style, values),
                self._touchdowns(points.touchdowns, style, values),
            )
            markers = [
                self.marker(
                    self.header(frame, values, stamp),
                    ns="support",
                    id=number,
                    **({"lifetime": lifetime, **look} if look else {"action": _DELETE}),
                )
                for number, (stamp, look) in enumerate(zip(stamps, looks, strict=True))
            ]
            return self._serialise(self.make(MARKERS, markers=markers), MARKERS)

        times = {f"{stamp}.{part}": Kind.UINT32 for stamp in stamps for part in ("sec", "nanosec")}
        colour = _COLOUR if points.line else {}
        return learn(
            serialise, {**times, **colour, **points.fields, **points.colours(Kind.FLOAT32)}
        )

    def _line(
        self, names: Sequence[str], style: SupportLook, values: Mapping[str, Number]
    ) -> Mapping[str, Any]:
        """Return the fields of a marker that joins points; none where there are none."""
        if not names:
            return {}
        return {
            "type": _LINE_STRIP_TYPE,
            "points": [self.point(values, f"{name}.") for name in names],
            "scale": self._vector(style.line_m, 0.0, 0.0),
            "color": self._colour([values[part] for part in "rgba"]),
        }

    def _balls(
        self,
        names: Sequence[str],
        look: BallLook,
        style: SupportLook,
        values: Mapping[str, Number],
    ) -> Mapping[str, Any]:
        """Return the fields of a marker of several spheres; none where there are none."""
        if not names:
            return {}
        width, height = look.width * style.mark_m, look.height * style.mark_m
        return {
            "type": _SPHERE_LIST_TYPE,
            "points": [self.point(values, f"{name}.") for name in names],
            "scale": self._vector(width, width, height),
            "color": self._colour(look.colour),
        }

    def _touchdowns(
        self, names: Sequence[str], style: SupportLook, values: Mapping[str, Number]
    ) -> Mapping[str, Any]:
        """Return the fields of a marker of spheres, each in its foot's colour."""
        look = self._balls(names, TOUCHDOWN_LOOK, style, values)
        colours = [
            self._colour([*(values[f"{name}.{part}"] for part in "rgb"), 1.0]) for name in names
        ]
        return {**look, "colors": colours} if look else {}

    def point(self, values: Mapping[str, Number], name: str = "") -> Any:  # noqa: ANN401
        """Make a point of three named numbers."""
        return self.make("geometry_msgs/msg/Point", **{axis: values[name + axis] for axis in "xyz"})

    def _pose(self, position: Any, turn: Mapping[str, Number]) -> Any:  # noqa: ANN401
        orientation = self._quaternion(turn)
        return self.make("geometry_msgs/msg/Pose", position=position, orientation=orientation)

    def _vector(self, x: Number, y: Number, z: Number) -> Any:  # noqa: ANN401
        return self.make("geometry_msgs/msg/Vector3", x=x, y=y, z=z)

    def _colour(self, parts: Sequence[Number]) -> Any:  # noqa: ANN401
        named = dict(zip("rgba", parts, strict=True))
        return self.make("std_msgs/msg/ColorRGBA", **named)

    def _duration(self, seconds: float) -> Any:  # noqa: ANN401
        whole, nanoseconds = divmod(round(seconds * 1e9), 1_000_000_000)
        return self.make("builtin_interfaces/msg/Duration", sec=whole, nanosec=nanoseconds)

    def marker(self, header: Any, **fields: Any) -> Any:  # noqa: ANN401
        """Make a marker; fields that are not given are those of a marker without size."""
        origin = self.point(dict.fromkeys("xyz", 0.0))
        given = {
            "ns": _NAMESPACE,
            "id": 0,
            "type": _ARROW_TYPE,
            "action": _ADD,
            "pose": self._pose(origin, _UPRIGHT),
            "scale": self._vector(0.0, 0.0, 0.0),
            "color": self._colour((0.0,) * 4),
            "lifetime": self._duration(0.0),
            "points": [],
            "colors": [],
            "text": "",
            **fields,
        }
        return self.make(
            MARKER,
            header=header,
            frame_locked=False,
            mesh_resource="",
            mesh_use_embedded_materials=False,
            **given,
            **self._marker_extras(),
        )

    def label(self, foot: str, frame: str, name: str, lifetime_s: float) -> Template:
        """See `Encoding.label`; every foot has a topic of its own, so all markers have one id."""
        del foot

        def serialise(values: Mapping[str, Number]) -> bytes:
            label = self.marker(
                self.header(frame, values),
                ns="label",
                type=_TEXT_TYPE,
                pose=self._pose(self.point(values), _UPRIGHT),
                scale=self._vector(0.0, 0.0, LABEL_HEIGHT_M),
                color=self._colour(LABEL_COLOUR),
                lifetime=self._duration(lifetime_s),
                text=f"{name} {values['text']}",
            )
            return self._serialise(label, MARKER)

        return learn(serialise, _STAMP | _POINT | {"text": Kind.TEXT6})

    def legs(self, colours: Sequence[Rgb], frame: str, look: SupportLook) -> Template:
        """See `Encoding.legs`."""
        if not colours:
            return self.removal("legs", frame)

        def serialise(values: Mapping[str, Number]) -> bytes:
            lines = self.marker(
                self.header(frame, values),
                type=_LINE_LIST_TYPE,
                scale=self._vector(look.mark_m, 0.0, 0.0),
                points=[self.point(values, f"{name}.") for name in leg_points(len(colours))],
                colors=[self._colour(c) for own in colours for c in (LEG_COLOUR, (*own, 1.0))],
                lifetime=self._duration(look.lifetime_s),
            )
            return self._serialise(lines, MARKER)

        return learn(serialise, {**_STAMP, **leg_fields(len(colours))})

    def load(self, state: str) -> Template:
        """See `Encoding.load`."""

        def serialise(values: Mapping[str, Number]) -> bytes:
            numbers: dict[str, Any] = {name: values[name] for name in LOAD_FIELDS}
            load = self.make(_LOAD, stamp=self.time_of(values), state=state, **numbers)
            return self._serialise(load, _LOAD)

        return learn(serialise, _STAMP | LOAD_FIELDS)

    def span(self, event: EventMessage) -> bytes:
        """See `Encoding.span`; there is none."""
        raise NotImplementedError

    def event(self, event: EventMessage) -> bytes:
        """See `Encoding.event`."""
        message = self.make(
            self.log_name,
            level=self.log_levels[event.level],
            name=event.source,
            msg=event.text,
            file=EVENT_SOURCE,
            function="",
            line=0,
            **self._log_extras(_stamp_of(event.time)),
        )
        return self._serialise(message, self.log_name)

    def gait(self, state: GaitState) -> bytes:
        """See `Encoding.gait`."""
        numbers = {name: getattr(state, name) for name in GAIT_NUMBERS}
        message = self.make(
            _GAIT,
            stamp=self.time_of(_stamp_of(state.time)),
            gait=state.gait,
            phases=np.array(state.phases, np.float64),
            **numbers,
        )
        return self._serialise(message, _GAIT)


def _stamp_of(time: int) -> Mapping[str, int]:
    """Return a time, ns, as the two numbers of a stamp."""
    seconds, nanoseconds = divmod(time, 1_000_000_000)
    return {"stamp.sec": seconds, "stamp.nanosec": nanoseconds}
