"""The work of `dogbot-logtool convert`, written plainly with the libraries, message by message.

Every recorded message is copied, every odometry message at a tick becomes a FrameTransforms, every
contact message a SceneUpdate and a load. This is what one would write without this project.

    python benchmarks/library_convert.py IN.bag|IN.mcap OUT.mcap
"""

import json
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms
from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate
from google.protobuf.descriptor_pb2 import FileDescriptorSet
from mcap.reader import make_reader
from mcap.writer import CompressionType, Writer
from rosbags.rosbag1 import Reader
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

Recorded = tuple[str, str, str, str, int, bytes]
"""Topic, type, definition, message encoding, log time, payload."""


def bag_messages(path: Path) -> Iterator[Recorded]:
    """Yield a bag's messages."""
    with Reader(path) as reader:
        for connection, time, payload in reader.messages():
            kind, text = connection.msgtype, connection.msgdef.data
            yield connection.topic, kind, text, "ros1", time, payload


def mcap_messages(path: Path) -> Iterator[Recorded]:
    """Yield an MCAP's messages."""
    with path.open("rb") as file:
        for schema, channel, message in make_reader(file).iter_messages(log_time_order=False):
            assert schema is not None  # noqa: S101
            kind = schema.name if "/msg/" in schema.name else schema.name.replace("/", "/msg/")
            text, time = schema.data.decode(), message.log_time
            yield channel.topic, kind, text, channel.message_encoding, time, message.data


def descriptors(kind: Any) -> bytes:  # noqa: ANN401
    """Return a message type's schema."""
    files = FileDescriptorSet()
    seen: set[str] = set()

    def add(file: Any) -> None:  # noqa: ANN401
        for dependency in file.dependencies:
            if dependency.name not in seen:
                add(dependency)
        seen.add(file.name)
        file.CopyToProto(files.file.add())

    add(kind.DESCRIPTOR.file)
    return files.SerializeToString()


def wavelength_colour(load: float) -> tuple[float, float, float]:
    """Return the colour of a load, N."""
    w = min(max(380.0 + load / 200.0 * 370.0, 380.0), 750.0)
    if w <= 440:
        a = 0.3 + 0.7 * (w - 380) / 60
        return ((440 - w) / 60 * a) ** 0.8, 0.0, a**0.8
    if w <= 490:
        return 0.0, ((w - 440) / 50) ** 0.8, 1.0
    if w <= 510:
        return 0.0, 1.0, ((510 - w) / 20) ** 0.8
    if w <= 580:
        return ((w - 510) / 70) ** 0.8, 1.0, 0.0
    if w <= 645:
        return 1.0, ((645 - w) / 65) ** 0.8, 0.0
    return (0.3 + 0.7 * (750 - w) / 105) ** 0.8, 0.0, 0.0


def arrow(message: Any, foot: str) -> tuple[bytes, float]:  # noqa: ANN401
    """Return the arrow of a contact message, and its load, N."""
    update = SceneUpdate()
    stamp = message.header.stamp
    states = message.states
    if not states:
        deletion = update.deletions.add(id=foot)
        deletion.timestamp.seconds, deletion.timestamp.nanos = stamp.sec, stamp.nanosec
        return update.SerializeToString(), 0.0
    last = states[-1].info.rpartition("time:")[2]
    force, point, weight = np.zeros(3), np.zeros(3), 0.0
    for state in states:
        if state.info.rpartition("time:")[2] != last:
            continue
        total = state.total_wrench.force
        force += (total.x, total.y, total.z)
        for wrench, position in zip(state.wrenches, state.contact_positions, strict=True):
            f = wrench.force
            share = (f.x * f.x + f.y * f.y + f.z * f.z) ** 0.5
            point += np.array((position.x, position.y, position.z)) * share
            weight += share
    load = float(np.sqrt((force * force).sum()))
    entity = update.entities.add(id=foot, frame_id="world")
    entity.timestamp.seconds, entity.timestamp.nanos = stamp.sec, stamp.nanosec
    entity.lifetime.nanos = 500_000_000
    one = entity.arrows.add(shaft_diameter=0.04, head_diameter=0.08)
    one.shaft_length, one.head_length = 0.77 * load / 100, 0.23 * load / 100
    place = one.pose.position
    place.x, place.y, place.z = (point / weight).tolist()
    one.pose.orientation.y, one.pose.orientation.w = -(0.5**0.5), 0.5**0.5
    colour = one.color
    colour.r, colour.g, colour.b = wavelength_colour(load)
    colour.a = 1.0
    return update.SerializeToString(), load


def main(source: Path, target: Path) -> None:
    """Convert a log."""
    store = get_typestore(Stores.EMPTY)
    recorded = mcap_messages(source) if source.suffix == ".mcap" else bag_messages(source)
    channels: dict[str, int] = {}
    extra: dict[str, int] = {}
    tick = None
    with target.open("wb") as file:
        writer = Writer(file, compression=CompressionType.ZSTD)
        writer.start(profile="ros1", library="library_convert")
        scene = writer.register_schema("foxglove.SceneUpdate", "protobuf", descriptors(SceneUpdate))
        frames = writer.register_schema(
            "foxglove.FrameTransforms", "protobuf", descriptors(FrameTransforms)
        )
        load_schema = writer.register_schema("Load", "jsonschema", b'{"type": "object"}')

        def added(topic: str, encoding: str, schema: int) -> int:
            if topic not in extra:
                extra[topic] = writer.register_channel(topic, encoding, schema)
            return extra[topic]

        for topic, kind, text, encoding, time, payload in recorded:
            if topic not in channels:
                store.register(get_types_from_msg(text, kind))
                schema = writer.register_schema(kind, f"{encoding}msg", text.encode())
                channels[topic] = writer.register_channel(topic, encoding, schema)
            writer.add_message(channels[topic], time, payload, time)
            read = store.deserialize_ros1 if encoding == "ros1" else store.deserialize_cdr
            if kind.endswith("/Odometry"):
                message: Any = read(payload, kind)
                stamp = message.header.stamp
                now = (stamp.sec * 10**9 + stamp.nanosec) // 20_000_000
                if now == tick:
                    continue
                tick = now
                out = FrameTransforms()
                one = out.transforms.add(parent_frame_id="world", child_frame_id="base_link")
                one.timestamp.seconds, one.timestamp.nanos = stamp.sec, stamp.nanosec
                p, q = message.pose.pose.position, message.pose.pose.orientation
                one.translation.x, one.translation.y, one.translation.z = p.x, p.y, p.z
                turn = one.rotation
                turn.x, turn.y, turn.z, turn.w = q.x, q.y, q.z, q.w
                channel = added("/tf", "protobuf", frames)
                writer.add_message(channel, time, out.SerializeToString(), time)
            elif kind.endswith("/ContactsState"):
                foot = topic.removeprefix("/dogbot/").removesuffix("_contactsensor_state")
                data, load = arrow(read(payload, kind), foot)
                channel = added(f"/marker_basic_{foot}_foot", "protobuf", scene)
                writer.add_message(channel, time, data, time)
                text_load = json.dumps({"in_contact": load > 0, "force": load}).encode()
                channel = added(f"/load/{foot}", "json", load_schema)
                writer.add_message(channel, time, text_load, time)
        writer.finish()


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
