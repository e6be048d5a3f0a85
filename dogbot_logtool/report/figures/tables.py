"""Tables whose columns are figures, read from the document of a log."""

from collections.abc import Mapping
from functools import cache
from typing import Any

from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.report.figures.document import DOCUMENT, STRIDE_ROWS
from dogbot_logtool.report.figures.figure import Column, Figure, Json, TableName, all_figures
from dogbot_logtool.report.numbers import NOTHING, decimal, percent


@dataclass(frozen=True, slots=True)
class FigureColumn:
    """A figure as a column of a table."""

    path: str
    """Path of the figure in the document; ``*`` stands for the name of a foot or topic."""
    figure: Figure[Any]
    column: Column


@cache
def columns_of(table: TableName) -> tuple[FigureColumn, ...]:
    """Return the columns of a table, in order."""
    found = [
        FigureColumn(path, figure, column)
        for scope in (DOCUMENT, STRIDE_ROWS)
        for path, figure in all_figures(scope)
        for column in figure.columns
        if column.table is table and "[]" not in path
    ]
    return tuple(sorted(found, key=lambda each: each.column.rank))


def headers(table: TableName) -> tuple[str, ...]:
    """Return the headings of a table's figures, each once."""
    return tuple(dict.fromkeys(each.column.header for each in columns_of(table)))


def cells_of(table: TableName, document: Json, name: str = "") -> list[str]:
    """Return the cells of a row, one for each of the `headers`.

    Of figures under the same heading the last that is known is shown: body weights where the mass
    is known, else newtons.

    Args:
        table: which table.
        document: the figures of a log.
        name: the foot or topic that the row is about.
    """
    cells = dict.fromkeys(headers(table), NOTHING)
    for each in columns_of(table):
        value = at(document, each.path, name)
        if value is not None:
            cells[each.column.header] = cell(each.column, value)
    return list(cells.values())


def at(document: Json, path: str, name: str = "") -> Any:  # noqa: ANN401 - JSON
    """Return the value at a path; None where it, or what should hold it, is null.

    Args:
        document: the figures of a log.
        path: keys, joined by dots; ``*`` stands for the name, ``[]`` for the first item.
        name: of a foot or topic.
    """
    value: Any = document
    for key in path.split("."):
        if value is None:
            return None
        value = value[name if key == "*" else key.removesuffix("[]")]
        if key.endswith("[]"):
            value = value[0] if value else None
    return value


def cell(column: Column, value: Any) -> str:  # noqa: ANN401 - JSON
    """Write a value, or a statistic of it, as a column shows it."""
    if isinstance(value, Mapping):
        value = value[column.statistic]
    if column.percent:
        return percent(value)
    if column.thousands:
        return f"{value:,}"
    if column.decimals is None:
        return str(value)
    if column.signed:
        return f"{round(value * column.scale, column.decimals) + 0.0:+.{column.decimals}f}"
    return decimal(value * column.scale, column.decimals)
