"""A SQLite database opened for reading only: nothing is written beside it, and every query ends."""

import os
import shutil
import sqlite3
import struct
import tempfile
import threading
from collections.abc import Iterator, Sequence
from contextlib import closing
from pathlib import Path
from typing import Any, Final
from urllib.parse import quote

from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.errors import LogError
from dogbot_logtool.io.scratch import scratch_folder
from dogbot_logtool.reader.containers.loss import Loss
from dogbot_logtool.reader.containers.sources.source import ByteSource

_ROWS_AT_ONCE: Final = 50_000
_STEPS_BETWEEN_CHECKS: Final = 100_000
_FEWEST_STEPS: Final = 10_000_000
_STEPS_PER_BYTE: Final = 10
"""A row takes eight bytes at least, and a query some thirty steps of SQLite's machine for it."""
_WAL: Final = "-wal"
_JOURNAL: Final = "-journal"
_HEADER_SIZE: Final = 100
_JOURNAL_MAGIC: Final = bytes.fromhex("d9d505f920a163d7")


class PagesSharedError(sqlite3.DatabaseError):
    """Several parts of the database claim the same pages, so that reading might never end."""

    def __init__(self) -> None:
        super().__init__("its pages are used more than once")


class Database:
    """A connection that may be shared among threads."""

    def __init__(self, connection: sqlite3.Connection, size: int) -> None:
        """Take a connection.

        Args:
            connection: it, open.
            size: bytes of the file; no honest query reads more.
        """
        self._connection = connection
        self.size = size
        self._lock = threading.Lock()
        self._steps = 0
        connection.set_progress_handler(self._is_endless, _STEPS_BETWEEN_CHECKS)

    def each(self, query: str, parameters: Sequence[Any] = ()) -> Iterator[Any]:
        """Yield the rows of a query; other threads wait meanwhile.

        Raises:
            sqlite3.Error: the database is damaged, or its pages refer to each other in a loop.
        """
        with self._lock:
            self._steps = 0
            try:
                yield from self._connection.execute(query, parameters)
            except sqlite3.OperationalError as error:
                if self._steps > self._most_steps:
                    raise PagesSharedError from error
                raise

    def rows(
        self, query: str, parameters: Sequence[Any] = (), last: int | None = None
    ) -> list[Any]:
        """Return all rows of a query.

        Args:
            query: in SQL.
            parameters: of it.
            last: what the last row begins with, so that nothing is looked for behind it, where
                the database may be damaged.

        Raises:
            sqlite3.Error: see `each`; or the rows hold more than the file.
        """
        found: list[Any] = []
        size = 0
        for row in self.each(query, parameters):
            size += sum(len(value) for value in row if isinstance(value, str | bytes))
            if size > self.size:
                raise PagesSharedError
            found.append(row)
            if last is not None and row[0] == last:
                break
        return found

    def columns(self, table: str) -> frozenset[str]:
        """Return the names of a plain table's plain columns, in lower case; no table: none.

        Columns that are computed are left out, and views and virtual tables are no plain tables.
        """
        query = "SELECT sql FROM sqlite_master WHERE type = 'table' AND name = ? COLLATE NOCASE"
        statements = self.rows(query, (table,))
        if not statements or not str(statements[0][0]).lstrip().upper().startswith("CREATE TABLE"):
            return frozenset()
        found = self.rows(f"PRAGMA table_xinfo({table})")
        return frozenset(str(column[1]).lower() for column in found if column[6] == 0)

    @property
    def _most_steps(self) -> int:
        return _FEWEST_STEPS + _STEPS_PER_BYTE * self.size

    def _is_endless(self) -> bool:
        """Tell SQLite whether to give up a query."""
        self._steps += _STEPS_BETWEEN_CHECKS
        return self._steps > self._most_steps

    def close(self) -> None:
        """Close it."""
        with self._lock:
            self._connection.close()


def open_database(source: ByteSource) -> tuple[Database, list[Loss]]:
    """Open a database, with what the journal beside it adds or takes back.

    SQLite would write into the directory for that, so it is done on a copy.

    Raises:
        LogError: there is no room for the copy.
        sqlite3.Error: the database is damaged.
    """
    path = Path(str(source.path)).resolve()
    journals = _journals(path)
    if not journals:
        cut = _cut_off(path)
        return (
            (_connect(path), []) if cut is None else (_connect_whole_pages(path, cut), [cut.loss])
        )
    with scratch_folder() as folder:
        copy = folder / "copy.db3"
        try:
            _copy(path, copy, journals)
            _settle(copy)
            # The copy's name goes, but the connection holds its bytes open.
            database = _connect(copy)
        except sqlite3.Error as error:
            names = " and ".join(path.name + suffix for suffix in journals)
            what = f"{names} beside it cannot be used ({error}); it was read without it"
            return _connect(path), [Loss(0, what, 0, None)]
        except OSError as error:
            names = " and ".join(path.name + suffix for suffix in journals)
            raise LogError(
                f"{source.path}: its recording was not closed, and with {names} it cannot be "
                f"copied to {tempfile.gettempdir()} to be read: {error.strerror or error}; set "
                "TMPDIR to a directory with more room"
            ) from error
    return database, [_rolled_back(path)] if _JOURNAL in journals else []


@dataclass(frozen=True, slots=True)
class _CutOff:
    """A file that has fewer bytes than its header promises."""

    loss: Loss
    whole: int
    """Bytes of its whole pages. SQLite would fill the last one up with zeros."""


def _cut_off(path: Path) -> _CutOff | None:
    with path.open("rb") as file:
        header = file.read(_HEADER_SIZE)
        size = file.seek(0, os.SEEK_END)
    if len(header) < _HEADER_SIZE or header[24:28] != header[92:96]:
        # Old writers leave the number of pages as it was.
        return None
    page_size, pages = struct.unpack(">16xH10xI68x", header)
    page_size = page_size if page_size != 1 else 1 << 16
    if size >= page_size * pages:
        return None
    what = f"the file is cut off: it promises {page_size * pages} bytes, but has {size}"
    return _CutOff(Loss(size, f"{what}; copy it again", 0, None), size - size % page_size)


def _connect_whole_pages(path: Path, cut: _CutOff) -> Database:
    if path.stat().st_size == cut.whole:
        return _connect(path, cut_off=True)
    with scratch_folder() as folder:
        copy = folder / "copy.db3"
        shutil.copyfile(path, copy)
        os.truncate(copy, cut.whole)
        return _connect(copy, cut_off=True)


def _rolled_back(path: Path) -> Loss:
    what = (
        f"its recording broke off while rows were written: {path.name + _JOURNAL} beside it tells "
        "what they were before, and the log was read so"
    )
    return Loss(0, what, 0, None)


def _journals(path: Path) -> list[str]:
    """Return the suffixes of the journals without which a database does not mean what it says."""
    wal, journal = (path.with_name(path.name + suffix) for suffix in (_WAL, _JOURNAL))
    found = [_WAL] if wal.is_file() and wal.stat().st_size else []
    if journal.is_file() and _is_hot(journal):
        found.append(_JOURNAL)
    return found


def _is_hot(journal: Path) -> bool:
    """Tell whether a journal is still needed; else it is empty, or its header overwritten."""
    try:
        with journal.open("rb") as file:
            return file.read(len(_JOURNAL_MAGIC)) == _JOURNAL_MAGIC
    except OSError:
        # Whatever hinders reading it is said when it is copied.
        return True


def _copy(path: Path, copy: Path, journals: Sequence[str]) -> None:
    pairs = [(path, copy)]
    pairs += [
        (path.with_name(path.name + end), copy.with_name(copy.name + end)) for end in journals
    ]
    needed = sum(file.stat().st_size for file, _ in pairs)
    free = shutil.disk_usage(copy.parent).free
    if needed > free:
        raise OSError(f"it needs {needed >> 20} MB, of which {free >> 20} are free")
    for file, target in pairs:
        shutil.copyfile(file, target)


def _settle(copy: Path) -> None:
    """Let SQLite take its journals into a database."""
    with closing(sqlite3.connect(copy, isolation_level=None)) as connection:
        connection.execute("PRAGMA trusted_schema = OFF")
        connection.execute("SELECT 1 FROM sqlite_master LIMIT 1").fetchone()
        connection.execute("PRAGMA journal_mode = DELETE").fetchone()


def _connect(path: Path, *, cut_off: bool = False) -> Database:
    # Names on a disk may be any bytes.
    name = quote(os.fsencode(path))
    connection = sqlite3.connect(f"file:{name}?immutable=1", uri=True, check_same_thread=False)
    try:
        connection.text_factory = _text
        database = Database(connection, path.stat().st_size)
        settings = ["trusted_schema = OFF", "query_only = ON"]
        if cut_off:
            # Else SQLite does not read the pages that are there.
            settings.append("writable_schema = ON")
        for setting in settings:
            database.rows(f"PRAGMA {setting}")
        database.rows("SELECT 1 FROM sqlite_master LIMIT 1")
    except BaseException:
        connection.close()
        raise
    return database


def _text(data: bytes) -> str:
    return data.decode("utf-8", "replace")
