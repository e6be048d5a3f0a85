"""The files of a dataset, on a disk or in a store: read, written and replaced as a whole."""

import io
import os
import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path, PurePosixPath
from typing import Any, Final, TypeVar

from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.errors import ExtraMissingError, LogtoolError, StoreError
from dogbot_logtool.io import storage
from dogbot_logtool.io.output import whole_file
from dogbot_logtool.io.storage import Location
from dogbot_logtool.report.dataset.labels import Labels
from dogbot_logtool.report.dataset.parts import Contents, Part, StoredLog
from dogbot_logtool.report.dataset.schema import SCHEMA_VERSION, TableColumn, Type, tables

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]
try:
    import pyarrow as pa
    import pyarrow.parquet as pq
except ImportError as error:
    raise ExtraMissingError("--dataset", "fleet") from error

Result = TypeVar("Result")

_PART: Final = re.compile(r"part-(\d+)\.parquet")
_VERSION: Final = b"dogbot_logtool.schema_version"
_ROWS: Final = b"dogbot_logtool.rows"
_TYPES: Final = {
    Type.TEXT: pa.string(),
    Type.INTEGER: pa.int64(),
    Type.NUMBER: pa.float64(),
    Type.FLAG: pa.bool_(),
    Type.TIME: pa.timestamp("us", "UTC"),
    Type.NUMBERS: pa.list_(pa.float64()),
}
_KNOWN_BY: Final = ("log_key", "log", "log_id", "damaged", "error")
"""Columns of `logs` that tell which log it is, and what became of it."""


def schema_of(table: str, labels: Sequence[str] = ()) -> Any:  # noqa: ANN401 - pyarrow has no types
    """Return the `pyarrow.Schema` of a table, with columns for labels."""
    columns: tuple[TableColumn, ...] = tuple(tables()[table])
    fields = [(each.name, _TYPES[each.type]) for each in columns]
    return pa.schema([*fields, *((name, pa.string()) for name in labels)])


@dataclass(frozen=True, slots=True)
class Files:
    """The files below the directory or URL of a dataset."""

    root: Location

    def contents(self) -> Contents:
        """Read which logs are there.

        Raises:
            StoreError: a store fails.
            LogtoolError: it cannot be read, or is one of another version of this program.
        """
        parts = {table: set(self._parts(table)) for table in tables()}
        logs: list[StoredLog] = []
        rows: dict[Part, int] = {}
        label_names: dict[Part, frozenset[str]] = {}
        columns = schema_of("logs").names
        for part in sorted(parts["logs"]):
            file = self._open("logs", part)
            labels = sorted({*file.schema_arrow.names} - {*columns})
            label_names[part] = frozenset(labels)
            rows[part] = int((file.metadata.metadata or {}).get(_ROWS, b"0"))
            table = file.read([*_KNOWN_BY, *labels], use_threads=False)
            logs += (_stored(part, row, labels) for row in table.to_pylist())
        strays = [
            (table, part) for table in tables() for part in sorted(parts[table] - parts["logs"])
        ]
        return Contents(tuple(logs), rows, label_names, tuple(strays))

    def read(self, table: str, part: Part) -> Any:  # noqa: ANN401 - pyarrow has no types
        """Return the rows of a part, a `pyarrow.Table` without labels; none if it is not there."""
        schema = schema_of(table)
        if part not in self._parts(table, part.partition):
            return schema.empty_table()
        return self._open(table, part).read(schema.names, use_threads=False).cast(schema)

    def write(self, table: str, part: Part, rows: Any, others: int = 0) -> None:  # noqa: ANN401
        """Write, or replace, a part.

        Args:
            table: its name.
            part: which one.
            rows: a `pyarrow.Table`.
            others: rows of the other tables in the part.

        Raises:
            LogtoolError: it cannot be written.
        """
        metadata = {_VERSION: str(SCHEMA_VERSION), _ROWS: str(others)}
        buffer = io.BytesIO()
        pq.write_table(rows.replace_schema_metadata(metadata), buffer, compression="zstd")
        target = self.root / table / part.file
        if isinstance(target, Path):
            with whole_file(target, overwrite=True, makes_folder=True) as file:
                file.write(buffer.getvalue())
        else:
            # One request, so that the object is there as a whole or not at all.
            storage.asked(target, lambda: target.fs.pipe_file(target.path, buffer.getvalue()))

    def remove(self, table: str, part: Part) -> None:
        """Remove a part that is there, and on a disk the directories that are left empty."""
        file = self.root / table / part.file
        if not isinstance(file, Path):
            storage.asked(file, lambda: file.fs.rm_file(file.path))
            return
        file.unlink(missing_ok=True)
        with suppress(OSError):
            file.parent.rmdir()
            file.parent.parent.rmdir()

    @contextmanager
    def locked(self) -> Iterator[None]:
        """Let no other call on this machine write until the block ends; in a store any may."""
        if fcntl is None or not isinstance(self.root, Path):
            yield
            return
        try:
            self.root.mkdir(parents=True, exist_ok=True)
            handle = os.open(self.root, os.O_RDONLY)
        except OSError as error:
            name = storage.shown(self.root)
            raise LogtoolError(f"{name}: cannot be written: {error.strerror}") from error
        try:
            with suppress(OSError):  # a filesystem without locks
                fcntl.flock(handle, fcntl.LOCK_EX)
            yield
        finally:
            os.close(handle)

    def _parts(self, table: str, partition: str = "") -> Iterator[Part]:
        """Yield the parts of a table, or of one of its partitions.

        Raises:
            LogtoolError: there are files of another layout.
        """
        folder = self.root / table / partition if partition else self.root / table
        for name in self._readable(folder, lambda: _files_below(folder)):
            path = PurePosixPath(name)
            number = _PART.fullmatch(path.name)
            if number is None:
                raise self._other_version("of an older version of this program")
            yield Part(f"{path.parts[-3]}/{path.parts[-2]}", int(number[1]))

    def _open(self, table: str, part: Part) -> Any:  # noqa: ANN401 - pyarrow has no types
        file = self.root / table / part.file
        opened = self._readable(
            file,
            lambda: pq.ParquetFile(
                file if isinstance(file, Path) else file.fs.open(file.path, "rb"),
                pre_buffer=not isinstance(file, Path),
            ),
        )
        version = (opened.metadata.metadata or {}).get(_VERSION, b"").decode()
        if version != str(SCHEMA_VERSION):
            raise self._other_version(f"of layout {version or 'unknown'}, not {SCHEMA_VERSION}")
        return opened

    def _other_version(self, what: str) -> LogtoolError:
        name = storage.shown(self.root)
        return LogtoolError(
            f"{name}: is a dataset {what}, which cannot be added to; its files stay readable. Name "
            "another directory: all logs that are there are measured anew"
        )

    def _readable(self, location: Location, read: Callable[[], Result]) -> Result:
        """Return what is read; an error is one that has a sentence."""
        try:
            return read() if isinstance(location, Path) else storage.asked(location, read)
        except StoreError:
            raise
        except (OSError, pa.ArrowInvalid) as error:
            raise LogtoolError(f"{storage.shown(location)}: cannot be read: {error}") from error


def _files_below(folder: Location) -> list[str]:
    """Return the Parquet files in the partitions of a table."""
    if isinstance(folder, Path):
        return [file.as_posix() for file in sorted(folder.rglob("*.parquet"))]
    folder.fs.invalidate_cache()
    names = [str(name) for name in folder.fs.find(folder.path)]
    return sorted(name for name in names if name.endswith(".parquet"))


def _stored(part: Part, row: dict[str, Any], label_names: Sequence[str]) -> StoredLog:
    labels: Labels = {name: row[name] for name in label_names if row[name] is not None}
    return StoredLog(
        part, row["log_key"], row["log"], row["log_id"], row["damaged"], row["error"], labels
    )
