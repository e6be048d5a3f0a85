"""Annotations as ROS 2 messages."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from rosbags.typesys import Stores

from dogbot_logtool.core.events.event import Level
from dogbot_logtool.writer.encodings.encoding import MessageType
from dogbot_logtool.writer.encodings.ros import RosEncoding
from dogbot_logtool.writer.template import Number


class Ros2Encoding(RosEncoding):
    """CDR, definitions of Humble; those of later distributions are the same."""

    distribution = Stores.ROS2_HUMBLE
    log_name = "rcl_interfaces/msg/Log"
    log_levels = {Level.DEBUG: 10, Level.INFO: 20, Level.WARNING: 30, Level.ERROR: 40}  # noqa: RUF012

    def _message_type(self, name: str) -> MessageType:
        definition, _ = self._store.generate_msgdef(name, ros_version=2)
        return MessageType(name, "ros2msg", definition.encode(), "cdr")

    def _serialise(self, message: Any, name: str) -> bytes:  # noqa: ANN401
        return bytes(self._store.serialize_cdr(message, name, little_endian=True))

    def _header_extras(self) -> Mapping[str, Any]:
        return {}

    def _log_extras(self, stamp: Mapping[str, Number]) -> Mapping[str, Any]:
        return {"stamp": self.time_of(stamp)}

    def _marker_extras(self) -> Mapping[str, Any]:
        nothing = np.empty(0, np.uint8)
        texture = self.make(
            "sensor_msgs/msg/CompressedImage",
            header=self.header("", {"stamp.sec": 0, "stamp.nanosec": 0}),
            format="",
            data=nothing,
        )
        mesh = self.make("visualization_msgs/msg/MeshFile", filename="", data=nothing)
        return {
            "texture_resource": "",
            "texture": texture,
            "uv_coordinates": [],
            "mesh_file": mesh,
        }
