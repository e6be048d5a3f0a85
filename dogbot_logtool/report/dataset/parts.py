"""Which logs a dataset holds in which part, and what a change of them means for each part."""

from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import count
from typing import Any, Final

from dogbot_logtool.report.dataset.labels import Labels
from dogbot_logtool.report.dataset.rows import LogRows

MOST_LOGS: Final = 1000
"""A part with as many logs takes no more."""
MOST_ROWS: Final = 2_000_000
"""Likewise, rows of the tables beside `logs`."""


@dataclass(frozen=True, slots=True, order=True)
class Part:
    """The files of some logs' rows, one of each table."""

    partition: str
    """Directories below that of the table, such as ``robot=dogbot/month=2026-11``."""
    number: int

    @property
    def file(self) -> str:
        """Its name below the directory of a table."""
        return f"{self.partition}/part-{self.number:04}.parquet"


@dataclass(frozen=True, slots=True)
class StoredLog:
    """A log of the dataset."""

    part: Part
    key: str
    """Names the log; two logs never have the same."""
    name: str
    """Its whole path, or URL without query; as it may be shown."""
    log_id: str
    """Changes with the log and the settings."""
    damaged: bool | None
    error: str | None
    """Why it could not be measured; None: it could."""
    labels: Labels


@dataclass(frozen=True, slots=True)
class NewLog:
    """A log that is to be written, or to replace what is there of it."""

    key: str
    name: str
    log_id: str
    rows: LogRows
    row: Mapping[str, Any]
    """Its whole row of `logs`, without labels."""
    labels: Labels


@dataclass(frozen=True, slots=True)
class Contents:
    """Contents of a dataset."""

    logs: tuple[StoredLog, ...] = ()
    """In the order of parts."""
    rows: Mapping[Part, int] = field(default_factory=dict)
    """Rows beside `logs` of each part."""
    label_names: Mapping[Part, frozenset[str]] = field(default_factory=dict)
    """Labels that a part has columns of."""
    strays: tuple[tuple[str, Part], ...] = ()
    """Tables, and parts of them without rows in `logs`: a run was killed while it wrote them."""

    def by_key(self) -> dict[str, StoredLog]:
        """Return the logs by key; of one that is there twice, as after a kill, the last."""
        return {log.key: log for log in self.logs}

    @property
    def is_sound(self) -> bool:
        """Whether no run was killed while it wrote."""
        return not self.strays and len(self.by_key()) == len(self.logs)


@dataclass(slots=True)
class Change:
    """New content of a part."""

    kept: dict[str, StoredLog] = field(default_factory=dict)
    """By key."""
    new: dict[str, NewLog] = field(default_factory=dict)
    changes_rows: bool = False
    """Not only labels change."""


def planned_changes(
    contents: Contents,
    new: Sequence[NewLog] = (),
    labels: Mapping[str, Labels] | None = None,
    dropped: Iterable[str] = (),
) -> list[tuple[Part, Change]]:
    """Return the parts that change, those that get logs first.

    A new log takes the part where it is already, else the first of its partition with room: what
    the parts hold depends on the order of the logs, not on how many are written at a time.

    Args:
        contents: of the dataset.
        new: logs that are written.
        labels: all labels of logs whose labels change, by key.
        dropped: keys of logs that go.
    """
    plan = _Plan(contents)
    for key in dropped:
        plan.drop(key)
    for key, log in contents.by_key().items():
        plan.drop(key, but=log.part)
    for each in new:
        plan.put(each)
    plan.relabel(labels or {})
    changed = sorted(plan.changed.items())
    return sorted(changed, key=lambda each: not each[1].new)


class _Plan:
    """The parts as they are to be."""

    def __init__(self, contents: Contents) -> None:
        self.changed: dict[Part, Change] = {}
        self._parts: defaultdict[Part, Change] = defaultdict(Change)
        self._parts_of: defaultdict[str, set[Part]] = defaultdict(set)
        self._rows = Counter(contents.rows)
        self._label_names = contents.label_names
        for log in contents.logs:
            self._parts[log.part].kept[log.key] = log
            self._parts_of[log.key].add(log.part)

    def drop(self, key: str, but: Part | None = None) -> None:
        """Take a log out of all parts but one."""
        for part in self._parts_of[key] - {but}:
            self._parts_of[key].remove(part)
            change = self._touch(part)
            change.kept.pop(key, None)
            change.new.pop(key, None)

    def put(self, log: NewLog) -> None:
        """Add a log, or replace it."""
        partition = log.rows.partition
        own = (part for part in self._parts_of[log.key] if part.partition == partition)
        part = next(own, None) or self._with_room(partition)
        self.drop(log.key, but=part)
        change = self._touch(part)
        change.kept.pop(log.key, None)
        change.new[log.key] = log
        self._parts_of[log.key].add(part)
        self._rows[part] += log.rows.count

    def relabel(self, labels: Mapping[str, Labels]) -> None:
        """Change labels of logs that are there, and give all parts columns of the same labels."""
        for key, given in labels.items():
            for part in self._parts_of[key]:
                kept = self._parts[part].kept
                if key in kept:
                    kept[key] = replace(kept[key], labels=given)
                    self.changed[part] = self._parts[part]
        new = (log.labels for change in self._parts.values() for log in change.new.values())
        names = set().union(*self._label_names.values(), *labels.values(), *new)
        for part in list(self._label_names):
            if self._label_names[part] != names:
                self.changed[part] = self._parts[part]

    def _touch(self, part: Part) -> Change:
        change = self.changed[part] = self._parts[part]
        change.changes_rows = True
        return change

    def _with_room(self, partition: str) -> Part:
        """Return the first part of a partition with room; it may be one that is yet to be."""
        for number in count():
            part = Part(partition, number)
            held = self._parts[part]
            logs = len(held.kept) + len(held.new)
            if logs < MOST_LOGS and (self._rows[part] < MOST_ROWS or not logs):
                return part
        raise AssertionError
