"""Annotations that a file has, read and decoded by the mcap library."""

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final
from xml.etree import ElementTree as ET

import numpy as np
from mcap import records
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory as ProtobufDecoders
from mcap_ros1.decoder import DecoderFactory as Ros1Decoders
from mcap_ros2.decoder import DecoderFactory as Ros2Decoders

from tests.oracles.conversion import Arrow, Load, Pose
from tests.oracles.frames import numbers_of
from tests.oracles.recorded import DESCRIPTION, S, arrow_topic, load_topic

ENCODED: Final = {"foxglove": "protobuf", "ros1": "ros1", "ros2": "cdr"}
"""Message encoding of each output encoding."""


def _decoders() -> Mapping[str, Any]:
    """Return the libraries' decoders; they remember schemas by id, so every file needs its own."""
    return {"protobuf": ProtobufDecoders(), "ros1": Ros1Decoders(), "cdr": Ros2Decoders()}


@dataclass(slots=True)
class Written:
    """A file that was written, as the mcap library reads it by its index."""

    profile: str
    schemas: dict[int, records.Schema]
    channels: dict[int, records.Channel]
    statistics: records.Statistics
    messages: list[records.Message]
    attachments: list[records.Attachment]
    metadata: list[records.Metadata]
    chunk_compressions: list[str]
    decoders: Mapping[str, Any] = field(default_factory=_decoders)

    def decode(self, schema: records.Schema, message: records.Message, encoding: str) -> Any:
        decoder = self.decoders[encoding].decoder_for(encoding, schema)
        assert decoder is not None
        return decoder(message.data)

    def encodings(self, topic: str) -> set[str]:
        return {c.message_encoding for c in self.channels.values() if c.topic == topic}

    def of(self, topic: str, encoding: str) -> list[tuple[records.Schema, records.Message]]:
        """Return a topic's messages of one encoding, in the order of their log times."""
        schemas = {
            channel.id: self.schemas[channel.schema_id]
            for channel in self.channels.values()
            if channel.topic == topic and channel.message_encoding == encoding
        }
        found = [message for message in self.messages if message.channel_id in schemas]
        found.sort(key=lambda message: message.log_time)
        return [(schemas[message.channel_id], message) for message in found]

    def decoded(self, topic: str) -> list[tuple[int, Any]]:
        """Return log times, ns, and messages of a topic in any encoding, in the order of time."""
        return [
            (message.log_time, self.decode(schema, message, encoding))
            for encoding in sorted(self.encodings(topic))
            for schema, message in self.of(topic, encoding)
        ]

    @property
    def topics(self) -> Counter[str]:
        """Messages by topic; a channel may have none."""
        found: Counter[str] = Counter()
        for channel in self.channels.values():
            found[channel.topic] += self.statistics.channel_message_counts.get(channel.id, 0)
        return found


def read_written(path: Path) -> Written:
    """Read a file and let the library check the checksums of the chunks."""
    with path.open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True)
        summary = reader.get_summary()
        assert summary is not None
        assert summary.statistics is not None
        written = Written(
            reader.get_header().profile,
            summary.schemas,
            summary.channels,
            summary.statistics,
            [message for *_, message in reader.iter_messages(log_time_order=False)],
            list(reader.iter_attachments()),
            list(reader.iter_metadata()),
            [chunk.compression for chunk in summary.chunk_indexes],
        )
    counts = Counter(message.channel_id for message in written.messages)
    assert written.statistics.message_count == len(written.messages)
    assert written.statistics.channel_message_counts == counts
    return written


def annotations(
    written: Written, topic: str, encoding: str, type_name: str
) -> Iterator[tuple[records.Message, Any]]:
    """Decode the annotations of a topic."""
    for schema, message in written.of(topic, ENCODED[encoding]):
        assert schema.name.replace("/msg/", "/") == type_name
        assert ("/msg/" in schema.name) == (encoding == "ros2")
        assert message.publish_time == message.log_time
        yield message, written.decode(schema, message, ENCODED[encoding])


def stamp_of(stamp: Any) -> int:
    """Return the ns of a stamp of any encoding."""
    for seconds, rest in (("seconds", "nanos"), ("secs", "nsecs"), ("sec", "nanosec")):
        if hasattr(stamp, seconds):
            return int(getattr(stamp, seconds)) * S + int(getattr(stamp, rest))
    raise TypeError(type(stamp))


def written_transforms(
    written: Written, topic: str, encoding: str
) -> Iterator[tuple[list[tuple[str, str]], list[Pose]]]:
    """Yield the frames (parent, child) and the poses of each message."""
    is_ros = encoding != "foxglove"
    kind = "tf2_msgs/TFMessage" if is_ros else "foxglove.FrameTransforms"
    for message, one in annotations(written, topic, encoding, kind):
        names, poses = [], []
        for each in one.transforms:
            parent = each.header.frame_id if is_ros else each.parent_frame_id
            stamp = stamp_of(each.header.stamp if is_ros else each.timestamp)
            at = each.transform if is_ros else each
            names.append((parent, each.child_frame_id))
            poses.append(Pose(message.log_time, stamp, numbers_of(at.translation, at.rotation)))
        yield names, poses


def written_poses(written: Written, topic: str, encoding: str) -> list[Pose]:
    """Return the base's poses; the log may have transforms of its own on the topic."""
    poses: list[Pose] = []
    for names, transforms in written_transforms(written, topic, encoding):
        if ("world", "base_link") in names:
            (pose,) = transforms
            poses.append(pose)
    return poses


def written_arrows(written: Written, foot: str, encoding: str, style: str) -> list[Arrow]:
    kind = "foxglove.SceneUpdate" if encoding == "foxglove" else "visualization_msgs/Marker"
    found = annotations(written, arrow_topic(foot), encoding, kind)
    read = _entity_arrow if encoding == "foxglove" else _marker_arrow
    return [read(message.log_time, one, foot, style) for message, one in found]


def _looks(style: str) -> tuple[float, int]:
    """Return the diameter of shafts, m, and how long arrows stay, ns."""
    return (0.1, 0) if style == "classic" else (0.04, S // 2)


def _entity_arrow(log_time: int, update: Any, foot: str, style: str) -> Arrow:
    assert len(update.entities) + len(update.deletions) == 1
    for deletion in update.deletions:
        assert (deletion.id, deletion.type) == (foot, 0)
        return Arrow(log_time, stamp_of(deletion.timestamp))
    (entity,) = update.entities
    (one,) = entity.arrows
    diameter, lifetime = _looks(style)
    assert (entity.id, entity.frame_id) == (foot, "world")
    assert stamp_of(entity.lifetime) == lifetime
    assert (one.shaft_diameter, one.head_diameter) == (diameter, 2 * diameter)
    length = one.shaft_length + one.head_length
    np.testing.assert_allclose(one.shaft_length, 0.77 * length, rtol=1e-14)
    return _arrow(log_time, entity.timestamp, one, length)


def _marker_arrow(log_time: int, one: Any, _foot: str, style: str) -> Arrow:
    assert (one.ns, one.id, one.header.frame_id) == ("dogbot", 0, "world")
    if one.action == 2:
        return Arrow(log_time, stamp_of(one.header.stamp))
    diameter, lifetime = _looks(style)
    assert (one.type, one.action, one.frame_locked) == (0, 0, False)
    assert (one.scale.y, one.scale.z) == (diameter, diameter)
    assert stamp_of(one.lifetime) == lifetime
    return _arrow(log_time, one.header.stamp, one, one.scale.x)


def _arrow(log_time: int, stamp: Any, one: Any, length: float) -> Arrow:
    numbers = numbers_of(one.pose.position, one.pose.orientation)
    colour = one.color.r, one.color.g, one.color.b, one.color.a
    return Arrow(log_time, stamp_of(stamp), numbers[:3], numbers[3:], length, colour)


def described_robots(written: Written) -> list[tuple[int, str]]:
    """Return log time and root's name of the robot's descriptions."""
    robots: list[tuple[int, str]] = []
    for encoding in sorted(written.encodings(DESCRIPTION)):
        for schema, message in written.of(DESCRIPTION, encoding):
            assert schema.name.replace("/msg/", "/") == "std_msgs/String"
            assert ("/msg/" in schema.name) == (encoding == "cdr")
            assert message.publish_time == message.log_time
            root = ET.fromstring(written.decode(schema, message, encoding).data)  # noqa: S314 - ours
            assert root.tag == "robot"
            robots.append((message.log_time, root.attrib["name"]))
    return robots


def written_loads(written: Written, foot: str, encoding: str) -> list[Load]:
    loads: list[Load] = []
    type_name = "dogbot_logtool.Load" if encoding == "foxglove" else "dogbot_logtool/Load"
    for message, one in annotations(written, load_topic(foot), encoding, type_name):
        stamp = stamp_of(one.timestamp if encoding == "foxglove" else one.stamp)
        assert encoding != "foxglove" or one.HasField("in_contact")
        felt = bool(one.in_contact), one.force, one.force_bw, one.state
        loads.append(Load(message.log_time, stamp, *felt))
    return loads


def arrows(path: Path) -> Iterator[tuple[str, int, Any]]:
    """Yield topic, log time in ns, and marker of the arrows that are shown."""
    written = read_written(path)
    for topic in written.topics:
        for log_time, marker in written.decoded(topic) if "marker" in topic else ():
            if marker.action == 0:
                yield topic, log_time, marker
