"""SQLite logs whose recorder was killed while it wrote, as SQLite itself recovers copies."""

import shutil
import signal
import sqlite3
import subprocess
import sys
from pathlib import Path

import pytest

from tests.reader.reading import Read, read_file
from tests.reader.sqlite_files import MESSAGES, TOPICS, contents, expected, make

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
    path = killed(tmp_path / "log", *pages, journal, synchronous, where)
    before = contents(path.parent)

    reading = read_file(path)

    assert list(reading.messages) == recovered(path, tmp_path / "copy")
    assert contents(path.parent) == before
    assert (len(before) > 1) == (journal != "MEMORY")
    assert ("log.db3-journal beside it" in reading.sentences) == (journal in {"DELETE", "PERSIST"})


def killed(folder: Path, *words: str) -> Path:
    """Return the log of a recorder that was killed, in a folder that nothing is written to."""
    folder.mkdir()
    path = folder / "log.db3"
    command = [sys.executable, "-c", RECORDER, TOPICS, MESSAGES, str(path), *words]
    assert subprocess.run(command, check=False).returncode == -signal.SIGKILL  # noqa: S603
    folder.chmod(0o555)
    return path


def test_a_write_ahead_log_is_found_through_a_link_and_left_out_if_damaged(tmp_path: Path) -> None:
    path = killed(tmp_path / "log", *PAGES[0], "WAL", "NORMAL", "between transactions")
    link = tmp_path / "link.db3"
    link.symlink_to(path)
    whole = read_file(path).messages
    assert read_file(link).messages == whole
    log = path.with_name("log.db3-wal")
    data = log.read_bytes()
    log.write_bytes(data[:99] + bytes([data[99] ^ 1]) + data[100:])
    what = "is damaged at byte 32; what was recorded after that is lost"
    assert what in read_file(path).sentences
    log.write_bytes(b"junk" * 1000)
    rest = read_file(path)
    assert rest.messages
    assert "log.db3-wal beside it cannot be used (its header is damaged)" in rest.sentences


@pytest.mark.parametrize("content", [b"", bytes(512), b"not a journal at all"])
def test_a_journal_that_is_done_with_does_not_matter(tmp_path: Path, content: bytes) -> None:
    path = make(tmp_path / "log.db3")
    (tmp_path / "log.db3-journal").write_bytes(content)
    reading = read_file(path)
    assert list(reading.messages) == expected()
    assert reading.losses == ()


def recovered(path: Path, copy: Path) -> list[Read]:
    """Return the messages that SQLite finds in a copy, after it has settled its journals."""
    shutil.copytree(path.parent, copy)
    connection = sqlite3.connect(copy / path.name)
    rows = connection.execute("SELECT timestamp, data FROM messages ORDER BY id").fetchall()
    connection.close()
    assert len(rows) > 100
    return [Read("/a", time, data) for time, data in rows]
