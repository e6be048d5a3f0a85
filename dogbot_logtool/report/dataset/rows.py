"""The rows of one log, as plain values: made where the log is measured, sent to who writes them."""

from collections.abc import Mapping, Sequence
from datetime import datetime
from typing import Any, Final
from urllib.parse import quote

from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.io.plain_json import to_json
from dogbot_logtool.report.dataset.schema import foot_columns, log_columns
from dogbot_logtool.report.numbers import date_of
from dogbot_logtool.results import Figures

Json = dict[str, Any]
_NOT_KNOWN: Final = "unknown"

Columns = Mapping[str, Sequence[Any]]
"""Values by column, as many of each."""


@dataclass(frozen=True, slots=True)
class LogRows:
    """The rows of a log, without what is the same in all of them."""

    partition: str
    """Directories below that of the table, such as ``robot=dogbot/month=2026-11``."""
    log: Json
    """Its row of `logs`, without what is known before it is measured."""
    others: Mapping[str, Columns]
    """Its rows of the other tables."""

    @property
    def count(self) -> int:
        """Rows of the other tables."""
        return sum(len(next(iter(each.values()), ())) for each in self.others.values())


def log_rows(figures: Figures) -> LogRows:
    """Return the rows of a log that was measured."""
    document = figures.json
    start_s = document["log"]["start_s"]
    start_time = None if start_s is None else date_of(start_s)
    row = {
        "error": None,
        "start_time": start_time,
        "damaged": bool(figures.damage.losses),
        **{each.column.name: _at(document, each.path) for each in log_columns()},
        "warnings": sum(each["severity"] != "note" for each in document["findings"]),
        "metrics_json": to_json(document),
    }
    others = {
        "strides": _stride_columns(figures),
        "events": _transposed(document["events"]),
        "feet": _transposed(_foot_rows(document)),
    }
    return LogRows(_partition(figures.robot, start_time), row, others)


def failed_rows(sentence: str) -> LogRows:
    """Return the row of a log that could not be measured."""
    return LogRows(_partition(_NOT_KNOWN, None), {"error": sentence}, {})


def _partition(robot: str, date: datetime | None) -> str:
    month = f"{date:%Y-%m}" if date else _NOT_KNOWN
    return f"robot={quote(robot, safe='')}/month={month}"


def _stride_columns(figures: Figures) -> Columns:
    strides = figures.strides
    settings = figures.json["settings"]["feet"]
    legs = {name: _leg(name, settings[name]) for name in figures.json["feet"]}
    columns = {name: column.tolist() for name, column in strides.columns.items()}
    return {**_transposed([legs[foot] for foot in strides.foot]), **columns}


def _leg(name: str, foot: Json) -> Json:
    """Return which leg a foot is of, from its settings."""
    end, side = foot["leg_position"] or (None, None)
    return {"foot": name, "place_end": end, "place_side": side}


def _foot_rows(document: Json) -> list[Json]:
    settings = document["settings"]["feet"]
    return [
        _leg(name, settings[name])
        | {each.column.name: _at(foot, each.path) for each in foot_columns()}
        for name, foot in document["feet"].items()
    ]


def _at(document: Json, path: str) -> Any:  # noqa: ANN401 - JSON
    """Return the value at a path; None where what should hold it is null."""
    value: Any = document
    for key in path.split("."):
        value = None if value is None else value[key]
    return value


def _transposed(rows: Sequence[Json]) -> Columns:
    """Return rows of the same keys as columns."""
    return {name: [row[name] for row in rows] for name in rows[0]} if rows else {}
