"""Recordings written by the mcap library, and compared."""

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate
from mcap.writer import Writer
from mcap_protobuf.schema import build_file_descriptor_set

import dogbot_logtool as dl
from dogbot_logtool.comparison.outcome import Comparison
from tests.oracles.walks import Walk

START = 1_700_000_000_000_000_000
STEP = 1_000_000
ODOMETRY = "nav_msgs/msg/Odometry"
Message = tuple[str, int, bytes]
"""Topic, log time, ns, and payload."""


@dataclass(frozen=True)
class Kind:
    """What a channel says of its messages."""

    encoding: str
    name: str = ""
    schema_encoding: str = ""
    schema: bytes = b""


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
    publish_delay: int = 0
    """ns."""

    def write(self, path: Path, **packing: Any) -> Path:
        """Write an MCAP; how it is packed must not matter."""
        with path.open("wb") as file:
            # Without a checksum a test can tamper with the summary.
            writer = Writer(file, enable_crcs=False, **packing)
            writer.start(self.profile, "a test")
            channels = {topic: register(writer, topic, kind) for topic, kind in self.kinds.items()}
            for topic, time, data in self.messages:
                writer.add_message(channels[topic], time, data, time + self.publish_delay)
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


def scene(z: float = 0.0213, *, entity: str = "front_left") -> bytes:
    update: Any = SceneUpdate()
    one = update.entities.add(id=entity, frame_id="world")
    one.arrows.add(shaft_length=0.5).pose.position.z = z
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


def recording(kinds: Mapping[str, Kind], *messages: Message) -> Recording:
    """A recording of messages with times in ms after the start."""
    return Recording(kinds, [(topic, START + ms * STEP, data) for topic, ms, data in messages])


def one_topic(kind: Kind, *payloads: bytes) -> Recording:
    return recording({"/a": kind}, *(("/a", time, data) for time, data in enumerate(payloads)))


def json_log(*messages: tuple[int, str], topics: str = "/a") -> Recording:
    """JSON messages by time, ms; the same on each topic."""
    kinds = dict.fromkeys(topics.split(), JSON)
    return recording(kinds, *((topic, t, data.encode()) for t, data in messages for topic in kinds))


def compared(
    folder: Path, expected: Recording | Path | str, actual: Recording | Path | str, **options: Any
) -> Comparison:
    """Write what is not written yet, texts as they are, and compare."""
    files = []
    for name, side in (("expected", expected), ("actual", actual)):
        files.append(side if isinstance(side, Path) else folder / name)
        if isinstance(side, str):
            files[-1].write_text(side)
        elif isinstance(side, Recording):
            side.write(files[-1])
    result = dl.compare(*files, **options)
    assert result.same == (not result.difference_count)
    return result


def lines(result: Comparison) -> list[str]:
    return [difference.line for difference in result.differences]


COUNTS = ("expected", "actual", "equal", "within_tolerance", "different", "missing", "extra")


def counts(result: Comparison, name: str = "/a") -> tuple[int, ...]:
    """Return the `COUNTS` of messages."""
    one = next(tally for tally in result.tallies if tally.name == name)
    paired = one.equal + one.within_tolerance + one.different
    assert (one.expected, one.actual) == (paired + one.missing, paired + one.extra)
    return tuple(getattr(one, each) for each in COUNTS)
