"""The figures of many logs as Parquet, for any SQL engine: a table of logs and one of strides.

    logs/robot=dogbot/month=2026-11/<log>.parquet        one row a log
    strides/robot=dogbot/month=2026-11/<log>.parquet     one row a stride of a foot
    events/robot=dogbot/month=2026-11/<log>.parquet      one row an event

Each log has a file of its own in each, named by a hash of its real path or its whole URL, that is
replaced as a whole: workers write them without asking each other, and whatever is written twice is
there once. The column `log` has no query of a URL, since it may hold secrets. `log_id` changes with
the log and the settings; tables joined on it never mix old and new. A log's strides and
events are written before its row of `logs`, and that row is what a later run looks for.
"""

import hashlib
import io
import json
import os
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, replace
from datetime import UTC, datetime
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Any, Final
from urllib.parse import quote

from dogbot_logtool import __version__
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.errors import CallError, ExtraMissingError, LogtoolError, StoreError
from dogbot_logtool.io import storage
from dogbot_logtool.io.output import whole_file
from dogbot_logtool.io.plain_json import to_json
from dogbot_logtool.io.storage import Location
from dogbot_logtool.report.figures.events import EVENTS
from dogbot_logtool.report.figures.figure import Kind, TableName
from dogbot_logtool.report.figures.tables import at, columns_of
from dogbot_logtool.results import Figures
from dogbot_logtool.run.inputs import Found, LogSet

if TYPE_CHECKING:
    from dogbot_logtool.pipeline.options import StatsOptions

try:
    import pyarrow as pa
    import pyarrow.dataset as ds
    import pyarrow.parquet as pq
except ImportError as error:
    raise ExtraMissingError("--parquet", "fleet") from error

SCHEMA_VERSION: Final = 3
"""Grows with every change of the columns' meaning."""
_SIMULATED_BEFORE_S: Final = 1_000_000_000
"""Log times before this are simulation time, not dates."""
_NEVER_S: Final = 1e11
_ASKED_AT_ONCE: Final = 16
_TYPES: Final = {
    Kind.TEXT: pa.string(),
    Kind.COUNT: pa.int64(),
    Kind.INTEGER: pa.int64(),
    Kind.FLAG: pa.bool_(),
}
"""Of columns; of all other kinds of figures, float64."""


def _figure_columns(table: TableName) -> list[tuple[str, pa.DataType]]:
    return [
        (each.column.header, _TYPES.get(each.figure.kind, pa.float64()))
        for each in columns_of(table)
    ]


_LOGS: Final = pa.schema(
    [
        ("log", pa.string()),
        ("log_id", pa.string()),
        ("start_time", pa.timestamp("us", "UTC")),
        ("damaged", pa.bool_()),
        *_figure_columns(TableName.LOG_ROWS),
        ("warnings", pa.int64()),
        ("figures_json", pa.string()),
        ("log_size_bytes", pa.int64()),
        ("log_version", pa.string()),
        ("settings_sha256", pa.string()),
    ]
)
_STRIDES: Final = pa.schema(
    [
        ("log", pa.string()),
        ("log_id", pa.string()),
        ("foot", pa.string()),
        ("place_end", pa.string()),
        ("place_side", pa.string()),
        *_figure_columns(TableName.STRIDE_ROWS),
    ]
)
_EVENTS: Final = pa.schema(
    [
        ("log", pa.string()),
        ("log_id", pa.string()),
        *((figure.key, _TYPES.get(figure.kind, pa.float64())) for figure in EVENTS),
    ]
)
_TABLES: Final = ("strides", "events", "logs")


@dataclass(frozen=True, slots=True)
class State:
    """A log as it is now."""

    name: str
    """Its whole path, or URL without query; as it may be shown."""
    key: str
    """Names its files; two logs never have the same."""
    size: int
    """Bytes."""
    version: str
    """Time of its last change, or the store's own tag; empty if unknown."""
    log_id: str
    """Changes with the log and the settings."""


@dataclass(frozen=True, slots=True)
class StoredLog:
    """A log whose figures are in the dataset."""

    log_id: str
    partition: str
    """Directories below that of the table, such as ``robot=dogbot/month=2026-11``."""
    damaged: bool


@dataclass(frozen=True, slots=True)
class Entry:
    """A log that is to be measured and written."""

    location: Location
    state: State
    old: StoredLog | None


@dataclass(frozen=True, slots=True)
class Pending:
    """The work that a run has to do."""

    entries: tuple[Entry, ...]
    log_set: LogSet
    """Logs of the entries, likewise."""
    unchanged: tuple[tuple[str, int], ...]
    """Names and exit codes of logs whose figures are there already."""


@dataclass(frozen=True, slots=True)
class Dataset:
    """A directory or a URL with the tables."""

    root: Location
    settings: str
    """All options that figures depend on, as JSON."""

    @property
    def settings_sha256(self) -> str:
        """A hash of the settings; another version of this program counts as another setting."""
        text = f"{SCHEMA_VERSION} {__version__} {self.settings}"
        return hashlib.sha256(text.encode()).hexdigest()

    def pending(self, log_set: LogSet) -> Pending:
        """Look which logs are not there, or not as they are now.

        Raises:
            StoreError: a store fails.
            LogtoolError: the dataset cannot be read.
        """
        with ThreadPoolExecutor(_ASKED_AT_ONCE) as pool:
            states = list(pool.map(self._state, log_set.paths))
        stored = dict(self._stored())
        entries: list[Entry] = []
        logs: list[Found] = []
        unchanged: list[tuple[str, int]] = []
        for log, state in zip(log_set.logs, states, strict=True):
            old = stored.get(state.key)
            if old is not None and old.log_id == state.log_id and state.version:
                unchanged.append((storage.shown(log.path), 3 if old.damaged else 0))
            else:
                entries.append(Entry(log.path, state, old))
                logs.append(log)
        return Pending(tuple(entries), replace(log_set, logs=tuple(logs)), tuple(unchanged))

    def write(self, figures: Figures, entry: Entry) -> None:
        """Write, or replace, the figures of a log.

        Raises:
            LogtoolError: it cannot be written.
        """
        partition = _partition(figures.robot, _month(figures.json["log"]["start_s"]))
        file = f"{entry.state.key}.parquet"
        strides = pa.table(_stride_columns(figures, entry.state), _STRIDES)
        events = pa.Table.from_pylist(_event_rows(figures, entry.state), _EVENTS)
        logs = pa.Table.from_pylist([self._log_row(figures, entry.state)], _LOGS)
        for table, rows in zip(_TABLES, (strides, events, logs), strict=True):
            self._write(self.root / table / partition / file, rows)
        if entry.old is not None and entry.old.partition != partition:
            for table in reversed(_TABLES):
                _remove(self.root / table / entry.old.partition / file)

    def _stored(self) -> Iterator[tuple[str, StoredLog]]:
        folder = self.root / "logs"
        try:
            if not storage.is_folder(folder):
                return
        except LogtoolError as error:
            if isinstance(error, StoreError):
                raise
            return
        filesystem, path = (
            (None, str(folder)) if isinstance(folder, Path) else (folder.fs, folder.path)
        )
        if filesystem is not None:
            filesystem.invalidate_cache()
        try:
            dataset = ds.dataset(path, _LOGS, format="parquet", filesystem=filesystem)
            table = dataset.to_table(["log_id", "damaged", "__filename"])
        except (OSError, pa.ArrowInvalid) as error:
            raise LogtoolError(f"{storage.shown(folder)}: cannot be read: {error}") from error
        for row in table.to_pylist():
            file = PurePosixPath(Path(row["__filename"]).as_posix())
            partition = f"{file.parts[-3]}/{file.parts[-2]}"
            yield file.stem, StoredLog(row["log_id"], partition, bool(row["damaged"]))

    def _state(self, location: Location) -> State:
        identity = os.fsencode(storage.identity(location))
        try:
            size, version = storage.version(location)
        except (LogtoolError, OSError):
            # Opening it reports what is wrong.
            size, version = 0, ""
        text = "\n".join((str(size), version, self.settings_sha256)).encode()
        return State(
            name=storage.shown(storage.from_root(location)),
            key=hashlib.sha256(identity).hexdigest()[:24],
            size=size,
            version=version,
            log_id=hashlib.sha256(identity + b"\n" + text).hexdigest()[:32],
        )

    def _write(self, target: Location, rows: pa.Table) -> None:
        origin = {
            "schema_version": SCHEMA_VERSION,
            "version": __version__,
            "settings": self.settings,
        }
        metadata = {f"dogbot_logtool.{key}": str(value) for key, value in origin.items()}
        buffer = io.BytesIO()
        pq.write_table(rows.replace_schema_metadata(metadata), buffer, compression="zstd")
        if isinstance(target, Path):
            try:
                target.parent.mkdir(parents=True, exist_ok=True)
            except OSError as error:
                raise LogtoolError(f"{target.parent}: cannot be made: {error.strerror}") from error
            with whole_file(target, overwrite=True) as file:
                file.write(buffer.getvalue())
        else:
            # One request, so that the object is there as a whole or not at all.
            storage.asked(target, lambda: target.fs.pipe_file(target.path, buffer.getvalue()))

    def _log_row(self, figures: Figures, state: State) -> dict[str, Any]:
        document = figures.json
        quality = document["quality"]
        return {
            "log": state.name,
            "log_id": state.log_id,
            "start_time": _date(document["log"]["start_s"]),
            "damaged": bool(quality["losses"]),
            **{
                each.column.header: at(document, each.path)
                for each in columns_of(TableName.LOG_ROWS)
            },
            "warnings": sum(each["severity"] != "note" for each in document["findings"]),
            "figures_json": to_json(document),
            "log_size_bytes": state.size,
            "log_version": state.version,
            "settings_sha256": self.settings_sha256,
        }


def dataset_at(location: Location, options: "StatsOptions") -> Dataset:
    """Return the dataset at a path or URL, for figures with some options.

    Raises:
        CallError: no dataset can be there.
    """
    if isinstance(location, Path):
        _refuse_bad_root(location)
    settings = asdict(replace(options, jobs=1))
    robot = options.topics.robot
    if robot is not None and robot.endswith(".toml"):
        # The file may change while its name does not.
        settings["robot_file"] = storage.content(Path(robot), 1 << 20)
    return Dataset(location, json.dumps(settings, sort_keys=True, default=repr))


def _refuse_bad_root(path: Path) -> None:
    name = storage.shown(path)
    if name != str(path):
        raise CallError(f"--parquet {name}: its name must be UTF-8, which all readers of it need")
    if path.exists() and not path.is_dir():
        raise CallError(f"--parquet {name}: is no directory")


def _date(start_s: float | None) -> datetime | None:
    """Return when a log begins; None if its clock is not the calendar's."""
    dated = start_s is not None and _SIMULATED_BEFORE_S <= start_s < _NEVER_S
    return datetime.fromtimestamp(start_s, UTC) if dated and start_s is not None else None


def _month(start_s: float | None) -> str:
    date = _date(start_s)
    return f"{date:%Y-%m}" if date else "unknown"


def _partition(robot: str, month: str) -> str:
    return f"robot={quote(robot, safe='')}/month={month}"


def _stride_columns(figures: Figures, state: State) -> dict[str, Sequence[Any]]:
    strides = figures.strides
    positions = {name: foot["place"] or (None, None) for name, foot in figures.json["feet"].items()}
    return {
        "log": [state.name] * len(strides.foot),
        "log_id": [state.log_id] * len(strides.foot),
        "foot": strides.foot,
        "place_end": [positions[foot][0] for foot in strides.foot],
        "place_side": [positions[foot][1] for foot in strides.foot],
        **{
            name: pa.array(column, from_pandas=True)  # NaN becomes null
            for name, column in strides.columns.items()
        },
    }


def _event_rows(figures: Figures, state: State) -> list[dict[str, Any]]:
    log = {"log": state.name, "log_id": state.log_id}
    return [{**log, **event} for event in figures.json["events"]]


def _remove(file: Location) -> None:
    if isinstance(file, Path):
        file.unlink(missing_ok=True)
    else:
        storage.asked(file, lambda: file.fs.rm_file(file.path))
