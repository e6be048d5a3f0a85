"""The tables of the page, in text; numbers of the same kind stand under one heading."""

from collections.abc import Iterable, Sequence
from typing import Final

import numpy as np

from dogbot_logtool.core.gait.foot_statistics import FootStatistics
from dogbot_logtool.core.geometry.arrays import Floats, Ints
from dogbot_logtool.core.geometry.order_statistics import distinct
from dogbot_logtool.core.quality.outliers import LEAST_SHARE, MOST_DEVIATIONS, Outliers, outliers
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.report.figures.figure import Json, TableName
from dogbot_logtool.report.figures.foot_source import FootSource
from dogbot_logtool.report.figures.tables import cells_of, columns_of, headers
from dogbot_logtool.report.numbers import decimal, percent
from dogbot_logtool.report.text.legs_text import work_words

MOST_STRIDES: Final = 200
"""Rows of the stride table."""


@dataclass(frozen=True, slots=True)
class Cell:
    """A number, and what is odd about it."""

    text: str
    mark: str = ""
    """``high`` or ``low`` for an outlier."""
    why: str = ""
    """The reference that it is compared with."""


@dataclass(frozen=True, slots=True)
class Table:
    """A table whose first column names the row."""

    columns: Sequence[str]
    rows: Sequence[Sequence[Cell]]
    caption: str
    foot_of_row: Sequence[int] = ()
    """Index of the foot that a row is about, for its colour; empty: none."""

    @property
    def lines(self) -> list[tuple[int | None, Sequence[Cell]]]:
        """The rows, each with its foot."""
        feet: Sequence[int | None] = self.foot_of_row or [None] * len(self.rows)
        return list(zip(feet, self.rows, strict=True))


def _cells(*texts: str) -> tuple[Cell, ...]:
    return tuple(Cell(text) for text in texts)


def stride_table(stats: Stats) -> Table:
    """Return the strides in the order of time; outliers against the foot's own segment."""
    rows: list[tuple[float, int, tuple[Cell, ...]]] = []
    for foot, figures in enumerate(stats.feet):
        rows.extend(_stride_rows(stats, foot, figures))
    rows.sort(key=lambda row: row[:2])
    marked = [row for row in rows if any(cell.mark for cell in row[2])]
    shown = rows if len(rows) <= MOST_STRIDES else marked[:MOST_STRIDES]
    return Table(
        ("foot", "from s", *headers(TableName.PAGE_STRIDES)),
        [cells for _, _, cells in shown],
        _stride_caption(len(rows), len(marked), len(shown)),
        [foot for _, foot, _ in shown],
    )


def _stride_caption(every: int, marked: int, shown: int) -> str:
    if not every:
        return "No foot makes a whole stride."
    words = f"{every} whole strides, {marked} with an outlier"
    if shown < every:
        of = "these" if shown == marked else f"the first {shown} of these"
        words += f"; {of} are listed, export has them all"
    return (
        f"{words}. Marked (▲ high, ▼ low): modified z-score above {MOST_DEVIATIONS} (Iglewicz and "
        f"Hoaglin 1993) and more than {LEAST_SHARE:.0%} off the median of the foot's strides in "
        "the same segment."
    )


def _stride_rows(
    stats: Stats, foot: int, figures: FootStatistics
) -> list[tuple[float, int, tuple[Cell, ...]]]:
    strides = figures.strides
    source = FootSource(stats, foot, figures)
    segment = _segment_of(stats, strides.touchdown + (strides.end - strides.touchdown) // 2)
    cells = [
        _column(each.figure.of(source) * each.column.scale, each.column.decimals or 0, segment)
        for each in columns_of(TableName.PAGE_STRIDES)
    ]
    begin = stats.seconds(strides.touchdown)
    return [
        (start, foot, (*_cells(figures.name, decimal(start, 3)), *row))
        for start, row in zip(begin, zip(*cells, strict=True), strict=True)
    ]


def _segment_of(stats: Stats, time: Ints) -> Ints:
    """(n,) number of the segment that each time lies in; -1 for none."""
    number = np.full(len(time), -1)
    for each, segment in enumerate(stats.segments):
        number[(time >= segment.start) & (time < segment.end)] = each
    return number


def _column(values: Floats, decimals: int, segment: Ints) -> list[Cell]:
    cells = [Cell(decimal(None if np.isnan(each) else each, decimals)) for each in values.tolist()]
    for number in distinct(segment[segment >= 0]).tolist():
        rows = np.flatnonzero(segment == number)
        found: Outliers = outliers(values[rows], 10.0**-decimals)
        why = f"the median is {decimal(found.median, decimals)}"
        for flags, mark in ((found.high, "high"), (found.low, "low")):
            for row in rows[flags].tolist():
                cells[row] = Cell(cells[row].text, mark, why)
    return cells


def load_table(document: Json) -> Table:
    """Return the loads of each foot."""
    of = {"vertical_impulse": "vertical impulse", "force_impulse": "impulse of |F|"}
    share_of = of.get(document["forces"]["load_share_of"], "load")
    return _foot_table(
        TableName.PAGE_LOADS,
        document,
        f"Medians over whole stances; share of the {share_of}; highest: over all of them.",
    )


def step_table(document: Json) -> Table:
    """Return the steps of each foot."""
    return _foot_table(
        TableName.STEPS,
        document,
        "Medians over whole strides; phase in cycles, and its consistency R, in the longest "
        "segment.",
    )


def _foot_table(table: TableName, document: Json, caption: str) -> Table:
    feet = document["feet"]
    return _figures(table, document, "foot", feet, caption, range(len(feet)))


def _figures(
    table: TableName,
    document: Json,
    of: str,
    names: Iterable[str],
    caption: str,
    feet: Sequence[int] = (),
) -> Table:
    """Return the figures of feet, joints or topics, a row each."""
    rows = [_cells(name, *cells_of(table, document, name)) for name in names]
    return Table((of, *headers(table)), rows, caption, feet)


def symmetry_table(document: Json) -> Table | None:
    """Return right against left, and how the load is shared; None without the four corners."""
    indices = document["forces"]["symmetry_index_percent"]
    if indices is None:
        return None
    words = "Right over left, percent of their mean (Robinson, Herzog and Nigg 1987): 0 is even."
    shares = document["forces"]["load_share"]
    if shares is not None:
        parts = [f"{name} {percent(shares[name])}" for name in shares if name != "feet"]
        words += f" Load: {', '.join(parts)}."
    return _figures(TableName.SYMMETRY, document, "pair", indices, words)


def leg_table(document: Json) -> Table | None:
    """Return the swings of each foot; None where the log tells of no leg."""
    legs = document["legs"]
    if legs is None or not any(leg["frame"] for leg in legs["feet"].values()):
        return None
    words = (
        "Medians over whole strides. Clearance above the line between footfalls, and how far the "
        "foot's frame moves in the middle of a stance (at rest), in mm; velocity at touchdown."
    )
    feet = legs["feet"]
    return _figures(TableName.LEGS, document, "foot", feet, words, range(len(feet)))


def joint_table(document: Json) -> Table | None:
    """Return the joints; None where the log tells of none."""
    legs = document["legs"]
    if legs is None or not legs["joints"]:
        return None
    names = list(legs["feet"])
    feet = [joint["foot"] for joint in legs["joints"].values()]
    words = "rad and N m (m and N of those that slide) in the whole log."
    for name, value in work_words(document):
        words += f" {name.capitalize()}: {value}."
    coloured = [names.index(foot) for foot in feet] if all(feet) else ()
    return _figures(TableName.JOINTS, document, "joint", legs["joints"], words, coloured)


def topic_table(document: Json) -> Table:
    """Return the timing of each topic."""
    return _figures(
        TableName.TOPICS,
        document,
        "topic",
        document["quality"]["topics"],
        f"{document['log']['messages']:,} messages. Gap: over 5 usual intervals and 50 ms.",
    )
