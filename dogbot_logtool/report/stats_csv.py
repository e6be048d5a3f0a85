"""One row a stride, for spreadsheets; one row a log, where there are several."""

import csv
from collections.abc import Iterable, Sequence
from typing import Final, TextIO

import numpy as np

from dogbot_logtool.core.remarks import remarks
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.io.printable import printable
from dogbot_logtool.report.stride_table import COLUMNS
from dogbot_logtool.results import LogFacts, StrideTable

STRIDE_COLUMNS: Final = ("log", "foot", *COLUMNS)
SUMMARY_COLUMNS: Final = (
    "log",
    "class",
    "sequence",
    "duty_factor",
    "stride_frequency_hz",
    "forward_speed_mps",
    "vertical_impulse_over_weight",
    "segments",
    "warnings",
)
_FORMULA: Final = ("=", "+", "-", "@", "\t", "\r")
_DIGITS: Final = 9
"""Significant digits; stamps are nanoseconds, forces are not that good."""


def write_strides(file: TextIO, results: Iterable[tuple[str, StrideTable]]) -> None:
    """Write a row for each stride, given logs' names and strides; what is not known is empty."""
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(STRIDE_COLUMNS)
    for path, strides in results:
        columns = [strides.columns[name].tolist() for name in COLUMNS]
        for foot, *figures in zip(strides.foot, *columns, strict=True):
            writer.writerow([_word(path), _word(foot), *map(_text, figures)])


def write_summary(file: TextIO, results: Sequence[tuple[Stats, LogFacts]]) -> None:
    """Write a row for each log."""
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(SUMMARY_COLUMNS)
    for stats, log in results:
        writer.writerow(_summary_row(stats, log))


def _summary_row(stats: Stats, log: LogFacts) -> list[str]:
    main = stats.main
    said = (*remarks(stats), *log.findings)
    return [
        _word(log.path),
        (main.gait.name or "") if main else "",
        (main.gait.sequence or "") if main else "",
        _text(main.duty_factor if main else None),
        _text(main.stride_frequency_hz if main else None),
        _text(stats.base.forward_speed_mps if stats.base else None),
        _text(stats.loads.vertical_impulse_over_weight),
        str(len(stats.segments)),
        str(sum(not each.code.startswith("N_") for each in said)),
    ]


def _word(text: str) -> str:
    """Return the text of a cell, with an apostrophe before what spreadsheets take for a formula."""
    safe = printable(text)
    return f"'{safe}" if text.startswith(_FORMULA) else safe


def _text(figure: float | None) -> str:
    return "" if figure is None or not np.isfinite(figure) else f"{figure:.{_DIGITS}g}"
