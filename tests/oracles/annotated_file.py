"""Annotations that a file has, read and decoded by the mcap library."""

from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np
from mcap import records
from mcap.reader import make_reader
from mcap.stream_reader import StreamReader
from mcap_protobuf.decoder import DecoderFactory as ProtobufDecoders
from mcap_ros1.decoder import DecoderFactory as Ros1Decoders
from mcap_ros2.decoder import DecoderFactory
from mcap_ros2.decoder import DecoderFactory as Ros2Decoders

from tests.oracles.conversion import (
    Arrow,
    Load,
    Pose,
    xyz,
)
from tests.oracles.recorded import (
    DESCRIPTION,
    S,
    arrow_topic,
    load_topic,
)


@dataclass(slots=True)
class Written:
    """A file that was written, as the mcap library reads it from front to back."""

    profile: str = ""
    schemas: dict[int, records.Schema] = field(default_factory=dict)
    channels: dict[int, records.Channel] = field(default_factory=dict)
    messages: list[records.Message] = field(default_factory=list)
    rows: dict[int, list[int]] = field(default_factory=lambda: defaultdict(list))
    """Of each channel, where its messages stand among all."""
    attachments: list[records.Attachment] = field(default_factory=list)
    metadata: list[records.Metadata] = field(default_factory=list)
    statistics: records.Statistics | None = None
    chunk_compressions: list[str] = field(default_factory=list)
    decoders: Mapping[str, Any] = field(
        default_factory=lambda: {
            "protobuf": ProtobufDecoders(),
            "ros1": Ros1Decoders(),
            "cdr": Ros2Decoders(),
        }
    )
    """The libraries' decoders; they remember schemas by id, so every file needs its own."""

    def decode(self, schema: records.Schema, message: records.Message, encoding: str) -> Any:
        decoder = self.decoders[encoding].decoder_for(encoding, schema)
        assert decoder is not None
        return decoder(message.data)

    def encodings(self, topic: str) -> set[str]:
        return {c.message_encoding for c in self.channels.values() if c.topic == topic}

    def recorded(self) -> dict[int, records.Channel]:
        """Return the channels of ROS messages, but for the robot's description, which is ours."""
        return {
            number: channel
            for number, channel in self.channels.items()
            if channel.message_encoding in {"ros1", "cdr"} and channel.topic != DESCRIPTION
        }

    def of(self, topic: str, encoding: str) -> list[tuple[records.Schema, records.Message]]:
        """Return a topic's messages of one encoding, in the order of their log times."""
        rows = sorted(
            row
            for channel in self.channels.values()
            if channel.topic == topic and channel.message_encoding == encoding
            for row in self.rows[channel.id]
        )
        found = sorted((self.messages[row] for row in rows), key=lambda one: one.log_time)
        return [(self.schemas[self.channels[one.channel_id].schema_id], one) for one in found]

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
        found = Counter({channel.topic: 0 for channel in self.channels.values()})
        for number, rows in self.rows.items():
            found[self.channels[number].topic] += len(rows)
        return found


def read_written(path: Path) -> Written:
    """Read a file and let the library check its checksums, those of the chunks included."""
    written = Written()
    with path.open("rb") as stream:
        for record in StreamReader(stream, validate_crcs=True).records:
            match record:
                case records.Header():
                    written.profile = record.profile
                case records.Schema():
                    written.schemas[record.id] = record
                case records.Channel():
                    written.channels[record.id] = record
                case records.Message():
                    written.rows[record.channel_id].append(len(written.messages))
                    written.messages.append(record)
                case records.Attachment():
                    written.attachments.append(record)
                case records.Metadata():
                    written.metadata.append(record)
                case records.Statistics():
                    written.statistics = record
                case records.ChunkIndex():
                    written.chunk_compressions.append(record.compression)
                case _:
                    pass
    assert written.statistics is not None
    assert written.statistics.message_count == len(written.messages)
    counts = {number: len(rows) for number, rows in written.rows.items()}
    assert written.statistics.channel_message_counts == counts
    return written


def of_encoding(encoding: str) -> str:
    return {"foxglove": "protobuf", "ros1": "ros1", "ros2": "cdr"}[encoding]


def annotations(
    written: Written, topic: str, encoding: str, type_name: str
) -> Iterator[tuple[records.Message, Any]]:
    """Decode the annotations of a topic."""
    for schema, message in written.of(topic, of_encoding(encoding)):
        assert schema.name.replace("/msg/", "/") == type_name
        assert ("/msg/" in schema.name) == (encoding == "ros2")
        assert message.publish_time == message.log_time
        yield message, written.decode(schema, message, of_encoding(encoding))


def protobuf_time(stamp: Any) -> int:
    return int(stamp.seconds) * S + int(stamp.nanos)


def ros_time(stamp: Any) -> int:
    if hasattr(stamp, "nanosec"):
        return int(stamp.sec) * S + int(stamp.nanosec)
    return int(stamp.secs) * S + int(stamp.nsecs)


def numbers_of(place: Any, turn: Any) -> tuple[float, ...]:
    return (*xyz(place), float(turn.x), float(turn.y), float(turn.z), float(turn.w))


def written_poses(written: Written, topic: str, encoding: str) -> list[Pose]:
    poses: list[Pose] = []
    if encoding == "foxglove":
        for message, decoded in annotations(written, topic, encoding, "foxglove.FrameTransforms"):
            (one,) = decoded.transforms
            assert (one.parent_frame_id, one.child_frame_id) == ("world", "base_link")
            numbers = numbers_of(one.translation, one.rotation)
            poses.append(Pose(message.log_time, protobuf_time(one.timestamp), numbers))
        return poses
    for message, decoded in annotations(written, topic, encoding, "tf2_msgs/TFMessage"):
        (one,) = decoded.transforms[:1]
        if one.child_frame_id == "base_link":
            assert len(decoded.transforms) == 1
            assert one.header.frame_id == "world"
            numbers = numbers_of(one.transform.translation, one.transform.rotation)
            poses.append(Pose(message.log_time, ros_time(one.header.stamp), numbers))
    return poses


def written_arrows(written: Written, foot: str, encoding: str, style: str) -> list[Arrow]:
    if encoding == "foxglove":
        return foxglove_arrows(written, foot, style)
    return marker_arrows(written, foot, encoding, style)


def foxglove_arrows(written: Written, foot: str, style: str) -> list[Arrow]:
    diameter = 0.1 if style == "classic" else 0.04
    arrows: list[Arrow] = []
    topic = arrow_topic(foot)
    for message, decoded in annotations(written, topic, "foxglove", "foxglove.SceneUpdate"):
        assert len(decoded.entities) + len(decoded.deletions) == 1
        for deletion in decoded.deletions:
            assert (deletion.id, deletion.type) == (foot, 0)
            arrows.append(Arrow(message.log_time, protobuf_time(deletion.timestamp)))
        for entity in decoded.entities:
            assert (entity.id, entity.frame_id) == (foot, "world")
            lifetime = entity.lifetime
            assert (lifetime.seconds, lifetime.nanos) == (0, 0 if style == "classic" else S // 2)
            (one,) = entity.arrows
            assert (one.shaft_diameter, one.head_diameter) == (diameter, 2 * diameter)
            length = one.shaft_length + one.head_length
            np.testing.assert_allclose(one.shaft_length, 0.77 * length, rtol=1e-14)
            arrows.append(
                Arrow(
                    message.log_time,
                    protobuf_time(entity.timestamp),
                    xyz(one.pose.position),
                    numbers_of(one.pose.position, one.pose.orientation)[3:],
                    length,
                    (one.color.r, one.color.g, one.color.b, one.color.a),
                )
            )
    return arrows


def marker_arrows(written: Written, foot: str, encoding: str, style: str) -> list[Arrow]:
    diameter = 0.1 if style == "classic" else 0.04
    arrows: list[Arrow] = []
    topic = arrow_topic(foot)
    for message, one in annotations(written, topic, encoding, "visualization_msgs/Marker"):
        assert (one.ns, one.id, one.header.frame_id) == ("dogbot", 0, "world")
        stamp = ros_time(one.header.stamp)
        if one.action == 2:
            arrows.append(Arrow(message.log_time, stamp))
            continue
        assert (one.type, one.action, one.frame_locked) == (0, 0, False)
        assert (one.scale.y, one.scale.z) == (diameter, diameter)
        assert ros_time(one.lifetime) == (0 if style == "classic" else S // 2)
        arrows.append(
            Arrow(
                message.log_time,
                stamp,
                xyz(one.pose.position),
                numbers_of(one.pose.position, one.pose.orientation)[3:],
                one.scale.x,
                (one.color.r, one.color.g, one.color.b, one.color.a),
            )
        )
    return arrows


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
        if encoding == "foxglove":
            stamp = protobuf_time(one.timestamp)
            assert one.HasField("in_contact")
        else:
            stamp = ros_time(one.stamp)
        loads.append(Load(message.log_time, stamp, bool(one.in_contact), one.force, one.force_bw))
    return loads


def arrows(path: Path) -> Iterator[tuple[str, int, Any]]:
    """Yield topic, log time in ns, and marker of the arrows that are shown."""
    with path.open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        for _, channel, message, marker in reader.iter_decoded_messages():
            if "marker" in channel.topic and marker.action == 0:
                yield channel.topic, message.log_time, marker
