"""The tables of the page, in text; numbers of the same kind stand under one heading."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final, TypeVar

import numpy as np

from dogbot_logtool.core.arrays import Floats, Ints, distinct
from dogbot_logtool.core.gait.feet import FootSteps
from dogbot_logtool.core.loads import WalkLoads
from dogbot_logtool.core.metrics import Forces, Legs, WalkMetrics
from dogbot_logtool.core.quality.quality import LEAST_SHARE, MOST_DEVIATIONS, Outliers, outliers
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.report.numbers import decimal, percent
from dogbot_logtool.report.table_file import foot_strides
from dogbot_logtool.report.tables import (
    JOINTS,
    LEGS,
    PAGE_LOADS,
    STEPS,
    SYMMETRY,
    TOPICS,
    Column,
    FootRow,
    cells_of,
    grouped_load,
    headers,
)


def work_words(legs: Legs) -> Iterator[tuple[str, str]]:
    """Yield names and values of what all legs do together, as far as it is known."""
    done, positive = legs.absolute_work_j, legs.positive_work_j
    if done is not None:
        known = "?" if positive is None else f"{decimal(positive.median, 2)} J"
        words = f"{decimal(done.median, 2)} J, {known} of it positive"
        yield "work of all joints in a stride", words
    cost = legs.mechanical_cost_of_transport
    if cost is not None:
        yield "mechanical cost of transport", f"{decimal(cost, 3)}  (|work| / weight x way)"


MOST_STRIDES: Final = 200
"""Rows of the stride table."""
S = TypeVar("S")
_STRIDES: Final[Mapping[str, tuple[str, int, float]]] = {
    "stance s": ("stance_s", 3, 1.0),
    "swing s": ("swing_s", 3, 1.0),
    "duty": ("duty_factor", 3, 1.0),
    "length m": ("length_m", 3, 1.0),
    "peak N": ("peak_force_n", 1, 1.0),
    "slip mm": ("slip_m", 1, 1e3),
}
"""Columns of the stride table by their headings: name, decimals, factor."""


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


def stride_table(stats: Walk, void: Sequence[str]) -> Table:
    """Return the strides in the order of time; outliers against the foot's own segment.

    Args:
        stats: what was worked out of a log.
        void: patterns of metrics that are void.
    """
    rows: list[tuple[float, int, tuple[Cell, ...]]] = []
    for foot, figures in enumerate(stats.feet):
        rows.extend(_stride_rows(stats, foot, figures, void))
    rows.sort(key=lambda row: row[:2])
    marked = [row for row in rows if any(cell.mark for cell in row[2])]
    shown = rows if len(rows) <= MOST_STRIDES else marked[:MOST_STRIDES]
    return Table(
        ("foot", "from s", *_STRIDES),
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
    stats: Walk, foot: int, figures: FootSteps, void: Sequence[str]
) -> list[tuple[float, int, tuple[Cell, ...]]]:
    strides = figures.strides
    columns = foot_strides(stats, foot, void)
    segment = _segment_of(stats, strides.touchdown + (strides.end - strides.touchdown) // 2)
    cells = [
        _column(columns[name] * scale, decimals, segment)
        for name, decimals, scale in _STRIDES.values()
    ]
    begin = stats.seconds(strides.touchdown)
    return [
        (start, foot, (*_cells(figures.name, decimal(start, 3)), *row))
        for start, row in zip(begin, zip(*cells, strict=True), strict=True)
    ]


def _segment_of(stats: Walk, time: Ints) -> Ints:
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


def load_table(feet: Mapping[str, FootRow], loads: WalkLoads) -> Table:
    """Return the loads of each foot."""
    of = {"vertical_impulse": "vertical impulse", "force_impulse": "impulse of |F|"}
    share_of = of.get(loads.share_of or "", "load")
    words = f"Medians over whole stances; share of the {share_of}; highest: over all of them."
    return _metrics(PAGE_LOADS, "foot", feet, words, range(len(feet)))


def step_table(feet: Mapping[str, FootRow]) -> Table:
    """Return the steps of each foot."""
    words = (
        "Medians over whole strides; phase in cycles, and its consistency R, in the longest "
        "segment."
    )
    return _metrics(STEPS, "foot", feet, words, range(len(feet)))


def _metrics(
    columns: Sequence[Column[S]],
    of: str,
    sources: Mapping[str, S],
    caption: str,
    feet: Sequence[int] = (),
) -> Table:
    """Return the metrics of feet, joints or topics, a row each."""
    rows = [_cells(name, *cells_of(columns, each)) for name, each in sources.items()]
    return Table((of, *headers(columns)), rows, caption, feet)


def symmetry_table(forces: Forces) -> Table | None:
    """Return right against left, and how the load is shared; None without the four corners."""
    if not forces.symmetry_index_percent:
        return None
    words = "Right over left, percent of their mean (Robinson, Herzog and Nigg 1987): 0 is even."
    parts = [f"{name} {percent(share)}" for name, share in grouped_load(forces.load_share)]
    words += f" Load: {', '.join(parts)}." if parts else ""
    return _metrics(SYMMETRY, "pair", forces.symmetry_index_percent, words)


def leg_table(feet: Mapping[str, FootRow]) -> Table | None:
    """Return the swings of each foot; None where the log tells of no leg."""
    if not any(row.leg is not None and row.leg.frame for row in feet.values()):
        return None
    words = (
        "Medians over whole strides. Clearance above the line between footfalls, and how far the "
        "foot's frame moves in the middle of a stance (at rest), in mm; velocity at touchdown."
    )
    return _metrics(LEGS, "foot", feet, words, range(len(feet)))


def joint_table(walk: WalkMetrics) -> Table | None:
    """Return the joints; None where the log tells of none."""
    joints = walk.legs.joints
    if not joints:
        return None
    names = list(walk.feet)
    words = "rad and N m (m and N of those that slide) in the whole log."
    for name, value in work_words(walk.legs):
        words += f" {name.capitalize()}: {value}."
    feet = [joint.foot for joint in joints.values() if joint.foot]
    of_feet = len(feet) == len(joints) and set(feet) <= set(names)
    coloured = [names.index(foot) for foot in feet] if of_feet else ()
    return _metrics(JOINTS, "joint", joints, words, coloured)


def topic_table(walk: WalkMetrics) -> Table:
    """Return the timing of each topic."""
    words = f"{walk.log.messages:,} messages. Gap: over 5 usual intervals and 50 ms."
    return _metrics(TOPICS, "topic", walk.quality.topics, words)
