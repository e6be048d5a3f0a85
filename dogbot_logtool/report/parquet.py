"""The figures of many logs as Parquet, for any SQL engine: a table of logs and one of strides.

    logs/robot=dogbot/month=2026-11/<log>.parquet        one row a log
    strides/robot=dogbot/month=2026-11/<log>.parquet     one row a stride of a foot

Each log has a file of its own in both, named by a hash of its real path or its whole URL, that is
replaced as a whole: workers write them without asking each other, and whatever is written twice is
there once. The column `log` has no query of a URL, since it may hold secrets. `log_id` changes with
the log and the settings; tables joined on it never mix old and new. A log's strides are written
before its row of `logs`, and that row is what a later run looks for.
"""

import hashlib
import io
import json
import os
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass, replace
from datetime import UTC, datetime
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Any, Final
from urllib.parse import quote

from dogbot_logtool import __version__
from dogbot_logtool.errors import CallError, ExtraMissingError, LogtoolError, StoreError
from dogbot_logtool.io import storage
from dogbot_logtool.io.output import whole_file
from dogbot_logtool.io.plain_json import to_json
from dogbot_logtool.io.storage import Location
from dogbot_logtool.results import Figures
from dogbot_logtool.run.inputs import Fleet, Found

if TYPE_CHECKING:
    from dogbot_logtool.pipeline.options import StatsOptions

try:
    import pyarrow as pa
    import pyarrow.dataset as ds
    import pyarrow.parquet as pq
except ImportError as error:
    raise ExtraMissingError("--parquet", "fleet") from error

SCHEMA_VERSION: Final = 1
"""Grows with every change of the columns' meaning."""
_SIMULATED_BEFORE_S: Final = 1_000_000_000
"""Log times before this are simulation time, not dates."""
_NEVER_S: Final = 1e11
_ASKED_AT_ONCE: Final = 16
_LOGS: Final = pa.schema(
    [
        ("log", pa.string()),
        ("log_id", pa.string()),
        ("container", pa.string()),
        ("start_time", pa.timestamp("us", "UTC")),
        ("start_s", pa.float64()),
        ("duration_s", pa.float64()),
        ("messages", pa.int64()),
        ("damaged", pa.bool_()),
        ("lost_messages", pa.int64()),
        ("lost_bytes", pa.int64()),
        ("gait", pa.string()),
        ("sequence", pa.string()),
        ("duty_factor", pa.float64()),
        ("stride_frequency_hz", pa.float64()),
        ("forward_speed_mps", pa.float64()),
        ("path_length_m", pa.float64()),
        ("vertical_impulse_over_weight", pa.float64()),
        ("mass_kg", pa.float64()),
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
        ("start_s", pa.float64()),
        ("stance_s", pa.float64()),
        ("swing_s", pa.float64()),
        ("duty_factor", pa.float64()),
        ("length_m", pa.float64()),
        ("peak_force_n", pa.float64()),
        ("vertical_impulse_ns", pa.float64()),
        ("slip_m", pa.float64()),
    ]
)


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
class Kept:
    """What is in the dataset of a log."""

    log_id: str
    partition: str
    """Directories below that of the table, such as ``robot=dogbot/month=2026-11``."""
    damaged: bool


@dataclass(frozen=True, slots=True)
class Entry:
    """A log that is to be measured and kept."""

    place: Location
    state: State
    old: Kept | None


@dataclass(frozen=True, slots=True)
class Todo:
    """What a run has to do."""

    entries: tuple[Entry, ...]
    fleet: Fleet
    """Logs of the entries, likewise."""
    unchanged: tuple[tuple[str, int], ...]
    """Names and exit codes of logs whose figures are there already."""


@dataclass(frozen=True, slots=True)
class Dataset:
    """A directory or a URL with the two tables."""

    root: Location
    settings: str
    """All options that figures depend on, as JSON."""

    @property
    def settings_sha256(self) -> str:
        """What tells settings apart; another version of this program counts as another setting."""
        told = f"{SCHEMA_VERSION} {__version__} {self.settings}"
        return hashlib.sha256(told.encode()).hexdigest()

    def todo(self, fleet: Fleet) -> Todo:
        """Look which logs are not there, or not as they are now.

        Raises:
            StoreError: a store fails.
            LogtoolError: the dataset cannot be read.
        """
        with ThreadPoolExecutor(_ASKED_AT_ONCE) as pool:
            states = list(pool.map(self._state, fleet.places))
        kept = dict(self._kept())
        entries: list[Entry] = []
        logs: list[Found] = []
        unchanged: list[tuple[str, int]] = []
        for log, state in zip(fleet.logs, states, strict=True):
            old = kept.get(state.key)
            if old is not None and old.log_id == state.log_id and state.version:
                unchanged.append((storage.shown(log.place), 3 if old.damaged else 0))
            else:
                entries.append(Entry(log.place, state, old))
                logs.append(log)
        return Todo(tuple(entries), replace(fleet, logs=tuple(logs)), tuple(unchanged))

    def keep(self, figures: Figures, entry: Entry) -> None:
        """Write, or replace, what is known of a log.

        Raises:
            LogtoolError: it cannot be written.
        """
        partition = _partition(figures.robot, _month(figures.json["log"]["start_s"]))
        file = f"{entry.state.key}.parquet"
        strides = pa.table(_stride_columns(figures, entry.state), _STRIDES)
        logs = pa.Table.from_pylist([self._log_row(figures, entry.state)], _LOGS)
        for table, rows in (("strides", strides), ("logs", logs)):
            self._write(self.root / table / partition / file, rows)
        if entry.old is not None and entry.old.partition != partition:
            for table in ("logs", "strides"):
                _remove(self.root / table / entry.old.partition / file)

    def _kept(self) -> Iterator[tuple[str, Kept]]:
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
            yield file.stem, Kept(row["log_id"], partition, bool(row["damaged"]))

    def _state(self, place: Location) -> State:
        identity = os.fsencode(storage.identity(place))
        try:
            size, version = storage.version(place)
        except (LogtoolError, OSError):
            # Whoever opens it will say what is wrong.
            size, version = 0, ""
        told = "\n".join((str(size), version, self.settings_sha256)).encode()
        return State(
            name=storage.shown(storage.from_root(place)),
            key=hashlib.sha256(identity).hexdigest()[:24],
            size=size,
            version=version,
            log_id=hashlib.sha256(identity + b"\n" + told).hexdigest()[:32],
        )

    def _write(self, target: Location, rows: pa.Table) -> None:
        told = {"schema_version": SCHEMA_VERSION, "version": __version__, "settings": self.settings}
        metadata = {f"dogbot_logtool.{key}": str(value) for key, value in told.items()}
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
        said = figures.json
        log, gait, base, quality = said["log"], said["gait"], said["base"], said["quality"]
        return {
            "log": state.name,
            "log_id": state.log_id,
            "container": log["container"],
            "start_time": _date(log["start_s"]),
            "start_s": log["start_s"],
            "duration_s": log["duration_s"],
            "messages": log["messages"],
            "damaged": bool(quality["losses"]),
            "lost_messages": quality["lost_messages"],
            "lost_bytes": quality["lost_bytes"],
            "gait": gait["class"],
            "sequence": gait["sequence"],
            "duty_factor": gait["duty_factor"],
            "stride_frequency_hz": gait["stride_frequency_hz"],
            "forward_speed_mps": base and base["forward_speed_mps"],
            "path_length_m": base and base["path_length_m"],
            "vertical_impulse_over_weight": said["forces"]["vertical_impulse_over_weight"],
            "mass_kg": said["settings"]["mass_kg"],
            "warnings": len(quality["findings"]),
            "figures_json": to_json(said),
            "log_size_bytes": state.size,
            "log_version": state.version,
            "settings_sha256": self.settings_sha256,
        }


def dataset_at(place: Location, options: "StatsOptions") -> Dataset:
    """Return the dataset at a place, for figures with some options.

    Raises:
        CallError: no dataset can be there.
    """
    if isinstance(place, Path):
        _refuse_bad_root(place)
    told = asdict(replace(options, jobs=1))
    robot = options.topics.robot
    if robot is not None and robot.endswith(".toml"):
        # The file may change while its name does not.
        told["robot_file"] = storage.content(Path(robot), 1 << 20)
    return Dataset(place, json.dumps(told, sort_keys=True, default=repr))


def _refuse_bad_root(place: Path) -> None:
    name = storage.shown(place)
    if name != str(place):
        raise CallError(f"--parquet {name}: its name must be UTF-8, which all readers of it need")
    if place.exists() and not place.is_dir():
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
    places = {name: foot["place"] or (None, None) for name, foot in figures.json["feet"].items()}
    return {
        "log": [state.name] * len(strides.foot),
        "log_id": [state.log_id] * len(strides.foot),
        "foot": strides.foot,
        "place_end": [places[foot][0] for foot in strides.foot],
        "place_side": [places[foot][1] for foot in strides.foot],
        **{
            name: pa.array(column, from_pandas=True)  # NaN becomes null
            for name, column in strides.columns.items()
        },
    }


def _remove(file: Location) -> None:
    if isinstance(file, Path):
        file.unlink(missing_ok=True)
    else:
        storage.asked(file, lambda: file.fs.rm_file(file.path))
