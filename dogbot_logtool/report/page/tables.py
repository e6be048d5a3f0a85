"""The tables of the page, in text; numbers of the same kind stand under one heading."""

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any, Final, NamedTuple, TypeVar

import numpy as np

from dogbot_logtool.core.arrays import Floats, Ints, distinct, median_of
from dogbot_logtool.core.loads import WalkLoads
from dogbot_logtool.core.metrics import (
    Joint,
    Legs,
    LoadShare,
    Stride,
    Symmetry,
    TopicQuality,
    WalkMetrics,
)
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.report.tables import NOTHING, Column, FootRow, foot_rows, stride_table

MOST_DEVIATIONS: Final = 3.5
"""Modified z-score beyond which a value is an outlier (Iglewicz and Hoaglin 1993)."""
LEAST_SHARE: Final = 0.1
"""An outlier also misses the median by more than this share of it: in a walk so even that
neighbouring strides differ by one sample, one more sample is no event."""
FEWEST: Final = 5
"""Values from which a median says what is usual."""
MOST_STRIDES: Final = 200
"""Rows of the table of strides."""
S = TypeVar("S")
_STEPS: Final[Sequence[Column[FootRow]]] = (
    Column("contact", lambda row: row.foot.contact_fraction, ".1%"),
    Column("strides", lambda row: row.foot.strides),
    Column("stance s", lambda row: row.foot.stance_s, ".3f"),
    Column("swing s", lambda row: row.foot.swing_s, ".3f"),
    Column("duty", lambda row: row.foot.duty_factor, ".3f"),
    Column("phase", lambda row: row.phase.mean, ".3f"),
    Column("R", lambda row: row.phase.consistency, ".2f"),
    Column("length m", lambda row: row.foot.stride_length_m, ".3f"),
)
_LOADS: Final[Sequence[Column[FootRow]]] = (
    Column("share", lambda row: row.load_share, ".1%"),
    Column("highest N", lambda row: row.foot.peak_force_n and row.foot.peak_force_n.max, ".1f"),
    Column("peak N", lambda row: row.foot.peak_force_n, ".1f"),
    Column("peak BW", lambda row: row.foot.peak_force_bw, ".2f"),
    Column("mean N", lambda row: row.foot.mean_force_n, ".1f"),
    Column("peak Fz N", lambda row: row.foot.peak_vertical_force_n, ".1f"),
    Column("impact", lambda row: row.foot.impact_ratio, ".2f"),
    Column("rate N/s", lambda row: row.foot.loading_rate_nps, ".0f"),
    Column("friction", lambda row: row.foot.friction_use, ".2f"),
    Column("slip mm", lambda row: row.foot.slip_m, ".1f", 1e3),
)
_LEGS: Final[Sequence[Column[FootRow]]] = (
    Column("clearance mm", lambda row: row.foot.clearance_m, ".1f", 1e3),
    Column("swing m", lambda row: row.foot.swing_length_m, ".3f"),
    Column("step m", lambda row: row.foot.step_length_m, ".3f"),
    Column("width m", lambda row: row.foot.step_width_m, "z.3f"),
    Column("down m/s", lambda row: row.foot.touchdown_down_mps, "z.3f"),
    Column("along m/s", lambda row: row.foot.touchdown_along_mps, ".3f"),
)
_JOINTS: Final[Sequence[Column[Joint]]] = (
    Column("range", lambda joint: joint.range_of_motion, ".3f"),
    Column("peak speed", lambda joint: joint.peak_speed, ".2f"),
    Column("peak N m", lambda joint: joint.peak_effort, ".2f"),
    Column("RMS N m", lambda joint: joint.rms_effort, ".2f"),
    Column("|work| J", lambda joint: joint.absolute_work_j, ".2f"),
    Column("near limit", lambda joint: joint.near_limit_fraction, ".1%"),
)
_TOPICS: Final[Sequence[Column[TopicQuality]]] = (
    Column("messages", lambda topic: topic.messages),
    Column("Hz", lambda topic: topic.rate_hz, ".1f"),
    Column("gaps", lambda topic: topic.gaps),
    Column("gaps s", lambda topic: topic.gaps_total_s, ".2f"),
    Column("longest s", lambda topic: topic.interval_max_s, ".2f"),
    Column("log - stamp s", lambda topic: topic.clock_offset_s, "z.3f"),
)
_SYMMETRY: Final[Sequence[Column[Symmetry]]] = (
    Column("stance %", lambda pair: pair.stance_s, "+z.1f"),
    Column("duty factor %", lambda pair: pair.duty_factor, "+z.1f"),
    Column("peak force %", lambda pair: pair.peak_force_n, "+z.1f"),
)
INDEX: Final[Sequence[Column[WalkMetrics]]] = (
    Column("duration s", lambda metrics: metrics.log.duration_s, ".2f"),
    Column("duty", lambda metrics: metrics.gait.duty_factor, ".3f"),
    Column("strides/s", lambda metrics: metrics.gait.stride_frequency_hz, ".3f"),
    Column("distance m", lambda metrics: metrics.base.path_length_m, ".2f"),
    Column("m/s forward", lambda metrics: metrics.base.forward_speed_mps, "z.3f"),
    Column("impulse/weight", lambda metrics: metrics.forces.vertical_impulse_over_weight, "z.3f"),
)
"""Several logs on the page."""


class Cell(NamedTuple):
    """A number, and what is odd about it."""

    text: str
    mark: str = ""
    """``high`` or ``low`` for an outlier."""
    why: str = ""
    """The reference that it is compared with."""


class Table(NamedTuple):
    """A table whose first column names the row."""

    columns: Sequence[str]
    rows: Sequence[tuple[int | None, Sequence[Cell]]]
    """Each with the index of the foot that it is about, for its colour; None: it is about none."""
    caption: str


def _table(
    of: str, columns: Sequence[Column[S]], sources: Mapping[str, S], caption: str,
    feet: Mapping[str, int] = MappingProxyType({}),
) -> Table | None:  # fmt: skip
    """Return a row for each of some sources, by name; None without any.

    Args:
        of: heading of the names.
        columns: of the values.
        sources: by name.
        caption: sentences about them.
        feet: index of the foot that a source is about, by the name of the source.
    """
    rows = [
        (feet.get(name), [Cell(name), *(Cell(column.cell(each)) for column in columns)])
        for name, each in sources.items()
    ]
    return Table((of, *(column.heading for column in columns)), rows, caption) if rows else None


def page_tables(walk: Walk) -> dict[str, Table | None]:
    """Return the tables of a page by the names that its template knows them by."""
    metrics = walk.metrics
    forces, joints = metrics.forces, metrics.legs.joints
    feet = foot_rows(metrics)
    index = {name: row for row, name in enumerate(feet)}
    legs = feet if walk.legs is not None and any(leg.path for leg in walk.legs.feet) else {}
    of_joint = {name: index[each.foot] for name, each in joints.items() if each.foot in index}
    coloured = of_joint if len(of_joint) == len(joints) else {}
    pairs = forces.symmetry_index_percent
    return {
        "steps": _table("foot", _STEPS, feet, _STEP_WORDS, index),
        "loads": _table("foot", _LOADS, feet, _load_words(walk.loads), index),
        "symmetry": _table("pair", _SYMMETRY, pairs, _symmetry_words(forces.load_share)),
        "legs": _table("foot", _LEGS, legs, _LEG_WORDS, index),
        "joints": _table("joint", _JOINTS, joints, _joint_words(metrics.legs), coloured),
        "strides": _stride_table(walk),
        "topics": _table("topic", _TOPICS, metrics.quality.topics, _topic_words(metrics)),
    }


_STEP_WORDS: Final = (
    "Medians over whole strides; phase in cycles, and its consistency R, in the longest segment."
)
_LEG_WORDS: Final = (
    "Medians over whole strides. Clearance above the line between footfalls; velocity at touchdown."
)


def _load_words(loads: WalkLoads) -> str:
    of = {"vertical_impulse": "vertical impulse", "force_impulse": "impulse of |F|"}
    share_of = of.get(loads.share_of or "", "load")
    return f"Medians over whole stances; share of the {share_of}; highest: over all of them."


def _symmetry_words(share: LoadShare) -> str:
    words = "Right over left, percent of their mean (Robinson, Herzog and Nigg 1987): 0 is even."
    parts = [
        f"{name} {part:.1%}, {other} {1.0 - part:.1%}"
        for name, other, part in (("fore", "hind", share.fore), ("left", "right", share.left))
        if part is not None
    ]
    return f"{words} Load: {', '.join(parts)}." if parts else words


def _topic_words(metrics: WalkMetrics) -> str:
    return f"{metrics.log.messages:,} messages. Gap: over 5 usual intervals and 50 ms."


def _joint_words(legs: Legs) -> str:
    words = "rad and N m (m and N of those that slide) in the whole log."
    done, positive = legs.absolute_work_j, legs.positive_work_j
    cost = legs.mechanical_cost_of_transport
    if done is not None:
        known = "?" if positive is None else f"{positive.median:.2f} J"
        words += f" Work of all joints in a stride: {done.median:.2f} J, {known} of it positive."
    if cost is not None:
        words += f" Mechanical cost of transport: {cost:.3f} (|work| / (weight x distance))."
    return words


_STRIDES: Final[Sequence[Column[Stride]]] = (
    Column("stance s", lambda stride: stride.stance_s, ".3f"),
    Column("swing s", lambda stride: stride.swing_s, ".3f"),
    Column("duty", lambda stride: stride.duty_factor, ".3f"),
    Column("length m", lambda stride: stride.length_m, ".3f"),
    Column("peak N", lambda stride: stride.peak_force_n, ".1f"),
    Column("slip mm", lambda stride: stride.slip_m, ".1f", 1e3),
)


def _stride_table(walk: Walk) -> Table:
    """Return the strides in the order of time; outliers against the foot's own segment."""
    table, names = stride_table(walk), [foot.name for foot in walk.feet]
    every: Any = Stride(**table.columns)  # type: ignore[arg-type] # all strides at once
    feet = np.array([names.index(name) for name in table.foot], np.int64)
    segment = np.full(len(feet), -1)
    middle = walk.origin + 1e9 * (every.start_s + (every.stance_s + every.swing_s) / 2.0)
    for number, each in enumerate(walk.segments):
        segment[(middle >= each.start) & (middle < each.end)] = number
    groups = np.where(segment < 0, -1, feet + len(names) * segment)
    columns = [_stride_cells(column, every, groups) for column in _STRIDES]
    rows = [
        [Cell(name), Cell(f"{at:.3f}"), *cells]
        for name, at, *cells in zip(table.foot, every.start_s.tolist(), *columns, strict=True)
    ]
    order = np.lexsort([feet, every.start_s]).tolist()
    marked = [row for row in order if any(cell.mark for cell in rows[row])]
    listed = order if len(order) <= MOST_STRIDES else marked[:MOST_STRIDES]
    return Table(
        ("foot", "from s", *(column.heading for column in _STRIDES)),
        [(int(feet[row]), rows[row]) for row in listed],
        _stride_words(len(order), len(marked), len(listed)),
    )


def _stride_cells(column: Column[Stride], every: Stride, groups: Ints) -> list[Cell]:
    """Return a column of strides; marked is what is far from the others of its group."""
    values: Any = column.of(every) * column.scale

    def text(value: float) -> str:
        return NOTHING if np.isnan(value) else format(value, column.form)

    cells = [Cell(text(value)) for value in values.tolist()]
    last_digit = 10.0 ** -int(column.form.strip(".f"))
    for group in distinct(groups[groups >= 0]).tolist():
        rows = np.flatnonzero(groups == group)
        signs, median = outliers(values[rows], last_digit)
        for row, sign in zip(rows.tolist(), signs.tolist(), strict=True):
            if sign:
                mark = "high" if sign > 0 else "low"
                cells[row] = Cell(cells[row].text, mark, f"the median is {text(median)}")
    return cells


def _stride_words(every: int, marked: int, listed: int) -> str:
    if not every:
        return "No foot makes a whole stride."
    words = f"{every} whole strides, {marked} with an outlier"
    if listed < every:
        of = "these" if listed == marked else f"the first {listed} of these"
        words += f"; {of} are listed, export has them all"
    return (
        f"{words}. Marked (▲ high, ▼ low): modified z-score above {MOST_DEVIATIONS} (Iglewicz and "
        f"Hoaglin 1993) and more than {LEAST_SHARE:.0%} off the median of the foot's strides in "
        "the same segment."
    )


def outliers(values: Floats, least: float = 0.0) -> tuple[Ints, float]:
    """Mark values far from the median.

    The modified z-score is 0.6745 (x - median) / MAD, with MAD the median of |x - median|; where
    that is 0, because more than half of the values are equal, it is (x - median) / 1.2533 MeanAD,
    with MeanAD the mean of |x - median|.
    Source: Iglewicz and Hoaglin, How to Detect and Handle Outliers, 1993.

    Args:
        values: (n,) any unit; NaN is not known, and no outlier.
        least: distance from the median, in that unit, up to which no value is one.

    Returns:
        (n,) 1 far above the median, -1 far below it, else 0; and the median, NaN where too few
        values are known.
    """
    known = values[np.isfinite(values)]
    if len(known) < FEWEST:
        return np.zeros(len(values), np.int64), float("nan")
    median = float(median_of(known))
    deviations = np.abs(known - median)
    usual = float(median_of(deviations)) / 0.6745 or float(np.mean(deviations)) * 1.253314
    away = np.nan_to_num(values - median)
    far = np.abs(away) > max(MOST_DEVIATIONS * usual, LEAST_SHARE * abs(median), least)
    return (np.sign(away) * far).astype(np.int64), median
