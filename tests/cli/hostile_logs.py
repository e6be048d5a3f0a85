"""Logs that describe thousands of topics, or whose spans and counts are odd."""

import bz2
import sqlite3
import struct
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import Any, Final

import zstandard

from tests.oracles.recorded import unpacked
from tests.oracles.walks import Entry, Walk, write_library_mcap
from tests.paths import TROT
from tests.reader import bag_bytes, mcap_bytes
from tests.reader.bag_bytes import U32
from tests.reader.mcap_bytes import MAGIC, channel, file_header, record, schema, text

YEARS_NS: Final = 56 * 365 * 86400 * 10**9
CONTACTS: Final = "gazebo_msgs/msg/ContactsState"
Writer = Callable[..., None]
"""Writes a log of so many topics, or states."""


def many_channels(path: Path, count: int) -> None:
    channels = b"".join(channel(n, f"/{n}") for n in range(count))
    path.write_bytes(MAGIC + file_header() + schema(1) + channels)


def many_of_a_kind(kind: str, topic: str, path: Path, count: int) -> None:
    walk = Walk(2)
    data = next(entry.data for entry in walk.messages(CONTACTS) if entry.kind == kind)
    definition = struct.pack("<I", len(walk.definition(kind))) + walk.definition(kind).encode()
    head = struct.pack("<H", 1) + text(kind) + text("ros2msg")
    parts = [record(mcap_bytes.SCHEMA, head + definition)]
    for number in range(1, count + 1):
        head = struct.pack("<HH", number, 1) + text(f"{topic}{number}") + text("cdr")
        parts.append(record(mcap_bytes.CHANNEL, head + struct.pack("<I", 0)))
        parts.append(mcap_bytes.Message(number, number * 1000, data).record())
    body = b"".join(parts)
    packed = zstandard.compress(body)
    head = struct.pack("<QQQI", 1000, 1000 * count, len(body), 0) + text("zstd")
    chunk = head + struct.pack("<Q", len(packed)) + packed
    path.write_bytes(MAGIC + file_header() + record(mcap_bytes.CHUNK, chunk))


def descriptions_between_messages(path: Path, count: int) -> None:
    body = b"".join(
        schema(n, data=b"int8 a") + channel(n, f"/{n}") + mcap_bytes.Message(n, n, b"").record()
        for n in range(1, count)
    )
    path.write_bytes(MAGIC + file_header() + body)


def many_connections(path: Path, count: int) -> None:
    inside = b"".join(
        bag_bytes.Connection(n, f"/{n}").record() + bag_bytes.Message(n, n + 1, b"").record()
        for n in range(count)
    )
    size = U32.pack(len(inside))
    chunk = bag_bytes.record(bz2.compress(inside), op=b"\x05", compression=b"bz2", size=size)
    path.write_bytes(bag_bytes.MAGIC + bag_bytes.bag_header(0, 0, 0) + chunk)


def many_rows(path: Path, count: int) -> None:
    connection = sqlite3.connect(path)
    connection.execute("CREATE TABLE topics (id INTEGER PRIMARY KEY, name, type)")
    connection.execute("CREATE TABLE messages (topic_id, timestamp, data)")
    numbers = range(1, count + 1)
    connection.executemany("INSERT INTO topics VALUES (?, ?, 'a/msg/B')", [(n, n) for n in numbers])
    connection.execute("UPDATE topics SET name = '/' || name")
    connection.executemany("INSERT INTO messages VALUES (?, ?, x'00')", [(n, n) for n in numbers])
    connection.commit()
    connection.close()


MANY_TOPICS: Final[dict[str, tuple[Writer, int]]] = {
    "channels": (many_channels, 8_000),
    "odometries": (partial(many_of_a_kind, "nav_msgs/msg/Odometry", "/o"), 8_000),
    "feet": (partial(many_of_a_kind, CONTACTS, "/front_left_"), 8_000),
    "descriptions between messages": (descriptions_between_messages, 3_000),
    "connections": (many_connections, 20_000),
    "rows": (many_rows, 10_000),
}
"""How each is written, and how many topics are a megabyte at the most."""


def entries(kind: str = "") -> list[Entry]:
    """Return the messages of the trot, or those of a type."""
    return [each for each in unpacked(TROT, 2)[1] if kind in each.kind]


def write(path: Path, rows: Sequence[Entry]) -> None:
    write_library_mcap(path, unpacked(TROT, 2)[0], rows, 1_000_000)


def set_right(path: Path) -> None:
    """Let the clock of the recorder, which begins in 1970, be set right in the middle."""
    rows = entries()
    half = len(rows) // 2
    late = [each._replace(log_time=each.log_time + YEARS_NS) for each in rows[half:]]
    write(path, rows[:half] + late)


def many_states(path: Path, count: int) -> None:
    """Write a few messages of a foot, each with many contact states."""
    walk, touches = unpacked(TROT, 2)[0], entries(CONTACTS)
    read: Iterator[Any] = (walk.store.deserialize_cdr(each.data, CONTACTS) for each in touches)
    full = next(message for message in read if message.states)
    full.states = [full.states[0]] * count
    data, first = walk.bytes_of(CONTACTS, full), touches[0]
    times = (first.log_time + 10_000_000 * n for n in range(6))
    write(path, [first._replace(log_time=time, data=data) for time in times])


def one_message(path: Path) -> None:
    write(path, entries(CONTACTS)[:1])
