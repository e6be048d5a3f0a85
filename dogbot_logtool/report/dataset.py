"""The metrics of many logs as Parquet, for any SQL engine: what `export --dataset` keeps.

    logs/3f2a....parquet       a row: a log, with groups of metrics as structs (base, gait ...)
    feet/3f2a....parquet       a row a foot of that log; likewise strides, events, findings

A file is named by the hash of its log's path. Writing is replacing that file; those of other logs
are never opened. Two calls that write one log write the same bytes, so nothing is locked.
"""

import hashlib
import io
import json
import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any, Final, NamedTuple

from dogbot_logtool import __version__
from dogbot_logtool.core.metrics import SCHEMA_VERSION
from dogbot_logtool.errors import DAMAGED, CallError, ExtraMissingError, LogtoolError
from dogbot_logtool.io import storage
from dogbot_logtool.io.output import whole_file
from dogbot_logtool.io.storage import Location, valid_unicode
from dogbot_logtool.option import part_of
from dogbot_logtool.options import MeasureOptions
from dogbot_logtool.reader.containers.loss import Damage
from dogbot_logtool.report.dataset_tables import TABLES, Labels, Tables, log_row, with_labels
from dogbot_logtool.run.inputs import LogSet

try:
    import pyarrow as pa
    import pyarrow.parquet as pq
except ImportError as error:
    raise ExtraMissingError("--dataset", "fleet") from error


_STATE: Final = b"dogbot_logtool"
"""Key of a file's metadata: what became of the log, as JSON."""
_MOST_BYTES: Final = 1 << 28
"""Of a file of a dataset, or of a robot's file, that is read."""
_ASKED_AT_ONCE: Final = 16


class Entry(NamedTuple):
    """A log that was named."""

    location: Location
    log_hash: str
    """Names its files: of its real path, or its whole URL."""
    labels: Labels
    state: str = ""
    """What its metrics depend on, as JSON; empty: there is no such log."""
    damaged: bool | None = None
    """Of a log that is there already: whether it is damaged; None: it is to be measured."""


class MeasuredEntry(NamedTuple):
    """A log that was measured for a dataset."""

    entry: Entry
    tables: Tables
    damage: Damage


class Pending(NamedTuple):
    """The work that a run has to do."""

    entries: tuple[Entry, ...]
    log_set: LogSet
    """Logs of the entries, likewise."""
    unchanged: tuple[tuple[str, int], ...]
    """Names and exit codes of logs whose metrics are there already."""
    pruned: tuple[str, ...]
    """Names of logs that were removed from the dataset."""


class Dataset(NamedTuple):
    """A directory or a URL with the tables: a file each a log."""

    root: Location
    settings: str
    """Hash of the options that metrics depend on."""
    labels: Labels
    """Labels that all logs of the call get; an empty one takes a label away."""

    def begin(self, log_set: LogSet, *, prune: bool = False) -> Pending:
        """Look which logs are not there, or not as they are now; remove those that are gone.

        Raises:
            StoreError: a store fails.
            LogtoolError: the dataset cannot be read or written.
        """
        with ThreadPoolExecutor(_ASKED_AT_ONCE) as pool:
            found = list(pool.map(self._look_at, log_set.paths))
        pending = [each for each in found if each.damaged is None]
        both = zip(log_set.logs, found, strict=True)
        log_set = log_set._replace(logs=tuple(log for log, each in both if each.damaged is None))
        unchanged = [
            (storage.name_of(each.location), DAMAGED if each.damaged else 0)
            for each in found
            if each.damaged is not None
        ]
        pruned = self._prune({each.log_hash for each in found}) if prune else ()
        return Pending(tuple(pending), log_set, tuple(unchanged), pruned)

    def write(self, entry: Entry, tables: Tables, *, damaged: bool) -> None:
        """Write the rows of a log, that of `logs` last.

        Raises:
            LogtoolError: they cannot be written.
        """
        state = {"state": entry.state, "damaged": damaged}
        path = storage.name_of(entry.location.absolute())
        for table in TABLES:
            if table not in tables:
                self._remove(table, entry.log_hash)
                continue
            rows = tables[table]
            rows = rows.add_column(0, "log_hash", pa.array([entry.log_hash] * len(rows)))
            if table == "logs":
                rows = with_labels(rows.add_column(1, "path", [[path]]), entry.labels)
            self._store(table, entry.log_hash, rows, state)

    def write_failed(self, entry: Entry, sentence: str) -> None:
        """Write that a log could not be measured, which is tried again each time.

        One that is not there at all leaves no row.
        """
        if entry.state:
            self.write(entry._replace(state=""), log_row({}, sentence), damaged=False)

    def _look_at(self, location: Location) -> Entry:
        log_hash = hash_of(location)
        row, known = self._read_log(log_hash) or (None, {})
        old = {} if row is None else dict(row["labels"][0].as_py())
        given = {**old, **self.labels}
        entry = Entry(
            location, log_hash, {name: given[name] for name in sorted(given) if given[name]}
        )
        try:
            size, version = storage.version(location)
        except (LogtoolError, OSError):
            return entry  # opening it reports what is wrong
        state = json.dumps([SCHEMA_VERSION, __version__, self.settings, size, version])
        entry = entry._replace(state=state)
        if not version or known.get("state") != state:
            return entry
        if entry.labels != old:
            self._store("logs", log_hash, with_labels(row, entry.labels), known)
        return entry._replace(damaged=bool(known["damaged"]))

    def _prune(self, named: set[str]) -> tuple[str, ...]:
        """Remove the files of logs that are gone, but for those named in the call."""
        files: Sequence[Location] = ()
        with suppress(CallError, FileNotFoundError):
            files = storage.files_in(self.root / "logs")
        hashes = sorted(file.stem for file in files if file.suffix == ".parquet")
        others = [each for each in hashes if each not in named]
        with ThreadPoolExecutor(_ASKED_AT_ONCE) as pool:
            gone = [each for each in pool.map(self._gone, others) if each]
        for _, log_hash in gone:
            for table in reversed(TABLES):
                self._remove(table, log_hash)
        return tuple(name for name, _ in gone)

    def _gone(self, log_hash: str) -> tuple[str, str] | None:
        """Return the name and the hash of a log that is gone for certain."""
        stored = self._read_log(log_hash)
        if stored is None:
            return None
        name = stored[0]["path"][0].as_py()
        return (name, log_hash) if is_gone(name, log_hash) else None

    def _file(self, table: str, log_hash: str) -> Location:
        return self.root / table / f"{log_hash}.parquet"

    def _read_log(self, log_hash: str) -> tuple[Any, dict[str, Any]] | None:
        """Return the row of a log, a `pyarrow.Table`, and its state; None: there is none."""
        file = self._file("logs", log_hash)
        try:
            content = storage.content(file, _MOST_BYTES)
            rows = pq.read_table(io.BytesIO(content), use_threads=False)
        except CallError:
            return None
        except (OSError, pa.ArrowException) as error:
            raise LogtoolError(f"{storage.name_of(file)}: cannot be read: {error}") from error
        return rows, json.loads((rows.schema.metadata or {}).get(_STATE, b"{}"))

    def _store(self, table: str, log_hash: str, rows: Any, state: dict[str, Any]) -> None:  # noqa: ANN401
        """Write the rows of a log in a table, a `pyarrow.Table`, in the place of any before."""
        buffer = io.BytesIO()
        marked = rows.replace_schema_metadata({_STATE: json.dumps(state)})
        pq.write_table(marked, buffer, compression="zstd", write_statistics=False)
        with whole_file(self._file(table, log_hash), overwrite=True) as file:
            file.write(buffer.getvalue())

    def _remove(self, table: str, log_hash: str) -> None:
        """Remove the rows of a log from a table, if they are there."""
        file = self._file(table, log_hash)
        if isinstance(file, Path):
            file.unlink(missing_ok=True)
            return
        with suppress(CallError), storage.asking(file):
            file.fs.rm_file(file.path)


def dataset_at(root: Location, options: MeasureOptions, labels: Labels) -> Dataset:
    """Return the dataset at a path or URL, for metrics with some options.

    Raises:
        CallError: no dataset can be there.
    """
    if isinstance(root, Path):
        _refuse_bad_root(root)
    settings = asdict(replace(part_of(options, MeasureOptions), jobs=1))
    robot = options.robot
    if robot is not None and robot.endswith(".toml"):
        # The file may change while its name does not.
        settings["robot_file"] = storage.content(Path(robot), _MOST_BYTES)
    text = json.dumps(settings, sort_keys=True, default=repr)
    return Dataset(root, hashlib.sha256(text.encode()).hexdigest(), labels)


def _refuse_bad_root(path: Path) -> None:
    name = storage.name_of(path)
    if name != str(path):
        raise CallError(f"--dataset {name}: its name must be UTF-8, which all readers of it need")
    if path.exists() and not path.is_dir():
        raise CallError(f"--dataset {name}: is no directory")
    if next(path.glob("logs/robot=*"), None) is not None:
        raise CallError(
            f"--dataset {name}: is of an older version of this program, which cannot be added to; "
            "name another directory: its logs are measured anew"
        )


def parse_labels(words: Sequence[str]) -> Labels:
    """Return the labels of `--label` options; an empty value takes a label away.

    Raises:
        CallError: one is no ``name=value``, or is there twice.
    """
    labels: dict[str, str] = {}
    for word in map(valid_unicode, words):
        name, equals, value = word.partition("=")
        if not (equals and name):
            raise CallError(f"--label {word}: must be NAME=VALUE, such as firmware=3.2")
        if name in labels:
            raise CallError(f"--label {word}: {name} is there twice")
        labels[name] = value
    return labels


def hash_of(location: Location) -> str:
    """Return what names the files of a log: a hash of its real path or its whole URL."""
    return hashlib.sha256(os.fsencode(storage.identity(location))).hexdigest()[:24]


def is_gone(name: str, log_hash: str) -> bool:
    """Tell whether a log is gone for certain; one that cannot be looked for is not.

    Args:
        name: of the log, as it may be shown.
        log_hash: of its place.
    """
    try:
        location = storage.location(name)
        if hash_of(location) != log_hash:
            return False  # what is shown is not the whole name: a URL may hold secrets
        if isinstance(location, Path):
            os.lstat(location)
            return False
        return not storage.exists(location)
    except (FileNotFoundError, NotADirectoryError):
        return True
    except (LogtoolError, OSError, ValueError):
        return False
