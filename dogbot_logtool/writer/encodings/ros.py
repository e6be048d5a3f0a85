"""Annotations as messages of ROS 1 and ROS 2: TFMessage, markers and messages of our own."""

from typing import Any, ClassVar

import numpy as np
from rosbags.interfaces import Nodetype
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from dogbot_logtool.writer.described import LOG, OWN_FIELDS, ROS_TYPES, STRING, TF, Described
from dogbot_logtool.writer.encodings.encoding import Encoding, MessageType
from dogbot_logtool.writer.template import TEXT, Literal, Of


class Ros2Encoding(Encoding):
    """CDR, definitions of Humble; those of later distributions are the same."""

    kinds: ClassVar = {
        Of.NUMBER: "<f8",
        Of.COLOUR: "<f4",
        Of.TIME: "<u4",
        Of.TEXT: TEXT,
    }
    profile = "ros2"
    _stored: ClassVar = Stores.ROS2_HUMBLE
    _time: ClassVar[str] = "builtin_interfaces/Time"

    def __init__(self) -> None:
        self._store = get_typestore(self._stored)
        self._store.register(get_types_from_msg("geometry_msgs/TransformStamped[] transforms", TF))
        for name, fields in OWN_FIELDS.items():
            lines = [f"{self._time} stamp", *(f"{kind} {field}" for field, kind, _ in fields)]
            self._store.register(get_types_from_msg("\n".join(lines), name))
        self.types = {name: self._message_type(self._own_name(name)) for name in ROS_TYPES}

    def _own_name(self, name: str) -> str:
        return name

    def _message_type(self, name: str) -> MessageType:
        definition, _ = self._store.generate_msgdef(name, ros_version=2)
        return MessageType(name, "ros2msg", definition.encode(), "cdr")

    def own_terms(self, message: Described) -> Literal:
        """See `Encoding.own_terms`."""
        return message.literal

    def serialise(self, name: str, literal: Literal) -> bytes:
        """See `Encoding.serialise`."""
        message = self._made(name, literal)
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
            return np.array([] if given is None else given, name[0])
        return [self._value(element, name, each) for each in given or ()]


class Ros1Encoding(Ros2Encoding):
    """ROS 1 serialisation, definitions of Noetic."""

    profile = "ros1"
    _stored = Stores.ROS1_NOETIC
    _time = "time"

    def _own_name(self, name: str) -> str:
        return "rosgraph_msgs/msg/Log" if name == LOG else name

    def _message_type(self, name: str) -> MessageType:
        definition, _ = self._store.generate_msgdef(name, ros_version=1)
        return MessageType(name.replace("/msg/", "/"), "ros1msg", definition.encode(), "ros1")

    def own_terms(self, message: Described) -> Literal:
        """See `Encoding.own_terms`."""
        literal = message.literal
        if message.name != LOG:
            return literal
        # Levels of ROS 1 are powers of two, those of ROS 2 tens.
        level = 1 << (literal["level"] // 10 - 1)
        return {**literal, "level": level, "header": {"stamp": literal["stamp"]}}

    def serialise(self, name: str, literal: Literal) -> bytes:
        """See `Encoding.serialise`."""
        name = self._own_name(name)
        return bytes(self._store.serialize_ros1(self._made(name, literal), name))


class Ros2Texts(Ros2Encoding):
    """Texts alone, without the types of a distribution, which take long to load."""

    def __init__(self) -> None:
        self._store = get_typestore(Stores.EMPTY)
        self._store.register(get_types_from_msg("string data", STRING))
        self.types = {STRING: self._message_type(STRING)}


class Ros1Texts(Ros2Texts, Ros1Encoding):
    """The same for ROS 1."""
