"""The tables of the page, in text; numbers of the same kind stand under one heading."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from dogbot_logtool.core.gait.foot_statistics import FootFigures
from dogbot_logtool.core.geometry.aggregates import Aggregate
from dogbot_logtool.core.geometry.arrays import Floats, Ints
from dogbot_logtool.core.load.load_figures import grouped_shares
from dogbot_logtool.core.quality.outliers import (
    LEAST_SHARE,
    MOST_DEVIATIONS,
    Outliers,
    outliers,
)
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.report.numbers import NOTHING, decimal, percent
from dogbot_logtool.report.stats_json import symmetry
from dogbot_logtool.results import LogFacts

MOST_STRIDES: Final = 400
"""Rows of the stride table."""


@dataclass(frozen=True, slots=True)
class Cell:
    """A number, and what is odd about it."""

    text: str
    mark: str = ""
    """``high`` or ``low`` for an outlier."""
    why: str = ""
    """What it is compared with."""


@dataclass(frozen=True, slots=True)
class Table:
    """A table whose first column names the row."""

    columns: Sequence[str]
    rows: Sequence[Sequence[Cell]]
    caption: str
    foot_of_row: Sequence[int] = ()
    """Place of the foot that a row is about, for its colour; empty: none."""

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
        ("foot", "from s", "stance s", "swing s", "duty", "length m", "peak N", "slip mm"),
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
        words += f"; {of} are listed, stats --csv has them all"
    return (
        f"{words}. Marked (▲ high, ▼ low): modified z-score above {MOST_DEVIATIONS} (Iglewicz and "
        f"Hoaglin 1993) and more than {LEAST_SHARE:.0%} off the median of the foot's strides in "
        "the same segment."
    )


def _stride_rows(
    stats: Stats, foot: int, figures: FootFigures
) -> list[tuple[float, int, tuple[Cell, ...]]]:
    strides, stance = figures.strides, figures.strides.stance
    columns: tuple[tuple[Floats, int], ...] = (
        (strides.stance_s, 3),
        (strides.swing_s, 3),
        (strides.duty_factor, 3),
        (figures.length_m, 3),
        (figures.stances.figures.peak_n[stance], 1),
        (figures.slip_m[stance] * 1e3, 1),
    )
    segment = _segment_of(stats, strides.touchdown + (strides.end - strides.touchdown) // 2)
    cells = [_column(values, decimals, segment) for values, decimals in columns]
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
    for number in np.unique(segment[segment >= 0]).tolist():
        rows = np.flatnonzero(segment == number)
        found: Outliers = outliers(values[rows])
        why = f"the median is {decimal(found.median, decimals)}"
        for flags, mark in ((found.high, "high"), (found.low, "low")):
            for row in rows[flags].tolist():
                cells[row] = Cell(cells[row].text, mark, why)
    return cells


def load_table(stats: Stats) -> Table:
    """Return the loads of each foot."""
    rows = []
    for row, foot in enumerate(stats.feet):
        share = stats.loads.shares[row] if stats.loads.shares else None
        rows.append(
            _cells(
                foot.name,
                percent(share),
                _value(foot.peak_force_n, "max", 1),
                _value(foot.peak_force_n, "median", 1),
                _in_weights(stats, foot.peak_force_n),
                _value(foot.mean_force_n, "median", 1),
                _value(foot.peak_vertical_force_n, "median", 1),
                _value(foot.impact_ratio, "median", 2),
                _value(foot.loading_rate_nps, "median", 0),
                _value(foot.friction_use, "median", 2),
                _value(foot.slip_distance_m, "median", 1, 1e3),
            )
        )
    of = {"vertical_impulse": "vertical impulse", "force_impulse": "impulse of |F|"}
    share_of = of.get(stats.loads.share_of or "", "load")
    return Table(
        (
            "foot",
            "share",
            "highest N",
            "peak N",
            "peak BW",
            "mean N",
            "peak Fz N",
            "impact",
            "rate N/s",
            "friction",
            "slip mm",
        ),
        rows,
        f"Medians over whole stances; share of the {share_of}; highest: over all of them.",
        range(len(stats.feet)),
    )


def _value(value: Aggregate | None, key: str, decimals: int, scale: float = 1.0) -> str:
    return NOTHING if value is None else decimal(getattr(value, key) * scale, decimals)


def _in_weights(stats: Stats, value: Aggregate | None) -> str:
    weight = stats.settings.body_weight_n
    return NOTHING if weight is None else _value(value, "median", 2, 1.0 / weight)


def symmetry_table(stats: Stats) -> Table | None:
    """Return right against left, and how the load is shared; None without the four corners."""
    indices = symmetry(stats)
    if indices is None:
        return None
    rows = [
        _cells(
            pair,
            *(_signed(index[key]) for key in ("stance_s", "duty_factor", "peak_force_n")),
        )
        for pair, index in indices.items()
    ]
    words = "Right over left, percent of their mean (Robinson, Herzog and Nigg 1987): 0 is even."
    if stats.loads.shares is not None:
        shares = grouped_shares(stats.loads.shares, [foot.place for foot in stats.feet])
        parts = [f"{name} {percent(share)}" for name, share in shares.items()]
        words += f" Load: {', '.join(parts)}."
    return Table(("pair", "stance %", "duty factor %", "peak force %"), rows, words)


def _signed(value: float | None) -> str:
    return NOTHING if value is None else f"{round(value, 1) + 0.0:+.1f}"


def step_table(stats: Stats) -> Table:
    """Return the steps of each foot."""
    rows = []
    for row, foot in enumerate(stats.feet):
        phase = stats.main.phases[row] if stats.main else None
        rows.append(
            _cells(
                foot.name,
                percent(foot.contact_fraction),
                str(len(foot.strides.stance)),
                _value(foot.stance_s, "median", 3),
                _value(foot.swing_s, "median", 3),
                _value(foot.duty_factor, "median", 3),
                decimal(phase.mean if phase else None, 3),
                decimal(phase.consistency if phase else None, 2),
                _value(foot.stride_length_m, "median", 3),
            )
        )
    return Table(
        ("foot", "contact", "strides", "stance s", "swing s", "duty", "phase", "R", "length m"),
        rows,
        "Medians over whole strides; phase in cycles, and its consistency R, in the longest "
        "segment.",
        range(len(stats.feet)),
    )


def topic_table(stats: Stats, log: LogFacts) -> Table:
    """Return the timing of each topic."""
    rows = [
        _cells(
            topic.topic,
            f"{topic.messages:,}",
            decimal(topic.rate_hz, 1),
            decimal(topic.median_rate_hz, 1),
            str(topic.gaps),
            decimal(topic.gaps_total_s, 2),
            decimal(topic.longest_gaps[0].length_s if topic.longest_gaps else None, 2),
            decimal(topic.offset_median_s, 3),
        )
        for topic in stats.topics
    ]
    words = f"{log.messages:,} messages."
    return Table(
        ("topic", "messages", "Hz", "usual Hz", "gaps", "gaps s", "longest s", "log - stamp s"),
        rows,
        f"{words} Usual: 1 over the median interval; in bursts, messages over the time without "
        "gaps. Gap: over 5 usual intervals and 50 ms.",
    )
