"""The tables of the dataset and their columns, most of them from the records of metrics."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from enum import Enum
from functools import cache
from typing import Any, Final

from dogbot_logtool.core.geometry.aggregates import Aggregate
from dogbot_logtool.core.metrics import Event, Foot, Stride, WalkMetrics
from dogbot_logtool.core.records import Field, definitions, fields_of, metric_paths
from dogbot_logtool.dataclass import dataclass

SCHEMA_VERSION: Final = 5
"""Grows with every change of the columns or their meaning, and of the layout of the files."""
PARTITIONS: Final[Mapping[str, str]] = {
    "robot": "name of the robot; `unknown` for a log that could not be measured",
    "month": "year and month of the log's start; `unknown` where its clock is not the calendar's",
}
"""Columns that the names of directories hold."""


class Type(Enum):
    """Type of a column, by its name in Arrow."""

    TEXT = "string"
    INTEGER = "int64"
    NUMBER = "float64"
    FLAG = "bool"
    TIME = "timestamp[us, tz=UTC]"
    NUMBERS = "list<float64>"


@dataclass(frozen=True, slots=True)
class TableColumn:
    """A column of a table."""

    name: str
    type: Type
    definition: str
    unit: str = ""
    """Empty: none."""
    null: str = ""
    """When it is not known; empty: it always is."""


@dataclass(frozen=True, slots=True)
class MetricColumn:
    """A column, and where its metric stands in JSON."""

    column: TableColumn
    path: str
    """Keys, joined by dots; the last may be one of an aggregate."""


_TYPES: Final = {str: Type.TEXT, int: Type.INTEGER, float: Type.NUMBER, bool: Type.FLAG}
_PRESENT: Final = ("schema_version", "log.path")
"""Metrics of a log that other columns have."""
_FAILED: Final = "the log could not be measured"
_LOG: Final = (
    TableColumn("log", Type.TEXT, "path of the log from the root, or URL without query"),
    TableColumn(
        "log_id", Type.TEXT, "joins the tables; changes with the log, the settings and the version"
    ),
)
_LEG: Final = (
    TableColumn("foot", Type.TEXT, "name of the foot"),
    TableColumn(
        "place_end",
        Type.TEXT,
        "where the leg is: front, middle or back",
        null="the robot's file does not say",
    ),
    TableColumn(
        "place_side",
        Type.TEXT,
        "where the leg is: left, right or centre",
        null="the robot's file does not say",
    ),
)
_STATE: Final = (
    TableColumn("log_key", Type.TEXT, "stays the same when the log or the settings change"),
    TableColumn(
        "error", Type.TEXT, "why the log could not be measured", null="the log was measured"
    ),
    TableColumn(
        "start_time",
        Type.TIME,
        "when the log begins",
        null=f"{_FAILED}; its clock is not the calendar's, as in a simulation",
    ),
    TableColumn("damaged", Type.FLAG, "whether a part of it could not be read", null=_FAILED),
)
_ORIGIN: Final = (
    TableColumn("warnings", Type.INTEGER, "findings that are no mere notes", null=_FAILED),
    TableColumn("metrics_json", Type.TEXT, "all of `stats --json -v`", null=_FAILED),
    TableColumn("log_size_bytes", Type.INTEGER, "size of the log", unit="bytes"),
    TableColumn("log_version", Type.TEXT, "time of its last change, or the store's tag of it"),
    TableColumn("settings_sha256", Type.TEXT, "hash of all options, and of this program's version"),
)
_FOOT_NAMES: Final = {"vertical_impulse_ns": "foot_vertical_impulse_ns"}
"""Metrics of a foot that would have the name of something else in another table."""


@cache
def log_columns() -> tuple[MetricColumn, ...]:
    """Return the columns of the metrics of a log: all but those of its feet, joints and topics."""
    return tuple(_columns(WalkMetrics, {}))


@cache
def foot_columns() -> tuple[MetricColumn, ...]:
    """Return the columns of the metrics of a foot."""
    return tuple(_columns(Foot, _FOOT_NAMES))


def _columns(record: type, names: Mapping[str, str]) -> Iterator[MetricColumn]:
    for path, field, words in metric_paths(record):
        if "*" in path or "[]" in path or field.kind not in {"scalar", "aggregate"}:
            continue
        if path in _PRESENT:
            continue
        name = names.get(path, path.replace(".", "_"))
        if field.kind == "scalar":
            yield MetricColumn(_column(name, field, words), path)
            continue
        for statistic in fields_of(Aggregate):
            unit = "" if statistic.name == "n" else field.of.unit
            column = TableColumn(
                f"{name}_{statistic.name}",
                _TYPES[statistic.inner],
                f"{words} ({statistic.name})",
                unit,
                _lacks(field),
            )
            yield MetricColumn(column, f"{path}.{statistic.name}")


def _column(name: str, field: Field, words: str) -> TableColumn:
    return TableColumn(name, _TYPES[field.inner], words, field.of.unit, _lacks(field))


def _lacks(field: Field) -> str:
    """Say without what a metric is null."""
    if field.of.needs:
        return f"not known: {', '.join(field.of.needs)}"
    return "not known" if field.nullable else ""


def _of_record(record: Any) -> Iterator[TableColumn]:  # noqa: ANN401 - any record
    words = definitions(record)
    for field in fields_of(record):
        yield _column(field.name, field, words[field.name])


@cache
def tables() -> Mapping[str, Sequence[TableColumn]]:
    """Return the columns of each table, without `PARTITIONS` and labels.

    A name means the same in all tables. They are in the order in which they are written.
    """
    logs = (replace(each.column, null=each.column.null or _FAILED) for each in log_columns())
    return {
        "strides": (*_LOG, *_LEG, *_of_record(Stride)),
        "events": (*_LOG, *(_LEG[0] if e.name == "foot" else e for e in _of_record(Event))),
        "feet": (*_LOG, *_LEG, *(each.column for each in foot_columns())),
        "logs": (*_LOG, *_STATE, *logs, *_ORIGIN),
    }
