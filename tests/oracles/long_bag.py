"""A ROS 2 bag in SQLite of very many small messages, written quickly."""

import sqlite3
import struct
from collections.abc import Iterator
from pathlib import Path
from typing import Final

from tests.oracles import walks
from tests.reader.sqlite_files import MESSAGES, TOPICS

WRENCHES: Final = "geometry_msgs/msg/WrenchStamped"
TICK: Final = "std_msgs/msg/Int64"
_STAMP: Final = struct.Struct("<iI")
_HEAD: Final = 4
"""Bytes of CDR before a stamp that a message begins with."""


def write_long_bag(path: Path, repeats: int, ticks: int) -> Path:
    """Write a bag.

    Args:
        path: of the file.
        repeats: how often the robot walks.
        ticks: further messages at each sample.
    """
    walk = list(walks.Walk(2).messages(WRENCHES))
    kinds = {entry.topic: entry.kind for entry in walk} | {"/ticks": TICK}
    numbers = {topic: number for number, topic in enumerate(kinds)}

    def rows() -> Iterator[tuple[int, int, bytes]]:
        for repeat in range(repeats):
            for entry in walk:
                time = entry.log_time + repeat * walks.SAMPLES * walks.STEP
                stamp = _STAMP.pack(*divmod(time, 10**9))
                data = entry.data[:_HEAD] + stamp + entry.data[_HEAD + _STAMP.size :]
                yield numbers[entry.topic], time, data
                if entry.topic == "/odom":
                    for tick in range(ticks):
                        yield numbers["/ticks"], time + tick, bytes([0, 1, 0, 0]) + bytes(8)

    connection = sqlite3.connect(path, isolation_level=None)
    for statement in ("PRAGMA journal_mode = OFF", TOPICS, MESSAGES, "BEGIN"):
        connection.execute(statement)
    topics = [(numbers[topic], topic, kind) for topic, kind in kinds.items()]
    connection.executemany("INSERT INTO topics VALUES (?, ?, ?, 'cdr')", topics)
    insert = "INSERT INTO messages (topic_id, timestamp, data) VALUES (?, ?, ?)"
    connection.executemany(insert, rows())
    connection.execute("COMMIT")
    connection.close()
    return path
