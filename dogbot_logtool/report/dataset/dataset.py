"""A dataset: which logs are to be measured for it, and how their rows are added."""

import hashlib
import json
import os
import re
import time
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, Self

from dogbot_logtool import __version__
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.errors import DAMAGED, CallError, LogtoolError
from dogbot_logtool.io import storage
from dogbot_logtool.io.storage import Location
from dogbot_logtool.report.dataset.files import Files
from dogbot_logtool.report.dataset.labels import Labels
from dogbot_logtool.report.dataset.parts import NewLog, StoredLog
from dogbot_logtool.report.dataset.rows import LogRows
from dogbot_logtool.report.dataset.schema import SCHEMA_VERSION
from dogbot_logtool.run.inputs import Found, LogSet

if TYPE_CHECKING:
    from dogbot_logtool.pipeline.options import StatsOptions

_ASKED_AT_ONCE: Final = 16
_WRITTEN_AFTER_S: Final = 60.0
"""Rows are written at the latest when another log is done after this time."""
_MOST_WAITING: Final = 1000
"""Logs whose rows wait to be written; they bound the memory."""
_MOST_WAITING_ROWS: Final = 1_000_000

_ESCAPED: Final = re.compile(rb"\\x([89a-f][0-9a-f])")
"""How a byte of a name that is not UTF-8 is shown."""


@dataclass(frozen=True, slots=True)
class LogState:
    """A log as it is now."""

    name: str
    """Its whole path, or URL without query; as it may be shown."""
    key: str
    """Names it; two logs never have the same."""
    log_id: str
    """Changes with the log and the settings."""
    size: int
    """Bytes."""
    version: str
    """Time of its last change, or the store's own tag; empty if unknown, or if there is no such
    log."""
    settings_sha256: str

    @property
    def columns(self) -> dict[str, Any]:
        """Its columns of `logs`."""
        return {
            "log": self.name,
            "log_id": self.log_id,
            "log_key": self.key,
            "log_size_bytes": self.size,
            "log_version": self.version,
            "settings_sha256": self.settings_sha256,
        }


def state_of(location: Location, settings_sha256: str) -> LogState:
    """Look at a log.

    Args:
        location: of the log.
        settings_sha256: hash of all that its figures depend on beside it.
    """
    try:
        size, version = storage.version(location)
    except (LogtoolError, OSError):
        # Opening it reports what is wrong.
        size, version = 0, ""
    identity = os.fsencode(storage.identity(location))
    text = "\n".join((str(size), version, settings_sha256)).encode()
    return LogState(
        name=storage.shown(storage.from_root(location)),
        key=key_of(location),
        log_id=hashlib.sha256(identity + b"\n" + text).hexdigest()[:32],
        size=size,
        version=version,
        settings_sha256=settings_sha256,
    )


def key_of(location: Location) -> str:
    """Return what names a log in the dataset: a hash of its real path or its whole URL."""
    return hashlib.sha256(os.fsencode(storage.identity(location))).hexdigest()[:24]


@dataclass(frozen=True, slots=True)
class Entry:
    """A log that is to be measured and written."""

    location: Location
    state: LogState
    labels: Labels


@dataclass(frozen=True, slots=True)
class Pending:
    """The work that a run has to do."""

    entries: tuple[Entry, ...]
    log_set: LogSet
    """Logs of the entries, likewise."""
    unchanged: tuple[tuple[str, int], ...]
    """Names and exit codes of logs whose figures are there already."""
    pruned: tuple[str, ...]
    """Names of logs that were removed from the dataset."""


@dataclass(frozen=True, slots=True)
class Dataset:
    """A directory or a URL with the tables."""

    root: Location
    settings: str
    """All options that figures depend on, as JSON."""
    labels: Labels
    """Labels that all logs of the call get."""

    @property
    def settings_sha256(self) -> str:
        """A hash of the settings; another version of this program counts as another setting."""
        text = f"{SCHEMA_VERSION} {__version__} {self.settings}"
        return hashlib.sha256(text.encode()).hexdigest()

    def begin(self, log_set: LogSet, *, prune: bool = False) -> Pending:
        """Look which logs are not there, or not as they are now; remove those that are gone.

        Raises:
            StoreError: a store fails.
            LogtoolError: the dataset cannot be read or written.
        """
        with ThreadPoolExecutor(_ASKED_AT_ONCE) as pool:
            states = list(pool.map(lambda log: state_of(log, self.settings_sha256), log_set.paths))
        files = Files(self.root)
        contents = files.contents()
        stored = contents.by_key()
        entries: list[Entry] = []
        logs: list[Found] = []
        unchanged: list[tuple[str, int]] = []
        relabelled: dict[str, Labels] = {}
        for log, state in zip(log_set.logs, states, strict=True):
            old = stored.get(state.key)
            labels = _labelled(old, self.labels)
            if old is not None and _is_unchanged(old, state):
                unchanged.append((storage.shown(log.path), DAMAGED if old.damaged else 0))
                if labels != old.labels:
                    relabelled[state.key] = labels
            else:
                entries.append(Entry(log.path, state, labels))
                logs.append(log)
        named = {state.key for state in states}
        others = [log for key, log in stored.items() if key not in named]
        gone = gone_logs(others) if prune else []
        if relabelled or gone or not contents.is_sound:
            from dogbot_logtool.report.dataset.changing import change  # noqa: PLC0415 - slow

            with files.locked():
                change(files, labels=relabelled, dropped=[log.key for log in gone])
        rest = replace(log_set, logs=tuple(logs))
        pruned = tuple(log.name for log in gone)
        return Pending(tuple(entries), rest, tuple(unchanged), pruned)

    def writer(self) -> "DatasetWriter":
        """Return what writes the rows of logs."""
        return DatasetWriter(self)


class DatasetWriter:
    """Gathers the rows of logs and writes them, many logs at a time.

    What was gathered is written when the block ends, also by an interruption.
    """

    def __init__(self, dataset: Dataset) -> None:
        self._files = Files(dataset.root)
        self._waiting: list[NewLog] = []
        self._rows = 0
        self._written = time.monotonic()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_error: object) -> None:
        self.write()

    def add(self, entry: Entry, rows: LogRows) -> None:
        """Take the rows of a log.

        Raises:
            LogtoolError: rows cannot be written.
        """
        state = entry.state
        row = {**rows.log, **state.columns}
        self._waiting.append(NewLog(state.key, state.name, state.log_id, rows, row, entry.labels))
        self._rows += rows.count
        if (
            len(self._waiting) >= _MOST_WAITING
            or self._rows >= _MOST_WAITING_ROWS
            or time.monotonic() - self._written > _WRITTEN_AFTER_S
        ):
            self.write()

    def write(self) -> None:
        """Write what was gathered.

        Raises:
            LogtoolError: it cannot be written.
        """
        waiting, self._waiting, self._rows = self._waiting, [], 0
        if waiting:
            from dogbot_logtool.report.dataset.changing import change  # noqa: PLC0415 - slow

            with self._files.locked():
                change(self._files, waiting)
        self._written = time.monotonic()


def dataset_at(location: Location, options: "StatsOptions", labels: Labels) -> Dataset:
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
    return Dataset(location, json.dumps(settings, sort_keys=True, default=repr), labels)


def _refuse_bad_root(path: Path) -> None:
    name = storage.shown(path)
    if name != str(path):
        raise CallError(f"--dataset {name}: its name must be UTF-8, which all readers of it need")
    if path.exists() and not path.is_dir():
        raise CallError(f"--dataset {name}: is no directory")


def _labelled(old: StoredLog | None, given: Labels) -> Labels:
    """Return the labels of a log: those that it has, and those that are given."""
    labels = {**(old.labels if old else {}), **given}
    return {name: labels[name] for name in sorted(labels) if labels[name] is not None}


def _is_unchanged(old: StoredLog, state: LogState) -> bool:
    """Tell whether figures of a log as it is now are there; one that failed is tried again."""
    return old.error is None and old.log_id == state.log_id and bool(state.version)


def gone_logs(logs: Sequence[StoredLog]) -> list[StoredLog]:
    """Return the logs that are gone for certain; one that cannot be looked for is kept.

    Raises:
        StoreError: a store fails.
    """
    with ThreadPoolExecutor(_ASKED_AT_ONCE) as pool:
        return [log for log, gone in zip(logs, pool.map(_is_gone, logs), strict=True) if gone]


def _is_gone(log: StoredLog) -> bool:
    try:
        location = storage.location(log.name)
    except LogtoolError:
        return False
    if isinstance(location, Path):
        names = os.fsencode(log.name), _ESCAPED.sub(_byte, os.fsencode(log.name))
        return not any(map(_may_be_there, names))
    if key_of(location) != log.key:
        return False  # a part of the URL is not kept, since it may hold secrets
    try:
        return not storage.asked(location, lambda: location.fs.exists(location.path))
    except CallError:
        return False


def _byte(escaped: re.Match[bytes]) -> bytes:
    return bytes.fromhex(escaped[1].decode())


def _may_be_there(name: bytes) -> bool:
    try:
        os.stat(name)  # noqa: PTH116 - a name of any bytes
    except (FileNotFoundError, NotADirectoryError):
        return False
    except (OSError, ValueError):
        return True
    return True
