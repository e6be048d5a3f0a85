"""Small logs that describe thousands of topics: every command stays within 10 s and 500 MB."""

import bz2
import sqlite3
import struct
from collections.abc import Callable
from pathlib import Path

import pytest
import zstandard

from tests.forked_cli import run
from tests.oracles.walks import Walk
from tests.reader import bag_bytes, mcap_bytes
from tests.reader.bag_bytes import U32
from tests.reader.mcap_bytes import MAGIC, channel, file_header, record, schema, text
from tests.shell import Shell

SIZE = 1 << 20
MOST_MEMORY_MB = 500
MOST_SECONDS = 60
"""On a busy machine; mostly it is below ten."""


def many_channels(_path: Path, count: int = 8_000) -> bytes:
    return MAGIC + file_header() + schema(1) + b"".join(channel(n, f"/{n}") for n in range(count))


def packed(body: bytes, times: tuple[int, int]) -> bytes:
    data = zstandard.compress(body)
    head = struct.pack("<QQQI", *times, len(body), 0) + text("zstd")
    head += struct.pack("<Q", len(data))
    return MAGIC + file_header() + record(mcap_bytes.CHUNK, head + data)


def many_of_a_kind(kind: str, topic: str, count: int) -> bytes:
    walk = Walk(2)
    entries = walk.messages("gazebo_msgs/msg/ContactsState")
    data = next(entry.data for entry in entries if entry.kind == kind)
    definition = struct.pack("<I", len(walk.definition(kind))) + walk.definition(kind).encode()
    head = struct.pack("<H", 1) + text(kind) + text("ros2msg")
    parts = [record(mcap_bytes.SCHEMA, head + definition)]
    for number in range(1, count + 1):
        head = struct.pack("<HH", number, 1) + text(f"{topic}{number}") + text("cdr")
        parts.append(record(mcap_bytes.CHANNEL, head + struct.pack("<I", 0)))
        parts.append(mcap_bytes.Message(number, number * 1000, data).record())
    return packed(b"".join(parts), (1000, 1000 * count))


def many_odometries(_path: Path, count: int = 8_000) -> bytes:
    return many_of_a_kind("nav_msgs/msg/Odometry", "/o", count)


def many_feet(_path: Path, count: int = 8_000) -> bytes:
    return many_of_a_kind("gazebo_msgs/msg/ContactsState", "/front_left_", count)


def descriptions_between_messages(_path: Path, count: int = 3_000) -> bytes:
    body = b"".join(
        schema(n, data=b"int8 a") + channel(n, f"/{n}") + mcap_bytes.Message(n, n, b"").record()
        for n in range(1, count)
    )
    return MAGIC + file_header() + body


def many_connections(_path: Path, count: int = 20_000) -> bytes:
    inside = b"".join(
        bag_bytes.Connection(n, f"/{n}").record() + bag_bytes.Message(n, n + 1, b"").record()
        for n in range(count)
    )
    size = U32.pack(len(inside))
    chunk = bag_bytes.record(bz2.compress(inside), op=b"\x05", compression=b"bz2", size=size)
    return bag_bytes.MAGIC + bag_bytes.bag_header(0, 0, 0) + chunk


def many_rows(path: Path, count: int = 10_000) -> bytes:
    connection = sqlite3.connect(path)
    connection.execute("CREATE TABLE topics (id INTEGER PRIMARY KEY, name, type)")
    connection.execute("CREATE TABLE messages (topic_id, timestamp, data)")
    numbers = range(1, count + 1)
    connection.executemany("INSERT INTO topics VALUES (?, ?, 'a/msg/B')", [(n, n) for n in numbers])
    connection.execute("UPDATE topics SET name = '/' || name")
    connection.executemany("INSERT INTO messages VALUES (?, ?, x'00')", [(n, n) for n in numbers])
    connection.commit()
    connection.close()
    return path.read_bytes()


LOGS: dict[str, Callable[..., bytes]] = {
    "channels": many_channels,
    "odometries": many_odometries,
    "feet": many_feet,
    "descriptions between messages": descriptions_between_messages,
    "connections": many_connections,
    "rows": many_rows,
}


COMMANDS = ("info --frames log", "stats log", "convert -o out.mcap log", "compare log log")


@pytest.mark.parametrize("name", LOGS)
def test_every_command_takes_hundreds_of_topics(shell: Shell, name: str) -> None:
    (shell.folder / "log").write_bytes(LOGS[name](shell.folder / "made", 300))
    for call in COMMANDS:
        assert shell(*call.split()).code in {0, 1, 3}


@pytest.mark.slow
@pytest.mark.parametrize("name", LOGS)
def test_every_command_stays_within_bounds(tmp_path: Path, name: str) -> None:
    data = LOGS[name](tmp_path / "made")
    assert len(data) <= SIZE
    log = tmp_path / "log"
    log.write_bytes(data)
    for call in COMMANDS:
        done = run(*call.split(), folder=tmp_path, timeout=MOST_SECONDS)
        assert done.returncode in {0, 1, 3}, done.stderr[-1000:]
        assert "Traceback" not in done.stderr
        assert done.peak_mb < MOST_MEMORY_MB


def test_a_table_of_very_many_topics_is_cut(tmp_path: Path) -> None:
    log = tmp_path / "log.mcap"
    log.write_bytes(many_channels(log))
    done = run("info", log, timeout=MOST_SECONDS)
    assert "and 7,000 more topics; --json lists all" in done.stdout
