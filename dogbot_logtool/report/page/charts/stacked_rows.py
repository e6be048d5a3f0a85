"""Curves over time in rows, one above the other, on one axis of time."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Floats, Ints
from dogbot_logtool.core.contact.curves import CurveDetail, curve_of
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.report.page.charts.chart import Chart, Trace, scatter
from dogbot_logtool.report.page.charts.drawing import LINE, MARGIN, drawn_seconds, time_axis

DETAIL: Final = CurveDetail(most_bins=1500)
"""More than the page has columns of pixels; the lowest and the highest value of each are drawn."""


@dataclass(frozen=True, slots=True)
class Line:
    """One curve."""

    name: str
    time: Ints
    """(n,) ns, strictly increasing."""
    value: Floats
    """(n,) NaN where it is not known."""
    colour: str = LINE
    dash: str = "solid"


@dataclass(frozen=True, slots=True)
class Row:
    """Curves of one quantity."""

    title: str
    unit: str
    decimals: int
    least: float
    """Span of values that fills the row at least, so that noise does not look like motion."""
    lines: tuple[Line, ...]


def stacked(stats: Stats, rows: Sequence[Row], breaks: Ints) -> Chart:
    """Draw rows one above the other.

    Args:
        stats: of the log, for its time.
        rows: from the top.
        breaks: (b, 2) ns, over which no line leads, beside unknown values.
    """
    figure = Chart(
        layout={
            "height": 110 * len(rows) + 50,
            "margin": MARGIN,
            "showlegend": False,
            "hovermode": "x unified",
            "hoversubplots": "axis",
            "xaxis": {**time_axis(stats), "anchor": f"y{len(rows)}" if len(rows) > 1 else "y"},
        }
    )
    share = 1.0 / len(rows)
    for number, row in enumerate(rows):
        end = str(number + 1) if number else ""
        figure.layout[f"yaxis{end}"] = {
            "domain": [1.0 - (number + 0.86) * share, 1.0 - number * share],
            "range": _extent(row),
            "fixedrange": True,
            "nticks": 4,
            "zeroline": True,
            "title": {"text": f"{row.title} ({row.unit})", "standoff": 2, "font": {"size": 11}},
        }
        figure.data.extend(_trace(stats, row, line, breaks, end) for line in row.lines)
    return figure


def _extent(row: Row) -> list[float]:
    """Return the range of a row's axis."""
    values = np.concatenate([line.value for line in row.lines])
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    beside = max(0.06 * (high - low), (row.least - (high - low)) / 2.0)
    return [low - beside, high + beside]


def _trace(stats: Stats, row: Row, line: Line, breaks: Ints, end: str) -> Trace:
    curve = curve_of(line.time, line.value, DETAIL)
    time, value = np.empty(0, np.int64), np.empty(0)
    if curve is not None:
        unknown = timespans.spans_where(line.time, np.isnan(line.value[:-1]))
        time, value = curve.line(timespans.merge(np.concatenate([breaks, unknown])))
    return scatter(
        x=drawn_seconds(stats, time),
        y=value.astype(np.float32),
        mode="lines",
        line={"color": line.colour, "width": 1.5, "dash": line.dash},
        name=line.name,
        hovertemplate=f"%{{y:.{row.decimals}f}} {row.unit}",
        xaxis="x",
        yaxis=f"y{end}",
    )
