"""The files of a dataset, on a disk or in a store: read, written and replaced as a whole."""

import io
import json
from contextlib import suppress
from pathlib import Path, PurePosixPath
from typing import Any, Final

import pyarrow as pa
import pyarrow.parquet as pq

from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.errors import CallError, LogtoolError, StoreError
from dogbot_logtool.io import storage
from dogbot_logtool.io.output import whole_file
from dogbot_logtool.io.storage import Location

_STATE: Final = b"dogbot_logtool"
"""Key of a file's metadata: what became of the log, as JSON."""


@dataclass(frozen=True, slots=True)
class Files:
    """The files below the directory or URL of a dataset: one a table and log."""

    root: Location

    def hashes(self) -> list[str]:
        """Return the names of the logs that are there."""
        folder = self.root / "logs"
        if isinstance(folder, Path):
            return sorted(file.stem for file in folder.glob("*.parquet"))
        folder.fs.invalidate_cache()
        names = map(PurePosixPath, storage.asked(folder, lambda: folder.fs.find(folder.path)))
        return sorted(name.stem for name in names if name.suffix == ".parquet")

    def read_log(self, log_hash: str) -> tuple[Any, dict[str, Any]] | None:
        """Return the row of a log, a `pyarrow.Table`, and its state; None: there is none.

        Raises:
            LogtoolError: it cannot be read.
        """
        file = self._file("logs", log_hash)
        try:
            if isinstance(file, Path):
                content = file.read_bytes()
            else:
                content = storage.asked(file, lambda: file.fs.cat_file(file.path))
            rows = pq.read_table(io.BytesIO(content), use_threads=False)
        except (FileNotFoundError, CallError):
            return None
        except StoreError:
            raise
        except (OSError, pa.ArrowException) as error:
            raise LogtoolError(f"{storage.shown(file)}: cannot be read: {error}") from error
        return rows, json.loads((rows.schema.metadata or {}).get(_STATE, b"{}"))

    def write(self, table: str, log_hash: str, rows: Any, state: dict[str, Any]) -> None:  # noqa: ANN401
        """Write, or replace, the rows of a log in a table, a `pyarrow.Table`.

        Raises:
            LogtoolError: they cannot be written.
        """
        buffer = io.BytesIO()
        marked = rows.replace_schema_metadata({_STATE: json.dumps(state)})
        pq.write_table(marked, buffer, compression="zstd", write_statistics=False)
        target = self._file(table, log_hash)
        if isinstance(target, Path):
            with whole_file(target, overwrite=True, makes_folder=True) as file:
                file.write(buffer.getvalue())
        else:
            # One request, so that the object is there as a whole or not at all.
            storage.asked(target, lambda: target.fs.pipe_file(target.path, buffer.getvalue()))

    def remove(self, table: str, log_hash: str) -> None:
        """Remove the rows of a log from a table, if they are there."""
        file = self._file(table, log_hash)
        if isinstance(file, Path):
            file.unlink(missing_ok=True)
            return
        with suppress(CallError):
            storage.asked(file, lambda: file.fs.rm_file(file.path))

    def _file(self, table: str, log_hash: str) -> Location:
        return self.root / table / f"{log_hash}.parquet"
