"""Small logs: MCAP files of ROS 1 messages, byte by byte, and the beginnings of bags."""

import os
import struct
import tempfile
from collections.abc import Sequence
from functools import cache
from pathlib import Path

from mcap.writer import CompressionType
from mcap.writer import Writer as McapWriter
from rosbags.rosbag1 import Reader as BagReader
from rosbags.rosbag1 import Writer as BagWriter

from tests.oracles.recorded import ODOMETRY_TYPE
from tests.oracles.ros1_logs import WALK, odometry


def string_log(path: Path, messages: Sequence[tuple[str, bytes]]) -> Path:
    """Write an MCAP of std_msgs/String messages, one channel a topic."""
    with path.open("wb") as stream:
        writer = McapWriter(stream, compression=CompressionType.NONE)
        writer.start(profile="ros1")
        schema = writer.register_schema("std_msgs/String", "ros1msg", b"string data")
        channels: dict[str, int] = {}
        for number, (topic, data) in enumerate(messages):
            if topic not in channels:
                channels[topic] = writer.register_channel(topic, "ros1", schema)
            payload = struct.pack("<I", len(data)) + data
            writer.add_message(channels[topic], 10**9 + number, payload, 10**9 + number)
        writer.finish()
    return path


def odometry_log(path: Path, topic: str, *, filler: int = 0, cut: int = 0) -> Path:
    """Write an MCAP of ten poses, megabytes of noise behind each, the last one cut short."""
    noise = os.urandom(1 << 20)
    with path.open("wb") as stream:
        writer = McapWriter(stream, 1 << 19, CompressionType.NONE)
        writer.start(profile="ros1")
        definition = WALK.definition(ODOMETRY_TYPE).encode()
        schema = writer.register_schema("nav_msgs/Odometry", "ros1msg", definition)
        channel = writer.register_channel(topic, "ros1", schema)
        other = writer.register_channel("/noise", "noise", 0)
        for number in range(10):
            time_ns = (5 + number) * 10**9
            payload = odometry(time_ns, (number, 0.0, 0.0))
            data = payload[: len(payload) - cut] if number == 9 else payload
            writer.add_message(channel, time_ns, data, time_ns)
            for _ in range(filler):
                writer.add_message(other, time_ns, noise, time_ns)
        writer.finish()
    return path


_FOLDER = tempfile.TemporaryDirectory(prefix="small_logs")
_CHUNK_BYTES = 250_000


@cache
def first_seconds(bag: Path, seconds: float = 2.0) -> Path:
    """Write the first seconds of a bag, without compression, into a file of the same name."""
    path = Path(_FOLDER.name) / f"{seconds:g}" / bag.name
    path.parent.mkdir(exist_ok=True)
    with BagReader(bag) as reader, BagWriter(path) as writer:
        writer.chunk_threshold = _CHUNK_BYTES
        begin = reader.start_time
        added = {
            (c.topic, c.msgtype): writer.add_connection(
                c.topic, c.msgtype, msgdef=c.msgdef.data, md5sum=c.digest
            )
            for c in reader.connections
        }
        for c, time, data in reader.messages(stop=begin + round(seconds * 1e9)):
            writer.write(added[c.topic, c.msgtype], time, data)
    return path
