"""Recordings to compare, written by the mcap library."""

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate
from google.protobuf.descriptor import FileDescriptor
from google.protobuf.descriptor_pb2 import FileDescriptorSet
from mcap.writer import CompressionType, IndexType, Writer
from rosbags.typesys import Stores, get_typestore
from rosbags.typesys.store import Typestore

START = 1_700_000_000_000_000_000
STEP = 1_000_000
ODOMETRY = "nav_msgs/msg/Odometry"


@dataclass(frozen=True)
class Kind:
    """What a channel says of its messages."""

    encoding: str
    name: str = ""
    schema_encoding: str = ""
    schema: bytes = b""


@dataclass(frozen=True)
class Message:
    topic: str
    time: int
    data: bytes
    publish_time: int | None = None


@dataclass(frozen=True)
class Packing:
    """How a file is written, which must not matter."""

    compression: CompressionType = CompressionType.ZSTD
    chunk_size: int = 1 << 20
    chunked: bool = True
    indexes: IndexType = IndexType.ALL
    summary: bool = True


@dataclass(frozen=True)
class Recording:
    kinds: Mapping[str, Kind]
    messages: Sequence[Message]
    metadata: Mapping[str, dict[str, str]] = field(default_factory=dict)
    attachments: Mapping[str, bytes] = field(default_factory=dict)
    profile: str = "ros1"

    def write(self, path: Path, packing: Packing = Packing()) -> Path:
        with path.open("wb") as file:
            writer = Writer(
                file,
                packing.chunk_size,
                packing.compression,
                packing.indexes,
                use_chunking=packing.chunked,
                use_statistics=packing.summary,
                repeat_channels=packing.summary,
                repeat_schemas=packing.summary,
                # So that a test can tamper with the summary.
                enable_crcs=False,
            )
            writer.start(self.profile, "a test")
            channels = {topic: register(writer, topic, kind) for topic, kind in self.kinds.items()}
            for message in self.messages:
                published = message.publish_time
                writer.add_message(
                    channels[message.topic],
                    message.time,
                    message.data,
                    message.time if published is None else published,
                )
            for name, values in self.metadata.items():
                writer.add_metadata(name, values)
            for name, data in self.attachments.items():
                writer.add_attachment(0, 0, name, "text/plain", data)
            writer.finish()
        return path


def register(writer: Writer, topic: str, kind: Kind) -> int:
    schema = 0
    if kind.name:
        schema = writer.register_schema(kind.name, kind.schema_encoding, kind.schema)
    return writer.register_channel(topic, kind.encoding, schema)


@cache
def ros_store(version: int) -> Typestore:
    return get_typestore(Stores.ROS1_NOETIC if version == 1 else Stores.ROS2_HUMBLE)


@cache
def ros_kind(version: int) -> Kind:
    store = ros_store(version)
    text, _ = store.generate_msgdef(ODOMETRY, ros_version=version)
    if version == 1:
        return Kind("ros1", "nav_msgs/Odometry", "ros1msg", text.encode())
    return Kind("cdr", ODOMETRY, "ros2msg", text.encode())


def odometry(
    version: int,
    position: tuple[float, float, float] = (1.0, 2.0, 3.0),
    orientation: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 1.0),
    frame: str = "world",
    covariance: float = 0.0,
) -> bytes:
    store = ros_store(version)
    make: Mapping[str, Any] = store.types
    stamp = make["builtin_interfaces/msg/Time"](5, 6)
    header = make["std_msgs/msg/Header"](*([7] if version == 1 else []), stamp, frame)
    pose = make["geometry_msgs/msg/Pose"](
        make["geometry_msgs/msg/Point"](*position),
        make["geometry_msgs/msg/Quaternion"](*orientation),
    )
    zero = make["geometry_msgs/msg/Vector3"](0.0, 0.0, 0.0)
    twist = make["geometry_msgs/msg/Twist"](zero, zero)
    message = make[ODOMETRY](
        header,
        "base_link",
        make["geometry_msgs/msg/PoseWithCovariance"](pose, np.full(36, covariance)),
        make["geometry_msgs/msg/TwistWithCovariance"](twist, np.zeros(36)),
    )
    serialize = store.serialize_ros1 if version == 1 else store.serialize_cdr
    return bytes(serialize(message, ODOMETRY))


def file_set(file: FileDescriptor, *, last_first: bool = False) -> bytes:
    files: dict[str, FileDescriptor] = {}

    def visit(one: FileDescriptor) -> None:
        for dependency in one.dependencies:
            visit(dependency)
        files.setdefault(one.name, one)

    visit(file)
    result = FileDescriptorSet()
    for one in reversed(files.values()) if last_first else files.values():
        one.CopyToProto(result.file.add())
    return result.SerializeToString()


SCENE = Kind("protobuf", "foxglove.SceneUpdate", "protobuf", file_set(SceneUpdate.DESCRIPTOR.file))
JSON = Kind("json", "Load", "jsonschema", b'{"type": "object"}')
RAW = Kind("cbor", "Thing", "cddl", b"thing = any")


def scene(z: float = 0.0213, *, sign: float = 1.0, entity: str = "front_left") -> bytes:
    update: Any = SceneUpdate()
    one = update.entities.add(id=entity, frame_id="world")
    arrow = one.arrows.add(shaft_length=0.5)
    arrow.pose.position.z = z
    arrow.pose.orientation.y = 0.6 * sign
    arrow.pose.orientation.w = 0.8 * sign
    data: bytes = update.SerializeToString()
    return data


def odometry_with_height(version: int, z: float) -> bytes:
    return odometry(version, (1.0, 2.0, z))


def load_with_force(z: float) -> bytes:
    return json.dumps({"force": [z], "in_contact": True}).encode()


WITH_NUMBER: Mapping[str, tuple[Kind, Callable[[float], bytes], str]] = {
    "ros1": (ros_kind(1), lambda z: odometry_with_height(1, z), "pose.pose.position.z"),
    "cdr": (ros_kind(2), lambda z: odometry_with_height(2, z), "pose.pose.position.z"),
    "protobuf": (SCENE, scene, "entities[0].arrows[0].pose.position.z"),
    "json": (JSON, load_with_force, "force[0]"),
}
"""By encoding: a kind of message, one with a given number in it, and where the number is."""


def recording(kinds: Mapping[str, Kind], *messages: tuple[str, int, bytes]) -> Recording:
    return Recording(kinds, [Message(t, START + time * STEP, data) for t, time, data in messages])


def one_topic(kind: Kind, *payloads: bytes) -> Recording:
    return recording({"/a": kind}, *(("/a", time, data) for time, data in enumerate(payloads)))


def mixed(count: int = 50) -> Recording:
    kinds = {"/odom": ros_kind(1), "/scene": SCENE, "/load": JSON, "/raw": RAW, "/silent": JSON}
    messages = [
        message
        for i in range(count)
        for message in (
            ("/odom", i, odometry(1, (float(i), 0.0, 0.0))),
            ("/scene", i, scene(i / 7)),
            ("/scene", i, scene(i / 9)),
            ("/load", i + 1, load_with_force(i / 3)),
            ("/raw", 2 * i, bytes(range(i % 7))),
        )
    ]
    whole = recording(kinds, *messages)
    return replace(
        whole,
        metadata={"dogbot_logtool": {"version": "1", "style": "force"}},
        attachments={"notes": b"wet floor"},
    )
