"""ROS 2 bags in SQLite (.db3): rows become messages, runs of rows become chunks."""

import sqlite3
from collections import Counter
from collections.abc import Iterator
from contextlib import suppress
from itertools import pairwise
from typing import Any, Final

import numpy as np

from dogbot_logtool.core.geometry.arrays import Ints
from dogbot_logtool.errors import LogError
from dogbot_logtool.io.storage import Location
from dogbot_logtool.reader.containers.batch import Batch, LoadedChunk
from dogbot_logtool.reader.containers.channel_ids import UNKNOWN_CHANNEL
from dogbot_logtool.reader.containers.chunks.packed_messages import unpacked
from dogbot_logtool.reader.containers.contents import Chunk, Contents
from dogbot_logtool.reader.containers.log import Log, Span
from dogbot_logtool.reader.containers.loss import Loss
from dogbot_logtool.reader.containers.sources.source import ByteSource
from dogbot_logtool.reader.containers.sqlite.database import (
    Database,
    PagesSharedError,
    open_database,
)
from dogbot_logtool.reader.containers.sqlite.topics import Topics, check_tables, read_topics
from dogbot_logtool.reader.decode.message_table import Messages, concatenate_messages

_CHUNK_SIZE: Final = 1 << 20
"""Bytes of messages from which a chunk is full."""
_BEFORE_ALL_ROWS: Final = -(2**63)
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

    def close(self) -> None:
        """Close the file."""
        self._rows.close()
        super().close()


class _Rows:
    """The rows of the table of messages; safe to share among threads."""

    def __init__(self, database: Database, path: Location) -> None:
        """Take a database.

        Raises:
            LogError: its rows have no numbers.
        """
        self._database = database
        self._key = _row_number(database, path)

    def headers(self) -> Iterator[Ints]:
        """Yield (n, 4) row number, topic id, time in ns, and size of messages, in file order.

        Raises:
            sqlite3.Error: the database is damaged, behind the rows that were yielded.
        """
        query = (
            f"SELECT {self._key}, topic_id, timestamp, length(data) FROM messages "  # noqa: S608
            f"WHERE {_SOUND} ORDER BY {self._key}"
        )
        rows = self._database.each(query)
        last: int | None = None
        size = 0
        for found in _in_parts(rows):
            table = np.array(found, np.int64)
            size += int(table[:, 3].sum())
            sound = _ascending(table[:, 0], last) if size <= self._database.size else 0
            if sound:
                yield table[:sound]
            if sound < len(table):
                raise PagesSharedError
            last = int(table[-1, 0])

    def headers_behind(self, last: int) -> Ints:
        """Return the rows behind damage, like `headers`: read from the end back to the damage.

        Args:
            last: number of the last row before the damage.
        """
        query = (
            f"SELECT {self._key}, topic_id, timestamp, length(data) FROM messages "  # noqa: S608
            f"WHERE {self._key} > ? AND {_SOUND} ORDER BY {self._key} DESC"
        )
        found: list[Any] = []
        with suppress(sqlite3.Error):
            for part in _in_parts(self._database.each(query, (last,))):
                found += part
        table = np.array(found[::-1], np.int64).reshape(-1, 4)
        is_sound = table[:, 3].sum() <= self._database.size
        return table if is_sound and _ascending(table[:, 0], last) == len(table) else table[:0]

    def unsound(self) -> int:
        """Return the number of rows that are no messages."""
        query = f"SELECT count(*) FROM messages WHERE NOT ({_SOUND})"  # noqa: S608
        return int(self._database.rows(query)[0][0])

    def read(self, chunk: Chunk, topics: Topics) -> tuple[Messages, bytes]:
        """Return the messages of a chunk and their bytes."""
        query = (
            f"SELECT {self._key}, topic_id, timestamp, data FROM messages "  # noqa: S608
            f"WHERE {self._key} BETWEEN ? AND ? AND {_SOUND} ORDER BY {self._key}"
        )
        rows = self._database.rows(query, (chunk.data_offset, chunk.end), last=chunk.end)
        if _ascending(np.array([row[0] for row in rows], np.int64), None) < len(rows):
            raise PagesSharedError
        channel = topics.ids.of(np.array([row[1] for row in rows], np.int64))
        time = np.array([row[2] for row in rows], np.int64)
        sizes = np.array([len(row[3]) for row in rows], np.int64)
        ends = np.cumsum(sizes)
        none = np.zeros(len(rows), np.int64)
        messages = Messages(channel, time, time, none, ends - sizes, ends)
        data = b"".join([row[3] for row in rows])
        return messages.pick(channel > 0), data

    def close(self) -> None:
        self._database.close()


def _in_parts(rows: Iterator[Any]) -> Iterator[list[Any]]:
    """Yield rows in lists; those before the one that cannot be read, too, and then raise."""
    part: list[Any] = []
    try:
        for row in rows:
            part.append(row)
            if len(part) == _ROWS_AT_ONCE:
                yield part
                part = []
    except sqlite3.Error:
        if part:
            yield part
        raise
    if part:
        yield part


def _row_number(database: Database, path: Location) -> str:
    """Return SQLite's name for the number of a row that no column of the table has taken.

    Raises:
        LogError: there is none.
    """
    taken = database.columns("messages")
    for name in ("rowid", "_rowid_", "oid"):
        if name not in taken:
            try:
                database.rows(f"SELECT {name} FROM messages LIMIT 0")  # noqa: S608
            except sqlite3.OperationalError:
                break
            return name
    raise LogError(f"{path}: is no ROS 2 bag: the rows of its table 'messages' have no numbers")


def _ascending(numbers: Ints, last: int | None) -> int:
    """Return how many numbers, from the first on, are each larger than the one before."""
    if len(numbers) and last is not None and numbers[0] <= last:
        return 0
    # A difference may not fit 64 bits.
    falls = np.flatnonzero(numbers[1:] <= numbers[:-1])
    return int(falls[0]) + 1 if len(falls) else len(numbers)


def open_sqlite(source: ByteSource, distribution: str) -> SqliteLog:
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
        database, losses = open_database(source)
        check_tables(database, source.path)
        topics = read_topics(database, distribution)
        rows = _Rows(database, source.path)
        contents = _contents(rows, topics, [*losses, *topics.losses])
        return SqliteLog(source, contents, rows, topics)
    except BaseException as error:
        if database is not None:
            database.close()
        if isinstance(error, sqlite3.Error | UnicodeDecodeError | OverflowError):
            raise LogError(f"{source.path}: its database cannot be read: {error}") from error
        raise


def _contents(rows: _Rows, topics: Topics, losses: list[Loss]) -> Contents:
    """Cut the rows into chunks, and count."""
    chunks: list[Chunk] = []
    undescribed = unsound = 0
    for table in _tables(rows, losses):
        channel = topics.ids.of(table[:, 1])
        undescribed += int((channel == UNKNOWN_CHANNEL).sum())
        chunks += [
            _chunk(number, table[part], channel[part])
            for number, part in enumerate(_cut(table), len(chunks))
        ]
    counts: Counter[int] = Counter()
    for chunk in chunks:
        counts.update(chunk.counts or {})
    try:
        unsound = rows.unsound()
    except sqlite3.Error as error:
        if not losses:
            losses.append(_damage(None, 0, error))
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
        counts={number: counts[number] for number in topics.channels},
        start_time=min(starts, default=None),
        end_time=max(ends, default=None),
        profile="ros2",
        losses=tuple(losses),
    )


def _tables(rows: _Rows, losses: list[Loss]) -> Iterator[Ints]:
    """Yield all rows that can be read, before damage and behind it, like `_Rows.headers`.

    Args:
        rows: of the table of messages.
        losses: receives the damage.
    """
    last = _BEFORE_ALL_ROWS
    try:
        for table in rows.headers():
            yield table
            last = int(table[-1, 0])
    except PagesSharedError as error:
        losses.append(_damage(None, 0, error))
    except sqlite3.Error as error:
        losses.append(_damage(None, 0, error))
        behind = rows.headers_behind(last)
        if len(behind):
            yield behind


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
