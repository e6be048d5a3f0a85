"""Small logs: a few messages on topics named as a test wants, and the beginnings of bags."""

import os
import tempfile
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path

from mcap.writer import CompressionType
from rosbags.rosbag1 import Reader as BagReader
from rosbags.rosbag1 import Writer as BagWriter

from tests.oracles import base_walks, walks
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


WRENCH, CONTACTS = "geometry_msgs/msg/WrenchStamped", "gazebo_msgs/msg/ContactsState"
MODELS = "gazebo_msgs/msg/ModelStates"
LATE = 40
"""Samples by which every other foot is later."""


def write_log(
    path: Path,
    topics: Mapping[str, str],
    *,
    odometry: Sequence[str] = (),
    models: Mapping[str, float] | None = None,
    samples: int = 3,
) -> Path:
    """Write an MCAP with topics of contact messages, by type; feet take turns.

    Args:
        path: the file.
        topics: type by topic.
        odometry: topics of odometry.
        models: speed of each model of `/gazebo/model_states`, m a sample; None: no such topic.
        samples: how many.
    """
    walk = base_walks.ros()
    entries = []
    for sample in range(samples):
        time = walks.START + sample * walks.STEP
        data = walk.odometry(sample)
        entries += [walks.Entry(one, "nav_msgs/msg/Odometry", time, data) for one in odometry]
        if models is not None:
            listed = base_walks.models(walk, {name: v * sample for name, v in models.items()})
            entries.append(walks.Entry("/gazebo/model_states", MODELS, time, listed))
        for number, (topic, kind) in enumerate(topics.items()):
            down = (sample - number % 2 * LATE) % walks.PERIOD < walks.STANCE
            force = (0.0, 0.0, 60.0 if down else 0.0)
            header = walk.header(sample, "world")
            if kind == WRENCH:
                message = walk.make(kind, header=header, wrench=[force])
            else:
                states = [walk.classic_state("foot", force)] if down else []
                message = walk.make(kind, header=header, states=states)
            entries.append(walks.Entry(topic, kind, time, walk.bytes_of(kind, message)))
    walks.write_mcap(path, walk, entries)
    return path
