"""SQLite files beside their journals, and under odd names."""

import os
import shutil
import sqlite3
from pathlib import Path

import pytest

from tests.reader.reading import read_file
from tests.reader.sqlite_files import COUNT, expected, make


@pytest.mark.parametrize("name", ["a?b#c%20d e;f.db3", os.fsdecode(b"caf\xe9.db3")])
@pytest.mark.parametrize("journal", [False, True])
def test_any_name_will_do(tmp_path: Path, name: str, journal: bool) -> None:  # noqa: FBT001
    path = with_write_ahead_log(tmp_path, name) if journal else make(tmp_path / name)
    assert list(read_file(path).messages) == expected()


def state(folder: Path) -> dict[str, bytes]:
    return {os.fsdecode(file.name): file.read_bytes() for file in folder.iterdir()}


def interrupted(folder: Path, name: str, mode: str, statement: str) -> Path:
    """Make a log whose writer was killed in the middle of a statement's transaction."""
    folder.mkdir(exist_ok=True)
    work = folder.parent / f"{folder.name}.work"
    work.mkdir()
    path = make(work / "log.db3")
    connection = sqlite3.connect(path, isolation_level=None)
    connection.execute(f"PRAGMA journal_mode = {mode}")
    connection.execute("PRAGMA cache_size = 1")
    connection.execute("PRAGMA cache_spill = 1")
    connection.execute("BEGIN")
    connection.execute(statement)
    # So many changed pages do not fit the cache, so they are written before the end.
    connection.execute("CREATE TABLE filling (data)")
    connection.executemany("INSERT INTO filling VALUES (?)", [(bytes(2000),)] * 200)
    for file in work.iterdir():
        shutil.copy(file, folder / file.name.replace("log.db3", name))
    connection.execute("ROLLBACK")
    connection.close()
    return folder / name


def test_a_hot_journal_is_rolled_back(tmp_path: Path) -> None:
    folder = tmp_path / "log"
    path = interrupted(folder, "log.db3", "DELETE", "DELETE FROM messages WHERE id > 5")
    assert (folder / "log.db3-journal").exists()
    before = state(folder)
    reading = read_file(path)
    assert list(reading.messages) == expected()
    assert "log.db3-journal beside it" in reading.sentences
    assert reading.lost is None
    assert state(folder) == before


@pytest.mark.parametrize("content", [b"", bytes(512), b"not a journal at all"])
def test_a_journal_that_is_done_with_does_not_matter(tmp_path: Path, content: bytes) -> None:
    path = make(tmp_path / "log.db3")
    (tmp_path / "log.db3-journal").write_bytes(content)
    reading = read_file(path)
    assert list(reading.messages) == expected()
    assert reading.losses == ()


def with_write_ahead_log(folder: Path, name: str) -> Path:
    """Make a log of which half the messages are in the write-ahead log beside it."""
    work = folder / "work"
    work.mkdir()
    path = make(work / "log.db3", rows=COUNT // 2)
    connection = sqlite3.connect(path, isolation_level=None)
    connection.execute("PRAGMA journal_mode = WAL")
    for time in range(COUNT // 2 + 1, COUNT + 1):
        connection.execute(
            "INSERT INTO messages (topic_id, timestamp, data) VALUES (1, ?, ?)",
            (time, b"x%d" % time),
        )
    connection.execute("BEGIN")
    connection.execute("DELETE FROM messages WHERE id < 5")
    target = folder / "log"
    target.mkdir()
    for suffix in ("", "-wal"):
        shutil.copy(work / f"log.db3{suffix}", target / (name + suffix))
    connection.execute("ROLLBACK")
    connection.close()
    return target / name


def test_a_write_ahead_log_counts_and_nothing_is_written_beside_it(tmp_path: Path) -> None:
    path = with_write_ahead_log(tmp_path, "log.db3")
    before = state(path.parent)
    path.parent.chmod(0o555)
    reading = read_file(path)
    assert list(reading.messages) == expected()
    assert reading.losses == ()
    assert state(path.parent) == before


def test_a_journal_reached_through_a_link_counts(tmp_path: Path) -> None:
    path = with_write_ahead_log(tmp_path, "log.db3")
    link = tmp_path / "link.db3"
    link.symlink_to(path)
    assert list(read_file(link).messages) == expected()


def test_a_damaged_write_ahead_log_adds_nothing(tmp_path: Path) -> None:
    path = with_write_ahead_log(tmp_path, "log.db3")
    path.with_name("log.db3-wal").write_bytes(b"junk" * 1000)
    assert list(read_file(path).messages) == expected(COUNT // 2)
