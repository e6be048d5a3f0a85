"""The message that holds the robot's description, a `std_msgs/String`, in ROS' two encodings."""

import struct
from typing import Final

from dogbot_logtool.writer.encodings.encoding import MessageType

_DEFINITION: Final = b"string data\n"
_CDR_HEAD: Final = b"\x00\x01\x00\x00"
"""Little-endian CDR."""


def description_type(profile: str) -> MessageType:
    """Return the type: ROS 1 in files with that profile, else CDR."""
    if profile == "ros1":
        return MessageType("std_msgs/String", "ros1msg", _DEFINITION, "ros1")
    return MessageType("std_msgs/msg/String", "ros2msg", _DEFINITION, "cdr")


def description_message(urdf: str, kind: MessageType) -> bytes:
    """Serialise a description."""
    text = urdf.encode()
    if kind.message_encoding == "ros1":
        return struct.pack("<I", len(text)) + text
    return _CDR_HEAD + struct.pack("<I", len(text) + 1) + text + b"\x00"
