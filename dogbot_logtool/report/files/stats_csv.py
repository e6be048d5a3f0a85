"""One row a stride, or an event, for spreadsheets."""

import csv
from collections.abc import Iterable
from typing import Final, TextIO

import numpy as np

from dogbot_logtool.io.printable import printable
from dogbot_logtool.report.figures.document import STRIDE_FIGURES
from dogbot_logtool.report.figures.events import EVENT_COLUMNS
from dogbot_logtool.report.figures.figure import Json
from dogbot_logtool.results import StrideTable

_FORMULA: Final = ("=", "+", "-", "@", "\t", "\r")


def write_strides(file: TextIO, results: Iterable[tuple[str, StrideTable]]) -> None:
    """Write a row for each stride, given logs' names and strides; what is not known is empty."""
    figures = [figure.key for figure in STRIDE_FIGURES]
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(["log", "foot", *figures])
    for path, strides in results:
        columns = [strides.columns[name].tolist() for name in figures]
        for foot, *values in zip(strides.foot, *columns, strict=True):
            writer.writerow([text_cell(path), text_cell(foot), *map(_text, values)])


def write_events(file: TextIO, events: Iterable[Json]) -> None:
    """Write a row for each event of a log's JSON; what is not known is empty."""
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(EVENT_COLUMNS)
    writer.writerows(map(event_cells, events))


def event_cells(event: Json) -> list[str]:
    """Return the cells of an event of a log's JSON; what is not known is empty."""
    cells = (event[name] for name in EVENT_COLUMNS)
    return [text_cell(each) if isinstance(each, str) else _text(each) for each in cells]


def text_cell(text: str) -> str:
    """Return the text of a cell, with an apostrophe before what spreadsheets take for a formula."""
    safe = printable(text)
    return f"'{safe}" if text.startswith(_FORMULA) else safe


def _text(figure: float | None) -> str:
    """Return a number with all its digits: read again, it is the same to the bit."""
    return "" if figure is None or not np.isfinite(figure) else repr(float(figure))
