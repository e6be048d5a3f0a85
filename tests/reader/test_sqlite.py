"""SQLite files beside their journals, with columns of other types, and under odd names."""

import os
import shutil
import sqlite3
import struct
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import pytest

from dogbot_logtool.errors import LogError
from dogbot_logtool.reader.opening import open_log
from tests.forked_cli import run
from tests.paths import ROOT
from tests.reader.reading import Read, read_file

TOPICS = "CREATE TABLE topics (id INTEGER PRIMARY KEY, name, type, serialization_format)"
MESSAGES = "CREATE TABLE messages (id INTEGER PRIMARY KEY, topic_id, timestamp, data)"
COUNT = 20


def make(
    path: Path,
    *statements: str,
    messages: str = MESSAGES,
    rows: int = COUNT,
    page_size: int = 4096,
) -> Path:
    connection = sqlite3.connect(path, isolation_level=None)
    connection.execute(f"PRAGMA page_size = {page_size}")
    for statement in (TOPICS, messages):
        connection.execute(statement)
    connection.execute("INSERT INTO topics VALUES (1, '/a', 'std_msgs/msg/String', 'cdr')")
    connection.execute("BEGIN")
    connection.executemany(
        "INSERT INTO messages (topic_id, timestamp, data) VALUES (1, ?, ?)",
        [(time, b"x%d" % time) for time in range(1, rows + 1)],
    )
    connection.execute("COMMIT")
    for statement in statements:
        connection.execute(statement)
    connection.close()
    return path


def expected(count: int = COUNT) -> list[Read]:
    return [Read("/a", time, b"x%d" % time) for time in range(1, count + 1)]


@pytest.mark.parametrize(
    "columns",
    [
        "rowid",
        "rowid TEXT",
        "ROWID INTEGER",
        "oid, rowid",
        "_rowid_, rowid",
        "rowid INTEGER DEFAULT 7",
        "rowid TEXT DEFAULT 'one'",
    ],
)
def test_columns_named_like_row_numbers_do_not_matter(tmp_path: Path, columns: str) -> None:
    table = f"CREATE TABLE messages (topic_id, timestamp, data, {columns})"
    reading = read_file(make(tmp_path / "log.db3", messages=table))
    assert list(reading.messages) == expected()
    assert reading.losses == ()


@pytest.mark.parametrize(
    "table",
    [
        "CREATE TABLE messages (topic_id, timestamp, data, rowid, oid, _rowid_)",
        "CREATE TABLE messages (topic_id, timestamp PRIMARY KEY, data) WITHOUT ROWID",
    ],
)
def test_rows_without_numbers_are_refused(tmp_path: Path, table: str) -> None:
    path = make(tmp_path / "log.db3", messages=table)
    with pytest.raises(LogError, match="is no ROS 2 bag: the rows of its table"):
        open_log(path)


@pytest.mark.parametrize(
    "change",
    [
        "timestamp = NULL",
        "timestamp = 'three'",
        "timestamp = 3.5",
        "timestamp = x'03'",
        "data = NULL",
        "data = 3",
        "topic_id = NULL",
        "topic_id = '1'",
    ],
)
def test_values_of_other_types_are_counted(tmp_path: Path, change: str) -> None:
    path = make(tmp_path / "log.db3", f"UPDATE messages SET {change} WHERE id = 3")  # noqa: S608
    reading = read_file(path)
    assert list(reading.messages) == [one for one in expected() if one.log_time != 3]
    assert reading.sentences == "the database holds 1 rows that are no messages"
    assert reading.lost == 1


@pytest.mark.parametrize("change", ["name = NULL", "name = x'00'", "type = NULL", "id = 9"])
def test_topics_of_other_types_are_not_described(tmp_path: Path, change: str) -> None:
    reading = read_file(make(tmp_path / "log.db3", f"UPDATE topics SET {change}"))  # noqa: S608
    assert reading.messages == ()
    assert reading.lost == COUNT
    assert "nowhere described" in reading.sentences


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


def test_a_topic_that_stands_there_twice_is_said(tmp_path: Path) -> None:
    def with_rows(name: str, *rows: str) -> Path:
        made = "CREATE TABLE topics AS SELECT 1 id, '/a' name, 'std_msgs/msg/String' type"
        values = [f"INSERT INTO topics VALUES {row}" for row in rows]  # noqa: S608
        return make(tmp_path / name, "DROP TABLE topics", made, *values)

    same = read_file(with_rows("same.db3", "(1, '/a', 'std_msgs/msg/String')"))
    assert list(same.messages) == expected()
    assert same.losses == ()
    other = read_file(with_rows("other.db3", "(1, '/b', 'std_msgs/msg/Bool')"))
    assert list(other.messages) == expected()
    assert other.sentences == (
        "topic 1 is described in two ways: as /a (std_msgs/msg/String, cdr) and as "
        "/b (std_msgs/msg/Bool, cdr); the former was used"
    )


def test_definitions_that_differ_are_said(tmp_path: Path) -> None:
    table = "CREATE TABLE message_definitions (topic_type, encoding, encoded_message_definition)"
    rows = [
        f"INSERT INTO message_definitions VALUES ('std_msgs/msg/String', 'ros2msg', '{text}')"  # noqa: S608
        for text in ("string data", "string data", "string data\nint32 more")
    ]
    log = open_log(make(tmp_path / "log.db3", table, *rows))
    (channel,) = log.channels.values()
    assert channel.schema is not None
    assert channel.schema.data == b"string data"
    (loss,) = log.losses
    assert loss.what.startswith("std_msgs/msg/String is described in two ways: as ")
    log.close()


def test_row_numbers_may_be_as_far_apart_as_they_can(tmp_path: Path) -> None:
    change = "UPDATE messages SET id = -9223372036854775808 WHERE id = 1"
    reading = read_file(make(tmp_path / "log.db3", change))
    assert list(reading.messages) == expected()


def test_names_of_tables_have_no_case(tmp_path: Path) -> None:
    path = make(tmp_path / "log.db3", messages=MESSAGES.replace("messages", "Messages"))
    assert list(read_file(path).messages) == expected()


def test_a_topic_without_serialisation_is_cdr(tmp_path: Path) -> None:
    path = make(tmp_path / "log.db3", "UPDATE topics SET serialization_format = NULL")
    log = open_log(path)
    assert [channel.message_encoding for channel in log.channels.values()] == ["cdr"]
    log.close()


@pytest.mark.parametrize(
    "name", ["a?b.db3", "a#b.db3", "a%20b.db3", "a b;c.db3", os.fsdecode(b"caf\xe9.db3")]
)
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


def test_no_room_for_the_copy_is_said(tmp_path: Path) -> None:
    path = with_write_ahead_log(tmp_path, "log.db3")
    done = subprocess.run(  # noqa: S603 - our own interpreter
        [sys.executable, "-m", "dogbot_logtool", "info", str(path)],
        capture_output=True,
        text=True,
        check=False,
        cwd=ROOT,
        preexec_fn=forbid_large_files,
    )
    assert done.returncode == 1
    assert "set TMPDIR" in done.stderr


def forbid_large_files() -> None:
    import resource  # noqa: PLC0415 - not on every system
    import signal  # noqa: PLC0415

    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (100, 100))


# Pages that several parents share: a small file of endlessly many rows.

PAGE = 512


def interior(child: int, count: int) -> bytes:
    """Return a page of a table's tree all of whose children are one page."""
    cells = [struct.pack(">IB", child, number + 1) for number in range(count)]
    places = [PAGE - 5 * (number + 1) for number in range(count)]
    head = struct.pack(">BHHHBI", 5, 0, count, places[-1], 0, child)
    head += b"".join(struct.pack(">H", place) for place in places)
    body = b"".join(reversed(cells))
    return head + bytes(PAGE - len(head) - len(body)) + body


def with_shared_pages(path: Path, table: str, levels: int = 14) -> Path:
    filling = ("CREATE TABLE filling (data)", "INSERT INTO filling VALUES (zeroblob(20000))")
    make(path, *filling, page_size=PAGE)
    connection = sqlite3.connect(path)
    query = "SELECT rootpage FROM sqlite_master WHERE name = ?"
    (root,) = connection.execute(query, (table,)).fetchone()
    connection.close()
    data = bytearray(path.read_bytes())
    pages = len(data) // PAGE
    free = range(pages - levels, pages + 1)
    leaf = data[(root - 1) * PAGE : root * PAGE]
    chain = [root, *free[1:]]
    for page, child in pairwise(chain):
        data[(page - 1) * PAGE : page * PAGE] = interior(child, 60)
    data[(chain[-1] - 1) * PAGE : chain[-1] * PAGE] = leaf
    path.write_bytes(data)
    return path


@pytest.mark.parametrize("table", ["messages", "topics"])
@pytest.mark.parametrize("command", ["info", "stats", "convert", "compare"])
def test_pages_that_are_shared_end_the_reading(tmp_path: Path, table: str, command: str) -> None:
    path = with_shared_pages(tmp_path / "log.db3", table)
    words = [str(path)] * (2 if command == "compare" else 1)
    done = run(command, *words, folder=tmp_path, timeout=30)
    assert done.returncode in {1, 2, 3}, done.stderr
    if command in {"info", "compare"}:
        said = " ".join((done.stdout + done.stderr).split())
        assert "its pages are used more than once" in said


def test_a_row_that_stands_twice_ends_the_reading(tmp_path: Path) -> None:
    path = make(tmp_path / "log.db3", "PRAGMA journal_mode = DELETE")
    connection = sqlite3.connect(path)
    connection.execute("DELETE FROM messages WHERE id > 1")
    connection.execute("UPDATE messages SET data = zeroblob(900000)")
    connection.commit()
    query = "SELECT rootpage FROM sqlite_master WHERE name = 'messages'"
    (root,) = connection.execute(query).fetchone()
    (size,) = connection.execute("PRAGMA page_size").fetchone()
    connection.close()
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


def leaves(path: Path, table: str) -> list[int]:
    """Return the leaf pages of a table's tree of two levels, in order."""
    connection = sqlite3.connect(path)
    query = "SELECT rootpage FROM sqlite_master WHERE name = ?"
    (root,) = connection.execute(query, (table,)).fetchone()
    connection.close()
    data = path.read_bytes()
    page = (root - 1) * PAGE
    assert data[page] == 5
    (cells,) = struct.unpack_from(">H", data, page + 3)
    found = struct.unpack_from(f">{cells}H", data, page + 12)
    (last,) = struct.unpack_from(">I", data, page + 8)
    return [*(struct.unpack_from(">I", data, page + cell)[0] for cell in found), last]


@pytest.mark.parametrize("which", [0, 4, -1])
def test_rows_behind_a_damaged_page_are_read(tmp_path: Path, which: int) -> None:
    count = 300
    path = make(tmp_path / "log.db3", rows=count, page_size=PAGE)
    pages = leaves(path, "messages")
    assert len(pages) > 8
    data = bytearray(path.read_bytes())
    start = (pages[which] - 1) * PAGE
    (lost,) = struct.unpack_from(">H", data, start + 3)
    data[start : start + PAGE] = b"\0" * PAGE
    path.write_bytes(data)

    reading = read_file(path)

    found = [message.log_time for message in reading.messages]
    assert found == sorted(set(found))
    missing = sorted(set(range(1, count + 1)) - set(found))
    assert missing == list(range(missing[0], missing[-1] + 1))
    # Python's sqlite3 steps ahead, so that an error also costs the row next to the damage.
    assert lost <= len(missing) <= lost + 2
    if which == 0:
        assert missing[0] == 1
    if which == -1:
        assert missing[-1] == count
    assert "the database is damaged" in reading.sentences
