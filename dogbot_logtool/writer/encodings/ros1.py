"""Annotations as ROS 1 messages."""

from collections.abc import Mapping
from typing import Any

from rosbags.typesys import Stores

from dogbot_logtool.core.events.event import Level
from dogbot_logtool.writer.encodings.encoding import MessageType
from dogbot_logtool.writer.encodings.ros import TF, RosEncoding
from dogbot_logtool.writer.template import Number


class Ros1Encoding(RosEncoding):
    """ROS 1 serialisation, definitions of Noetic."""

    distribution = Stores.ROS1_NOETIC
    definitions = {TF: "geometry_msgs/TransformStamped[] transforms"}  # noqa: RUF012
    load_definition = RosEncoding.load_definition.replace("builtin_interfaces/Time", "time")
    gait_definition = RosEncoding.gait_definition.replace("builtin_interfaces/Time", "time")
    log_name = "rosgraph_msgs/msg/Log"
    log_levels = {Level.DEBUG: 1, Level.INFO: 2, Level.WARNING: 4, Level.ERROR: 8}  # noqa: RUF012

    def _message_type(self, name: str) -> MessageType:
        definition, _ = self._store.generate_msgdef(name)
        return MessageType(name.replace("/msg/", "/"), "ros1msg", definition.encode(), "ros1")

    def _serialise(self, message: Any, name: str) -> bytes:  # noqa: ANN401
        return bytes(self._store.serialize_ros1(message, name))

    def _header_extras(self) -> Mapping[str, Any]:
        return {"seq": 0}

    def _log_extras(self, stamp: Mapping[str, Number]) -> Mapping[str, Any]:
        return {"header": self.header("", stamp), "topics": []}

    def _marker_extras(self) -> Mapping[str, Any]:
        return {}
