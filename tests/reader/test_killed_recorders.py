"""SQLite logs whose recorder was killed while it wrote, as SQLite itself recovers copies."""

import shutil
import signal
import sqlite3
import subprocess
import sys
from pathlib import Path

import pytest

from tests.reader.reading import Read, read_file
from tests.reader.sqlite_files import MESSAGES, TOPICS

RECORDER = """
import os, random, signal, sqlite3, sys

topics, messages, path, page_size, vacuum, encoding, journal, synchronous, where = sys.argv[1:]
numbers = random.Random(page_size + journal)
connection = sqlite3.connect(path, isolation_level=None)
for setting in (
    f"page_size = {page_size}",
    f"auto_vacuum = {vacuum}",
    f"encoding = '{encoding}'",
    f"journal_mode = {journal}",
    f"synchronous = {synchronous}",
    "cache_size = 5",
    "wal_autocheckpoint = 20",
):
    connection.execute("PRAGMA " + setting)
connection.execute(topics)
connection.execute(messages)
connection.execute("CREATE INDEX timestamp_idx ON messages (timestamp ASC)")
connection.execute("INSERT INTO topics VALUES (1, '/a', 'std_msgs/msg/String', 'cdr')")
time = 0
for transaction in range(5):
    connection.execute("BEGIN")
    for _ in range(40):
        time += 1
        data = numbers.randbytes(numbers.choice([3, 90, 700, 5000]))
        connection.execute(
            "INSERT INTO messages (topic_id, timestamp, data) VALUES (1, ?, ?)", (time, data)
        )
    connection.execute("DELETE FROM messages WHERE id % 17 = ?", (transaction,))
    if transaction == 4 and where == "amid a transaction":
        os.kill(os.getpid(), signal.SIGKILL)
    connection.execute("COMMIT")
os.kill(os.getpid(), signal.SIGKILL)
"""
PAGES = [("512", "FULL", "UTF-8"), ("4096", "NONE", "UTF-16le"), ("65536", "INCREMENTAL", "UTF-8")]


@pytest.mark.parametrize(
    ("journal", "synchronous", "where"),
    [
        ("MEMORY", "OFF", "between transactions"),  # rosbag2's default
        ("WAL", "NORMAL", "between transactions"),  # its resilient preset
        ("WAL", "NORMAL", "amid a transaction"),
        ("DELETE", "FULL", "amid a transaction"),
        ("PERSIST", "FULL", "amid a transaction"),
    ],
)
@pytest.mark.parametrize("pages", PAGES, ids=lambda pages: pages[0])
def test_as_much_is_read_as_sqlite_recovers(
    tmp_path: Path, pages: tuple[str, ...], journal: str, synchronous: str, where: str
) -> None:
    (tmp_path / "log").mkdir()
    path = tmp_path / "log" / "log.db3"
    words = [TOPICS, MESSAGES, str(path), *pages, journal, synchronous, where]
    killed = subprocess.run([sys.executable, "-c", RECORDER, *words], check=False)  # noqa: S603
    assert killed.returncode == -signal.SIGKILL
    before = contents(path.parent)

    assert list(read_file(path).messages) == recovered(path, tmp_path / "copy")

    assert contents(path.parent) == before
    assert (len(before) > 1) == (journal != "MEMORY")


def recovered(path: Path, copy: Path) -> list[Read]:
    """Return the messages that SQLite finds in a copy, after it has settled its journals."""
    shutil.copytree(path.parent, copy)
    connection = sqlite3.connect(copy / path.name)
    rows = connection.execute("SELECT timestamp, data FROM messages ORDER BY id").fetchall()
    connection.close()
    assert len(rows) > 100
    return [Read("/a", time, data) for time, data in rows]


def contents(folder: Path) -> dict[str, bytes]:
    return {file.name: file.read_bytes() for file in folder.iterdir()}
