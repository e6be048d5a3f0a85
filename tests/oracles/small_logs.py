"""Small logs: MCAP files of ROS 1 messages, byte by byte, and the beginnings of bags."""

import os
import tempfile
from functools import cache
from pathlib import Path

from mcap.writer import CompressionType
from rosbags.rosbag1 import Reader as BagReader
from rosbags.rosbag1 import Writer as BagWriter

from tests.oracles.recorded import ODOMETRY_TYPE, TEXT_TYPE, S
from tests.oracles.ros1_logs import odometry, write_ros1_mcap
from tests.oracles.walks import Entry


def odometry_log(path: Path, topic: str, *, filler: int = 0, cut: int = 0) -> Path:
    """Write an MCAP of ten poses, megabytes of noise behind each, the last one cut short."""
    noise, entries = os.urandom(1 << 20), []
    for number in range(10):
        time = (5 + number) * S
        data = odometry(time, (number, 0.0, 0.0))
        kept = len(data) - cut if number == 9 else len(data)
        entries.append(Entry(topic, ODOMETRY_TYPE, time, data[:kept]))
        entries += [Entry("/noise", TEXT_TYPE, time, noise)] * filler
    return write_ros1_mcap(path, entries, compression=CompressionType.NONE, chunk_size=1 << 19)


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
