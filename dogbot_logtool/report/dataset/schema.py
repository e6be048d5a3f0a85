"""The tables of the dataset and their columns, most of them from the table of figures."""

from collections.abc import Iterator, Mapping, Sequence
from enum import Enum
from functools import cache
from typing import Any, Final

from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.report.figures.document import DOCUMENT, STRIDE_FIGURES
from dogbot_logtool.report.figures.events import EVENTS
from dogbot_logtool.report.figures.figure import (
    BY_NAME,
    STATISTICS,
    Figure,
    Kind,
    TableName,
    all_figures,
)
from dogbot_logtool.report.figures.tables import columns_of

SCHEMA_VERSION: Final = 4
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
class FootColumn:
    """A column of the table of feet, and where its figure stands in the JSON of a foot."""

    column: TableColumn
    path: str
    """Keys, joined by dots; the last may be one of an aggregate."""


_TYPES: Final = {
    Kind.TEXT: Type.TEXT,
    Kind.COUNT: Type.INTEGER,
    Kind.INTEGER: Type.INTEGER,
    Kind.FLAG: Type.FLAG,
    Kind.NUMBERS: Type.NUMBERS,
}
"""Types of columns; those of all other figures are numbers."""
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
    TableColumn("figures_json", Type.TEXT, "all of `stats --json`", null=_FAILED),
    TableColumn("log_size_bytes", Type.INTEGER, "size of the log", unit="bytes"),
    TableColumn("log_version", Type.TEXT, "time of its last change, or the store's tag of it"),
    TableColumn("settings_sha256", Type.TEXT, "hash of all options, and of this program's version"),
)
_FOOT_NAMES: Final = {
    "messages": "foot_messages",
    "vertical_impulse_ns": "foot_vertical_impulse_ns",
}
"""Figures of a foot that would have the name of something else in another table."""
_IN_EVENTS: Final = ("touchdown_s", "liftoff_s")
_AS_LEG: Final = ("place",)


def _of_figure(name: str, figure: Figure[Any], null: str = "") -> TableColumn:
    causes = "; ".join(filter(None, (null, figure.null)))
    kind = _TYPES.get(figure.kind, Type.NUMBER)
    return TableColumn(name, kind, figure.definition, figure.unit, causes)


@cache
def foot_columns() -> tuple[FootColumn, ...]:
    """Return the columns of the figures of a foot."""
    return tuple(_foot_columns())


def _foot_columns() -> Iterator[FootColumn]:
    for path, figure in all_figures(DOCUMENT):
        if not path.startswith("feet.*."):
            continue
        below = path.removeprefix("feet.*.")
        keys = below.split(".")
        if keys[0] in (*_IN_EVENTS, *_AS_LEG) or figure.kind in BY_NAME:
            continue
        name = _FOOT_NAMES.get(keys[0], "_".join(keys))
        if figure.kind is not Kind.AGGREGATE:
            yield FootColumn(_of_figure(name, figure), below)
            continue
        for statistic, words in STATISTICS.items():
            kind, unit = (Type.INTEGER, "") if statistic == "n" else (Type.NUMBER, figure.unit)
            of = f"{figure.definition}: {words}"
            column = TableColumn(f"{name}_{statistic}", kind, of, unit, figure.null)
            yield FootColumn(column, f"{below}.{statistic}")


@cache
def tables() -> Mapping[str, Sequence[TableColumn]]:
    """Return the columns of each table, without `PARTITIONS` and labels.

    A name means the same in all tables. They are in the order in which they are written.
    """
    strides = (_of_figure(figure.key, figure) for figure in STRIDE_FIGURES)
    events = (_of_figure(figure.key, figure) for figure in EVENTS)
    logs = (
        _of_figure(each.column.header, each.figure, _FAILED)
        for each in columns_of(TableName.LOG_ROWS)
    )
    return {
        "strides": (*_LOG, *_LEG, *strides),
        "events": (*_LOG, *events),
        "feet": (*_LOG, *_LEG, *(each.column for each in foot_columns())),
        "logs": (*_LOG, *_STATE, *logs, *_ORIGIN),
    }
