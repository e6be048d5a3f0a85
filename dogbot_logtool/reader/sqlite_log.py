"""ROS 2 bags in SQLite (.db3): rows become messages, runs of rows become chunks."""

import os
import sqlite3
import threading
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Final
from urllib.parse import quote

import numpy as np

from dogbot_logtool.core.arrays import Bytes, Ints
from dogbot_logtool.errors import LogError
from dogbot_logtool.reader.log import (
    Batch,
    Chunk,
    ChunkContent,
    ChunkDamage,
    Contents,
    LoadedChunk,
    Log,
    Loss,
    Messages,
    Span,
    concatenate_messages,
)
from dogbot_logtool.reader.packed_messages import unpacked
from dogbot_logtool.reader.source import ByteSource
from dogbot_logtool.reader.sqlite_topics import Topics, check_tables, read_topics

_CHUNK_SIZE: Final = 1 << 20
"""Bytes of messages from which a chunk is full."""
_ROWS_AT_ONCE: Final = 50_000
_SOUND: Final = (
    "typeof(data) = 'blob' AND typeof(timestamp) = 'integer' AND timestamp >= 0 "
    "AND typeof(topic_id) = 'integer'"
)
"""SQLite stores any type in any column."""


class SqliteLog(Log):
    """A .db3 file."""

    container = "ROS 2 bag (sqlite3)"

    def __init__(
        self, source: ByteSource, contents: Contents, rows: "_Rows", topics: Topics
    ) -> None:
        super().__init__(source, contents)
        self._rows = rows
        self._topics = topics

    @property
    def can_fork(self) -> bool:
        """See `Log.can_fork`; a connection to SQLite is of one process."""
        return False

    def read(self, span: Span) -> Batch:
        """See `Log.read`."""
        losses: list[Loss] = []
        loaded: list[LoadedChunk] = []
        parts: list[Messages] = []
        blobs: list[bytes] = []
        base = row = 0
        for chunk in span:
            try:
                messages, data = self._rows.read(chunk, self._topics)
            except sqlite3.Error as error:
                losses.append(_damage(chunk.messages, chunk.data_size, error))
                continue
            rows = slice(row, row + len(messages))
            loaded.append(LoadedChunk(chunk, memoryview(b""), base, rows, whole=False))
            parts.append(messages.shifted(base))
            blobs.append(data)
            base, row = base + len(data), rows.stop
        buffer = np.frombuffer(b"".join(blobs) or b"\0", np.uint8)
        return unpacked(Batch(buffer, concatenate_messages(parts), tuple(loaded), tuple(losses)))

    def check(self, chunk: Chunk) -> None:
        """See `Log.check`; what SQLite gives, it has."""

    def parse(self, chunk: Chunk, stored: memoryview, target: Bytes) -> ChunkContent:
        """See `Log.parse`; rows are read by `read`."""
        del chunk, stored, target
        raise ChunkDamage("a database has no chunks")

    def close(self) -> None:
        """Close the file."""
        self._rows.close()
        super().close()


class _Rows:
    """The rows of the table of messages; safe to share among threads."""

    def __init__(self, database: sqlite3.Connection) -> None:
        self._database = database
        self._lock = threading.Lock()

    def survey(self) -> Iterator[Ints]:
        """Yield (n, 4) row id, topic id, time in ns, and size of messages, in file order."""
        with self._lock:
            cursor = self._database.execute(
                "SELECT rowid, topic_id, timestamp, length(data) FROM messages "  # noqa: S608
                f"WHERE {_SOUND} ORDER BY rowid"
            )
            while rows := cursor.fetchmany(_ROWS_AT_ONCE):
                yield np.array(rows, np.int64)

    def unsound(self) -> int:
        """Return the number of rows that are no messages."""
        with self._lock:
            query = f"SELECT count(*) FROM messages WHERE NOT ({_SOUND})"  # noqa: S608
            return int(self._database.execute(query).fetchone()[0])

    def read(self, chunk: Chunk, topics: Topics) -> tuple[Messages, bytes]:
        """Return the messages of a chunk and their bytes."""
        with self._lock:
            rows = self._database.execute(
                "SELECT topic_id, timestamp, data FROM messages "  # noqa: S608
                f"WHERE rowid BETWEEN ? AND ? AND {_SOUND} ORDER BY rowid",
                (chunk.data_offset, chunk.end),
            ).fetchall()
        channel = topics.channel_of(np.array([row[0] for row in rows], np.int64))
        time = np.array([row[1] for row in rows], np.int64)
        sizes = np.array([len(row[2]) for row in rows], np.int64)
        ends = np.cumsum(sizes)
        none = np.zeros(len(rows), np.int64)
        messages = Messages(channel, time, time, none, ends - sizes, ends)
        data = b"".join([row[2] for row in rows])
        return messages.pick(channel > 0), data

    def close(self) -> None:
        with self._lock:
            self._database.close()


def open_sqlite(source: ByteSource, distribution: str = "") -> SqliteLog:
    """Open a .db3 file whose magic has been seen.

    Args:
        source: the file.
        distribution: ROS 2 distribution that recorded it, if metadata tells; the file's own
            word goes first.

    Raises:
        LogError: it is no ROS 2 bag, or nothing of it can be read.
    """
    database = None
    try:
        database, losses = _connect(source)
        check_tables(database, str(source.path))
        topics = read_topics(database, distribution)
        rows = _Rows(database)
        contents = _contents(rows, topics, losses)
        return SqliteLog(source, contents, rows, topics)
    except BaseException as error:
        if database is not None:
            database.close()
        if isinstance(error, sqlite3.Error | UnicodeDecodeError | OverflowError):
            raise LogError(f"{source.path}: its database cannot be read: {error}") from error
        raise


def _connect(source: ByteSource) -> tuple[sqlite3.Connection, list[Loss]]:
    """Open the database for reading only, with its write-ahead log if there is one."""
    path = Path(str(source.path))
    name = quote(os.fsencode(path.resolve()))
    journal = path.with_name(path.name + "-wal")
    problems: list[Loss] = []
    for access in ("mode=ro", "mode=ro&immutable=1") if journal.exists() else ("immutable=1",):
        database = sqlite3.connect(f"file:{name}?{access}", uri=True, check_same_thread=False)
        database.text_factory = _text
        try:
            database.execute("PRAGMA trusted_schema = OFF")
            database.execute("PRAGMA query_only = ON")
            database.execute("SELECT count(*) FROM sqlite_master").fetchone()
        except sqlite3.Error as error:
            database.close()
            what = f"the write-ahead log beside it cannot be read ({error})"
            problems.append(Loss(0, what, 0, None))
            continue
        return database, problems if access != "mode=ro" else []
    raise LogError(f"{source.path}: is a damaged SQLite database")


def _text(data: bytes) -> str:
    return data.decode("utf-8", "replace")


def _contents(rows: _Rows, topics: Topics, losses: list[Loss]) -> Contents:
    """Cut the rows into chunks, and count."""
    chunks: list[Chunk] = []
    counts: dict[int, int] = {}
    undescribed = 0
    try:
        for table in rows.survey():
            channel = topics.channel_of(table[:, 1])
            undescribed += int((channel == 0).sum())
            for part in _cut(table):
                chunk = _chunk(len(chunks), table[part], channel[part])
                chunks.append(chunk)
                for number, count in (chunk.counts or {}).items():
                    counts[number] = counts.get(number, 0) + count
        unsound = rows.unsound()
    except sqlite3.Error as error:
        losses.append(_damage(None, 0, error))
        unsound = 0
    for count, what in (
        (undescribed, "messages of topics that are nowhere described"),
        (unsound, "rows that are no messages"),
    ):
        if count:
            losses.append(Loss(0, f"the database holds {count} {what}", 0, count))
    starts = [chunk.start_time for chunk in chunks if chunk.start_time is not None]
    ends = [chunk.end_time for chunk in chunks if chunk.end_time is not None]
    return Contents(
        channels=topics.channels,
        chunks=chunks,
        counts={number: counts.get(number, 0) for number in topics.channels},
        start_time=min(starts, default=None),
        end_time=max(ends, default=None),
        profile="ros2",
        losses=tuple(losses),
    )


def _cut(table: Ints) -> Iterator[slice]:
    """Cut rows into runs of about `_CHUNK_SIZE` bytes."""
    full = np.cumsum(table[:, 3] + 1) // _CHUNK_SIZE
    edges = np.flatnonzero(np.diff(full)) + 1
    bounds = [0, *edges.tolist(), len(table)]
    for start, stop in pairwise(bounds):
        yield slice(start, stop)


def _chunk(number: int, table: Ints, channel: Ints) -> Chunk:
    numbers, counts = np.unique(channel[channel > 0], return_counts=True)
    time = table[channel > 0, 2]
    size = int(table[:, 3].sum())
    return Chunk(
        offset=number,
        data_offset=int(table[0, 0]),
        data_size=size,
        end=int(table[-1, 0]),
        index_end=int(table[-1, 0]),
        compression="",
        size=size,
        start_time=int(time.min()) if len(time) else None,
        end_time=int(time.max()) if len(time) else None,
        counts=dict(zip(numbers.tolist(), counts.tolist(), strict=True)),
    )


def _damage(messages: int | None, size: int, error: Exception) -> Loss:
    return Loss(0, f"the database is damaged ({error}): rows were left out", size, messages)
