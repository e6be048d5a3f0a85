"""Small logs in SQLite."""

import sqlite3
from pathlib import Path

from tests.reader.reading import Read

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


def root_page(path: Path, table: str) -> tuple[int, int]:
    """Return the number of a table's first page, and the size of pages."""
    connection = sqlite3.connect(path)
    query = "SELECT rootpage FROM sqlite_master WHERE name = ?"
    (root,) = connection.execute(query, (table,)).fetchone()
    (size,) = connection.execute("PRAGMA page_size").fetchone()
    connection.close()
    return root, size


def contents(folder: Path) -> dict[str, bytes | None]:
    """Return the files in a folder, and what those that are regular hold."""
    files = [path for path in sorted(folder.rglob("*")) if not path.is_dir()]
    return {
        str(path.relative_to(folder)): path.read_bytes() if path.is_file() else None
        for path in files
    }
