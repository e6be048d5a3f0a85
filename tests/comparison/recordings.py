"""Recordings written by the mcap library, and compared in pairs."""

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate
from mcap.writer import Writer
from mcap_protobuf.schema import build_file_descriptor_set

from dogbot_logtool.commands.compare import compare
from dogbot_logtool.comparison.outcome import Comparison, Tally
from dogbot_logtool.options.compare import CompareOptions
from tests.oracles.walks import Walk

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


UNINDEXED: Mapping[str, Any] = dict.fromkeys(
    ("use_statistics", "repeat_channels", "repeat_schemas"), False
)
"""How to write a file without a summary."""


@dataclass(frozen=True)
class Recording:
    kinds: Mapping[str, Kind]
    messages: Sequence[Message]
    metadata: Mapping[str, dict[str, str]] = field(default_factory=dict)
    attachments: Mapping[str, bytes] = field(default_factory=dict)
    profile: str = "ros1"

    def write(self, path: Path, **packing: Any) -> Path:
        """Write an MCAP; how it is packed must not matter."""
        with path.open("wb") as file:
            # Without a checksum a test can tamper with the summary.
            writer = Writer(file, enable_crcs=False, **packing)
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
def ros(version: int) -> Walk:
    return Walk(version)


@cache
def ros_kind(version: int) -> Kind:
    text = ros(version).definition(ODOMETRY).encode()
    if version == 1:
        return Kind("ros1", "nav_msgs/Odometry", "ros1msg", text)
    return Kind("cdr", ODOMETRY, "ros2msg", text)


def odometry(
    version: int,
    position: tuple[float, float, float] = (1.0, 2.0, 3.0),
    orientation: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 1.0),
    frame: str = "world",
    covariance: float = 0.0,
) -> bytes:
    message = ros(version).make(
        ODOMETRY,
        header={"stamp": (5, 6), "frame_id": frame},
        child_frame_id="base_link",
        pose=[(position, orientation), np.full(36, covariance)],
    )
    return ros(version).bytes_of(ODOMETRY, message)


SCENE = Kind(
    "protobuf",
    "foxglove.SceneUpdate",
    "protobuf",
    build_file_descriptor_set(SceneUpdate).SerializeToString(),
)
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


def load(z: float) -> bytes:
    return json.dumps({"force": [z], "in_contact": True}).encode()


WITH_NUMBER: Mapping[str, tuple[Kind, Callable[[float], bytes], str]] = {
    "ros1": (ros_kind(1), lambda z: odometry(1, (1.0, 2.0, z)), "pose.pose.position.z"),
    "cdr": (ros_kind(2), lambda z: odometry(2, (1.0, 2.0, z)), "pose.pose.position.z"),
    "protobuf": (SCENE, scene, "entities[0].arrows[0].pose.position.z"),
    "json": (JSON, load, "force[0]"),
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
            ("/load", i + 1, load(i / 3)),
            ("/raw", 2 * i, bytes(range(i % 7))),
        )
    ]
    whole = recording(kinds, *messages)
    return replace(
        whole,
        metadata={"dogbot_logtool": {"version": "1", "style": "force"}},
        attachments={"notes": b"wet floor"},
    )


class Pair:
    """Two recordings, written and compared."""

    def __init__(self, folder: Path) -> None:
        self.expected = folder / "expected.mcap"
        self.actual = folder / "actual.mcap"

    def write(self, expected: Recording, actual: Recording) -> None:
        expected.write(self.expected)
        actual.write(self.actual)

    def compare(self, options: CompareOptions = CompareOptions()) -> Comparison:  # noqa: B008
        return compare(self.expected, self.actual, options)

    def lines(
        self,
        expected: Recording,
        actual: Recording,
        options: CompareOptions = CompareOptions(),  # noqa: B008 - frozen
    ) -> list[str]:
        self.write(expected, actual)
        result = self.compare(options)
        assert result.same == (not result.differences)
        assert result.exit_code == (0 if result.same else 1)
        return [difference.line for difference in result.differences]


def tally(result: Comparison, name: str) -> Tally:
    return next(one for one in result.tallies if one.name == name)


def counts(one: Tally) -> tuple[int, int, int, int, int, int, int]:
    return (
        one.expected,
        one.actual,
        one.equal,
        one.within_tolerance,
        one.different,
        one.missing,
        one.extra,
    )
