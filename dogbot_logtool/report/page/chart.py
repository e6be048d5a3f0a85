"""Charts as Plotly.js reads them: rows of panels on one grid, and what all of them share."""

import base64
import html
from collections.abc import Mapping, Sequence
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.arrays import Float32s, Floats, Ints, distinct
from dogbot_logtool.core.scene.feet import foot_colour
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.io.printable import printable

NEUTRAL: Final = "#808080"
"""Seen on white and on black."""
SECOND: Final = "#8e6bbf"
"""Of what is set apart in a figure."""
BAD: Final = "#c8382e"
"""Gaps and damage."""
_SYMBOLS: Final = ("triangle-up", "triangle-down", "square", "diamond", "circle", "cross")
"""A marker a foot, in turn, for those who cannot tell the colours; hollow for hind feet."""
_GLYPHS: Final = ("▲△", "▼▽", "■□", "◆◇", "●○", "✚✛")
"""The same in text, filled and hollow."""
FINE: Final = 5e-4
"""s or m, to which positions along the lower axis are drawn."""
MARGIN: Final = {"l": 48, "r": 10, "t": 6, "b": 48}
"""Pixels; the same on the left for all figures over time, so that they stand in line."""
_DTYPES: Final = {"float64": "f8", "float32": "f4", "int32": "i4", "int16": "i2", "int8": "i1"}
"""Names of types of packed arrays in Plotly.js."""

Trace = dict[str, Any]
"""A trace of Plotly.js; arrays may be numpy's."""


class Drawing(NamedTuple):
    """A figure with its words."""

    name: str
    """Its id on the page."""
    title: str
    alt: str
    """Description for readers who do not see it."""
    caption: str
    data: Sequence[Trace]
    layout: dict[str, Any]
    over_time: bool = False
    """Whether its x axis is the time that all such figures share."""
    feet: Sequence[Mapping[str, Any]] = ()
    """Edges of each foot's row, as those of a shape of Plotly; empty: feet have no rows."""

    def plain(self) -> dict[str, Any]:
        """Return the figure as values that JSON has."""
        data = [_plain_trace(each) for each in self.data]
        layout = _plain(self.layout)
        return {"name": self.name, "over_time": self.over_time, "data": data, "layout": layout}


class Row(NamedTuple):
    """Panels side by side, with one upright axis."""

    title: str
    traces: Sequence[tuple[int, Trace]]
    """Each with the column of its panel."""
    extent: tuple[float, float]


def grid(
    rows: Sequence[Row],
    x: Mapping[str, Any],
    row_pixels: int,
    columns: Sequence[str] = ("",),
) -> tuple[list[Trace], dict[str, Any]]:
    """Lay out rows of panels one above the other; those of a column share the lower axis.

    Args:
        rows: from the top.
        x: the lower axis, as Plotly documents it.
        row_pixels: height of a row.
        columns: a heading each; empty: none.
    """
    layout: dict[str, Any] = {
        "height": row_pixels * len(rows) + 50,
        "margin": MARGIN | ({"t": 24, "r": 16} if any(columns) else {}),
        "showlegend": False,
        "hovermode": "x unified",
        "hoversubplots": "axis",
        "grid": {"rows": len(rows), "columns": len(columns), "pattern": "coupled", "ygap": 0.14},
        "annotations": [
            note(title, x=0.5, xref=f"x{_end(number)} domain", xanchor="center")
            for number, title in enumerate(columns)
            if title
        ],
    }
    for number in range(len(columns)):
        layout[f"xaxis{_end(number)}"] = dict(x)
    for number, row in enumerate(rows):
        layout[f"yaxis{_end(number)}"] = {
            "range": list(row.extent),
            "fixedrange": True,
            "nticks": row_pixels // 40 + 2,
            "zeroline": True,
            "title": {"text": label(row.title), "standoff": 2, "font": {"size": 11}},
        }
    data = [
        {**trace, "xaxis": f"x{_end(column)}", "yaxis": f"y{_end(number)}"}
        for number, row in enumerate(rows)
        for column, trace in row.traces
    ]
    return data, layout


def _end(number: int) -> str:
    """Return what the name of an axis ends with."""
    return str(number + 1) if number else ""


def extent_of(
    values: Floats, least: float = 0.0, *, with_zero: bool = False
) -> tuple[float, float]:
    """Return the range of an axis.

    Args:
        values: that are shown, NaN where nothing is.
        least: span that is shown at least, so that noise does not look like motion.
        with_zero: whether 0 is shown, wherever the values lie.
    """
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    pad = max(0.06 * (high - low), (least - (high - low)) / 2.0) or 1.0
    if with_zero:
        low, high = min(low, 0.0), max(high, 0.0)
    return low - pad, high + pad


def line(
    x: Floats | Float32s, y: Floats | Float32s, name: str, style: Trace, more: Trace | None = None
) -> Trace:
    """Return a line; NaN breaks it.

    Args:
        x: (n,).
        y: (n,).
        name: of the line.
        style: its colour, width and dash, as Plotly names them.
        more: of the trace.
    """
    points = {"x": x, "y": y, "name": name, "line": {"width": 1.5, **style}}
    return {"type": "scatter", "mode": "lines", **points, **(more or {})}


def area(x: Floats, y: Floats, name: str, colour: str, alpha: float) -> Trace:
    """Return a filled outline that says nothing to the mouse; NaN parts one from the next."""
    fill = {"fill": "toself", "fillcolor": translucent(colour, alpha), "hoverinfo": "skip"}
    return line(x, y, name, {"width": 0}, fill)


def note(text: str, **where: Any) -> dict[str, Any]:  # noqa: ANN401 - whatever Plotly documents
    """Return words above a figure."""
    above = {"y": 1, "yref": "paper", "yanchor": "bottom", "showarrow": False}
    return {"text": text, **above, "font": {"size": 11}, **where}


def time_axis(walk: Walk) -> dict[str, Any]:
    """Return the lower axis of a figure over time."""
    end = (walk.end - walk.origin) / 1e9
    return {
        "title": {"text": "time since the log's start", "standoff": 10},
        "ticksuffix": " s",
        "hoverformat": ".3f",
        "range": [-0.005 * end, 1.005 * end],
        "showgrid": True,
        "zeroline": False,
        "ticks": "outside",
    }


def seconds(walk: Walk, time: Ints) -> Floats:
    """Return times as s since the log's start."""
    since: Floats = (time - walk.origin) / 1e9
    return since


def thinned(count: int, most: int) -> Ints:
    """Return evenly spaced rows, at most so many; the last one is among them."""
    if count <= most:
        return np.arange(count)
    return distinct(np.linspace(0, count - 1, most).astype(np.int64))


def is_hind(walk: Walk, row: int) -> bool:
    """Tell whether a foot is a hind foot."""
    leg_position = walk.feet[row].leg_position
    return leg_position is not None and leg_position[0] == "back"


def foot_marker(walk: Walk, row: int) -> dict[str, Any]:
    """Return the marker of a foot by its index: its colour and shape, hollow for a hind foot."""
    hollow = is_hind(walk, row)
    symbol = _SYMBOLS[row % len(_SYMBOLS)] + ("-open" if hollow else "")
    style = {"width": 2 if hollow else 0, "color": foot_colour(row)}
    return {"color": foot_colour(row), "symbol": symbol, "size": 9, "line": style}


def foot_glyph(walk: Walk, row: int) -> str:
    """Return the marker of a foot as a character."""
    return _GLYPHS[row % len(_GLYPHS)][is_hind(walk, row)]


def label(text: str) -> str:
    """Return a text that Plotly shows as it is.

    Plotly reads a little HTML in its labels, and `%{...}` in its templates.
    """
    return html.escape(printable(text), quote=False).replace("%", "&#37;")


def translucent(colour: str, alpha: float) -> str:
    """Return a colour ``#rrggbb`` that lets the background through."""
    red, green, blue = (int(colour[start : start + 2], 16) for start in (1, 3, 5))
    return f"rgba({red},{green},{blue},{alpha})"


def packed(values: NDArray[Any], finest: float = 0.0) -> dict[str, Any]:
    """Return an array as Plotly.js reads it from base64, in as few bytes as are fine enough.

    Args:
        values: NaN where nothing is drawn.
        finest: step between two neighbouring numbers that is fine enough, in their own unit.

    Returns:
        type and bytes; for numbers of 16 bits with ``step`` and ``lowest``, which turn integers
        into values, the lowest integer standing for NaN.
    """
    values = values if values.dtype.name in _DTYPES else values.astype(np.float64)
    scale = {}
    known = values[np.isfinite(values)] if values.dtype.kind == "f" else np.empty(0)
    if len(known):
        # Of eight digits, so that the numbers are short.
        lowest = float(f"{known.min():.8g}")
        step = float(f"{(known.max() - lowest) / 65530.0:.8g}")
        if len(known) == values.size and np.array_equal(values.astype(np.int8), values):
            values = values.astype(np.int8)
        elif 0.0 < step <= finest:
            level = np.rint((values - lowest) / step) - 32767.0
            values = np.where(np.isfinite(level), level, -32768.0).astype(np.int16)
            scale = {"step": step, "lowest": lowest}
        elif np.spacing(np.float32(np.abs(known).max())) <= finest:
            values = values.astype(np.float32)
    little = np.ascontiguousarray(values, values.dtype.newbyteorder("<"))
    content = base64.b64encode(little.tobytes()).decode()
    shape = {"shape": ", ".join(map(str, values.shape))} if values.ndim > 1 else {}
    return {"dtype": _DTYPES[values.dtype.name], "bdata": content, **shape, **scale}


_FINEST: Final = {"x": FINE, "y": np.inf, "customdata": 10 * FINE}


def _plain_trace(trace: Trace) -> dict[str, Any]:
    points = {
        key: packed(trace[key], finest)
        for key, finest in _FINEST.items()
        if isinstance(trace.get(key), np.ndarray)
    }
    return {**_plain(trace), **points}


def _plain(value: Any) -> Any:  # noqa: ANN401 - any part of a chart
    if isinstance(value, np.ndarray):
        return packed(value)
    if isinstance(value, dict):
        return {key: _plain(each) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(each) for each in value]
    return value
