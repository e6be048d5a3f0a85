"""One ROS 1 bag written anew: in every container, with chunks of any size, in any order."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final, Literal

from mcap.writer import CompressionType
from mcap.writer import Writer as McapWriter
from rosbags.rosbag1 import Reader
from rosbags.rosbag1 import Writer as BagWriter
from rosbags.rosbag2 import Writer as Rosbag2Writer
from rosbags.rosbag2.enums import StoragePlugin
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore

from tests.oracles.walks import write_rows

BLOCK: Final = 97
"""Messages that change places with as many others where a file is out of order."""


@dataclass(frozen=True, slots=True)
class Message:
    """A recorded message, as ROS 1 and as CDR."""

    topic: str
    kind: str
    log_time: int
    ros1: bytes
    cdr: bytes


@dataclass(frozen=True, slots=True)
class Recorded:
    """The messages of a bag, and their types."""

    messages: tuple[Message, ...]
    types: Typestore
    described: Mapping[str, tuple[str, str]]
    """ROS 1 definition and its checksum, by topic."""

    @property
    def channels(self) -> dict[str, str]:
        """Type by topic."""
        return {message.topic: message.kind for message in self.messages}

    def out_of_order(self) -> "Recorded":
        """Return the same messages as a recorder of several threads may write them."""
        blocks = [
            self.messages[first : first + BLOCK] for first in range(0, len(self.messages), BLOCK)
        ]
        for first in range(0, len(blocks) - 1, 2):
            blocks[first : first + 2] = blocks[first + 1], blocks[first]
        messages = tuple(message for block in blocks for message in block)
        return replace(self, messages=messages)


def read_bag(path: Path) -> Recorded:
    """Read a ROS 1 bag with its own definitions."""
    types = get_typestore(Stores.ROS2_HUMBLE)
    described: dict[str, tuple[str, str]] = {}
    with Reader(path) as reader:
        for connection in reader.connections:
            described[connection.topic] = connection.msgdef.data, connection.digest
            found = get_types_from_msg(connection.msgdef.data, connection.msgtype)
            types.register({n: each for n, each in found.items() if n not in types.fielddefs})
        messages = tuple(
            Message(
                connection.topic,
                connection.msgtype,
                time,
                bytes(data),
                bytes(types.ros1_to_cdr(data, connection.msgtype)),
            )
            for connection, time, data in reader.messages()
        )
    return Recorded(messages, types, described)


def write_bag(path: Path, recorded: Recorded, compression: str, chunk_bytes: int) -> Path:
    """Write a ROS 1 bag; no compression is the empty string."""
    writer = BagWriter(path)
    if compression:
        writer.set_compression(BagWriter.CompressionFormat[compression.upper()])
    writer.chunk_threshold = chunk_bytes
    with writer:
        connections = {
            topic: writer.add_connection(topic, kind, msgdef=text, md5sum=digest)
            for topic, kind in recorded.channels.items()
            for text, digest in [recorded.described[topic]]
        }
        for message in recorded.messages:
            writer.write(connections[message.topic], message.log_time, message.ros1)
    return path


def write_mcap(
    path: Path, recorded: Recorded, profile: Literal["ros1", "ros2"], chunk_bytes: int
) -> Path:
    """Write an MCAP of ROS 1 or of ROS 2 messages."""
    is_ros2 = profile == "ros2"
    with path.open("wb") as file:
        writer = McapWriter(file, chunk_bytes, CompressionType.ZSTD)
        writer.start(profile=profile, library="tests")
        channels = {}
        for topic, kind in recorded.channels.items():
            text = recorded.described[topic][0]
            if is_ros2:
                text = recorded.types.generate_msgdef(kind, ros_version=2)[0]
            name = kind if is_ros2 else kind.replace("/msg/", "/")
            schema = writer.register_schema(name, f"{profile}msg", text.encode())
            encoding = "cdr" if is_ros2 else "ros1"
            channels[topic] = writer.register_channel(topic, encoding, schema)
        for message in recorded.messages:
            data = message.cdr if is_ros2 else message.ros1
            time = message.log_time
            writer.add_message(channels[message.topic], time, data, time)
        writer.finish()
    return path


def write_rosbag2(path: Path, recorded: Recorded, plugin: StoragePlugin) -> Path:
    """Write the folder of a ROS 2 bag."""
    with Rosbag2Writer(path, version=9, storage_plugin=plugin) as writer:
        rows = ((each.log_time, each.topic, each.kind, each.cdr) for each in recorded.messages)
        write_rows(writer, recorded.types, rows)
    return path
