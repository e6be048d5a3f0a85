"""Logs in SQLite: columns of other types, shared and damaged pages."""

import sqlite3
import struct
from collections.abc import Sequence
from contextlib import closing
from itertools import pairwise
from pathlib import Path

import pytest

from dogbot_logtool.reader.opening import open_log
from tests.forked_cli import run
from tests.reader.reading import read_file
from tests.reader.sqlite_files import COUNT, MESSAGES, expected, make, root_page

NO_MESSAGE = "the database holds 1 rows that are no messages"
THIRD = "UPDATE messages SET {} WHERE id = 3"
TABLES = (
    (MESSAGES.replace("messages", "Messages"), ""),
    (MESSAGES.replace("topic_id", '"topic_id" INTEGER NOT\nNULL'), ""),
    (MESSAGES.replace("data", "data BLOB NOT NULL, more TEXT"), ""),
    (MESSAGES, "UPDATE messages SET id = -9223372036854775808 WHERE id = 1"),
    (MESSAGES, "UPDATE topics SET serialization_format = NULL"),
)
NO_TIMES = ("NULL", "'three'", "3.5", "x'03'")
NO_ROWS = (*(f"timestamp = {each}" for each in NO_TIMES), "data = NULL", "data = 3")
NO_TOPICS = ("topic_id = NULL", "topic_id = '1'")
NOT_DESCRIBED = ("name = NULL", "name = x'00'", "type = NULL", "id = 9")


@pytest.mark.parametrize(
    ("table", "change", "lost", "says"),
    [
        *((table, change, (), "") for table, change in TABLES),
        *((MESSAGES, THIRD.format(each), (3,), NO_MESSAGE) for each in (*NO_ROWS, *NO_TOPICS)),
        *(
            (MESSAGES, f"UPDATE topics SET {each}", range(1, COUNT + 1), "nowhere described")  # noqa: S608
            for each in NOT_DESCRIBED
        ),
    ],
)
def test_tables_however_they_are_made_and_values_of_other_types(
    tmp_path: Path, table: str, change: str, lost: Sequence[int], says: str
) -> None:
    path = make(tmp_path / "log.db3", change, messages=table)
    reading = read_file(path)
    assert list(reading.messages) == [one for one in expected() if one.log_time not in lost]
    assert says in reading.sentences
    assert bool(says) == bool(reading.losses)
    assert reading.lost == len(lost)
    with closing(open_log(path)) as log:
        assert {channel.message_encoding for channel in log.channels.values()} <= {"cdr"}


@pytest.mark.parametrize("missing", [1, 4096, 5000, 40_000])
def test_what_is_there_of_a_file_that_is_cut_off_is_read(tmp_path: Path, missing: int) -> None:
    path = make(tmp_path / "log.db3", rows=5000)
    data = path.read_bytes()
    path.write_bytes(data[:-missing])
    reading = read_file(path)
    count = len(reading.messages)
    assert 5000 * (len(data) - missing - 20_000) // len(data) < count < 5000
    assert list(reading.messages) == expected(count)
    assert f"it promises {len(data)} bytes, but has {len(data) - missing}" in reading.sentences
    assert reading.lost is None


PAGE = 512
MANY = (
    "WITH RECURSIVE n(i) AS (SELECT 2 UNION ALL SELECT i + 1 FROM n WHERE i < 300) "
    "INSERT INTO topics SELECT i, '/b', 'std_msgs/msg/String', 'cdr' FROM n"
)


def tree(path: Path, table: str) -> tuple[int, list[int], list[int]]:
    """Return a table's first page, its leaf pages in order, and where in the first they are told.

    Its tree has two levels.
    """
    root, _ = root_page(path, table)
    page = path.read_bytes()[(root - 1) * PAGE : root * PAGE]
    assert page[0] == 5
    (cells,) = struct.unpack_from(">H", page, 3)
    places = [*struct.unpack_from(f">{cells}H", page, 12), 8]
    return root, [struct.unpack_from(">I", page, place)[0] for place in places], places


def with_shared_pages(path: Path, table: str) -> Path:
    """Let all children of a page be one, level below level: a small file of endlessly many rows."""
    make(path, MANY, rows=300, page_size=PAGE)
    root, leaves, places = tree(path, table)
    data = bytearray(path.read_bytes())
    top = data[(root - 1) * PAGE : root * PAGE]
    for page, child in pairwise([root, *leaves[:14]]):
        for place in places:
            struct.pack_into(">I", top, place, child)
        data[(page - 1) * PAGE : page * PAGE] = top
    path.write_bytes(data)
    return path


@pytest.mark.parametrize("table", ["messages", "topics"])
def test_pages_that_are_shared_end_the_reading(tmp_path: Path, table: str) -> None:
    path = with_shared_pages(tmp_path / "log.db3", table)
    done = run("info", str(path), folder=tmp_path, timeout=30)
    assert done.returncode in {1, 3}, done.stderr
    said = " ".join((done.stdout + done.stderr).split())
    assert "its pages are used more than once" in said


def test_tables_that_begin_with_one_page_are_damaged(tmp_path: Path) -> None:
    change = "UPDATE sqlite_master SET rootpage = 1 WHERE name = 'messages'"
    reading = read_file(make(tmp_path / "log.db3", "PRAGMA writable_schema = ON", change))
    assert "its pages are used more than once" in reading.sentences
    assert reading.lost is None


def test_a_row_that_stands_twice_ends_the_reading(tmp_path: Path) -> None:
    path = make(tmp_path / "log.db3", "PRAGMA journal_mode = DELETE")
    connection = sqlite3.connect(path)
    connection.execute("DELETE FROM messages WHERE id > 1")
    connection.execute("UPDATE messages SET data = zeroblob(900000)")
    connection.commit()
    connection.close()
    root, size = root_page(path, "messages")
    data = bytearray(path.read_bytes())
    page = (root - 1) * size
    assert data[page] == 13
    (cell,) = struct.unpack_from(">H", data, page + 8)
    struct.pack_into(">H", data, page + 3, 400)
    struct.pack_into(">400H", data, page + 8, *[cell] * 400)
    path.write_bytes(data)
    reading = read_file(path)
    assert len(reading.messages) <= 1
    assert "the database is damaged" in reading.sentences


@pytest.mark.parametrize(("which", "kept"), [(0, 0), (4, 0), (-1, 0), (4, 1)])
def test_rows_behind_a_damaged_page_are_read(tmp_path: Path, which: int, kept: int) -> None:
    count = 300
    path = make(tmp_path / "log.db3", rows=count, page_size=PAGE)
    _, pages, _ = tree(path, "messages")
    assert len(pages) > 8
    data = bytearray(path.read_bytes())
    start = (pages[which] - 1) * PAGE
    (lost,) = struct.unpack_from(">H", data, start + 3)
    data[start + kept : start + PAGE] = bytes(PAGE - kept)
    path.write_bytes(data)

    reading = read_file(path)

    found = [message.log_time for message in reading.messages]
    assert found == sorted(set(found))
    missing = sorted(set(range(1, count + 1)) - set(found))
    assert missing == list(range(missing[0], missing[-1] + 1))
    assert len(missing) == lost
    if which == 0:
        assert missing[0] == 1
    if which == -1:
        assert missing[-1] == count
    assert "the database is damaged" in reading.sentences
    (loss,) = reading.losses
    assert (loss.offset, loss.bytes) == (start, PAGE)
    assert loss.start_time == (None if which == 0 else missing[0] - 1)
    assert loss.end_time == (None if which == -1 else missing[-1] + 1)


def test_a_message_whose_further_pages_are_gone_is_lost(tmp_path: Path) -> None:
    path = make(tmp_path / "log.db3", "UPDATE messages SET data = zeroblob(9000) WHERE id = 7")
    data = bytearray(path.read_bytes())
    assert data[-8192:-8188] == (len(data) // 4096).to_bytes(4, "big")  # to the last page
    data[-8192:-8188] = bytes(4)
    path.write_bytes(data)
    reading = read_file(path)
    assert list(reading.messages) == [one for one in expected() if one.log_time != 7]
    assert reading.sentences == "the database is damaged: 1 messages cannot be read"
    assert reading.lost == 1
