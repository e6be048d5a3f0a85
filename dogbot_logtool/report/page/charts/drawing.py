"""Charts as the plotting library of the page reads them, and what all of them share."""

import base64
import html
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.arrays import Float32s, Floats, Ints, distinct
from dogbot_logtool.core.scene.foot_style import foot_colour
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.io.printable import printable

Trace = dict[str, Any]
"""A trace of Plotly.js; arrays may be numpy's."""
_DTYPES: Final = {"float64": "f8", "float32": "f4", "int32": "i4", "int16": "i2", "int8": "i1"}
"""Names of types of packed arrays in Plotly.js."""


@dataclass(frozen=True, slots=True)
class Chart:
    """Traces and their layout, as Plotly.js documents them."""

    data: list[Trace] = field(default_factory=list)
    layout: dict[str, Any] = field(default_factory=dict)

    def plain(self) -> dict[str, Any]:
        """Return the chart as values that JSON has."""
        return {"data": [_trace(each) for each in self.data], "layout": _plain(self.layout)}


def scatter(**parts: Any) -> Trace:  # noqa: ANN401 - whatever Plotly.js documents
    """Return a trace of lines or markers."""
    return {"type": "scatter", **parts}


def bars(**parts: Any) -> Trace:  # noqa: ANN401 - whatever Plotly.js documents
    """Return a trace of horizontal bars."""
    return {"type": "bar", "orientation": "h", **parts}


def packed(values: NDArray[Any]) -> dict[str, Any]:
    """Return an array as Plotly.js reads it from base64; of types that it does not know, as f8."""
    known = values if values.dtype.name in _DTYPES else values.astype(np.float64)
    little = np.ascontiguousarray(known, known.dtype.newbyteorder("<"))
    found = {
        "dtype": _DTYPES[known.dtype.name],
        "bdata": base64.b64encode(little.tobytes()).decode(),
    }
    if known.ndim > 1:
        found["shape"] = ", ".join(str(each) for each in known.shape)
    return found


def _trace(trace: Trace) -> dict[str, Any]:
    """Return a trace as values that JSON has, its points in as few bytes as can be seen."""
    points = {
        key: packed_small(trace[key], step)
        for key, step in (("x", LARGEST_STEP), ("y", np.inf), ("customdata", 10 * LARGEST_STEP))
        if isinstance(trace.get(key), np.ndarray)
    }
    return {**_plain(trace), **points}


def packed_small(values: NDArray[Any], largest_step: float) -> dict[str, Any]:
    """Return an array packed in 16 bits where that is fine enough, else as it is.

    Args:
        values: (n,), NaN where nothing is drawn.
        largest_step: between two neighbouring numbers, at most, in their own unit.

    Returns:
        as `packed`, with `step` and `lowest` that turn integers into values; the lowest integer
        stands for NaN.
    """
    known = values[np.isfinite(values)] if values.dtype.kind == "f" else np.empty(0)
    if not len(known):
        return packed(values)
    if len(known) == len(values) and np.array_equal(values.astype(np.int8), values):
        return packed(values.astype(np.int8))
    # Of eight digits, so that the numbers are short.
    lowest = float(f"{known.min():.8g}")
    step = float(f"{(known.max() - lowest) / 65530.0:.8g}")
    if not 0.0 < step <= largest_step:
        return packed(values)
    level = np.rint((values - lowest) / step) - 32767.0
    small = np.where(np.isfinite(level), level, -32768.0).astype(np.int16)
    return {**packed(small), "step": step, "lowest": lowest}


def _plain(value: Any) -> Any:  # noqa: ANN401 - any part of a chart
    if isinstance(value, np.ndarray):
        return packed(value)
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, dict):
        return {key: _plain(each) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(each) for each in value]
    return value


NEUTRAL: Final = "#808080"
"""Seen on white and on black."""
LINE: Final = "#6f7680"
"""Lines that are about no foot; also `SECOND`, for the second one of a figure."""
SECOND: Final = "#8e6bbf"
BAD: Final = "#c8382e"
"""Gaps and damage."""
SYMBOLS: Final = ("triangle-up", "triangle-down", "square", "diamond", "circle", "cross")
"""A marker a foot, in turn, for those who cannot tell the colours; hollow for hind feet."""
GLYPHS: Final = ("▲△", "▼▽", "■□", "◆◇", "●○", "✚✛")
"""The same in text, filled and hollow."""
NEAR_M: Final = 1000.0
LARGEST_STEP: Final = 5e-4
"""s or m, to which positions along the lower axis are drawn."""
LONGEST_FLOAT32_S: Final = 8192.0
"""s up to which 32 bits tell half a millisecond."""
MARGIN: Final = {"l": 48, "r": 10, "t": 6, "b": 44}
"""Pixels; the same on the left for all figures over time, so that they stand in line."""


@dataclass(frozen=True, slots=True)
class Drawing:
    """A figure with its words."""

    name: str
    """Its id on the page."""
    title: str
    alt: str
    """Description for readers who do not see it."""
    caption: str
    figure: Chart
    over_time: bool = False
    """Whether its x axis is the time that all such figures share."""
    feet: Sequence[tuple[float, float]] = ()
    """Lower and upper edge of each foot's row, as shares of the height; empty: no such rows."""


def is_hind(stats: Walk, row: int) -> bool:
    """Tell whether a foot is a hind foot."""
    leg_position = stats.feet[row].leg_position
    return leg_position is not None and leg_position[0] == "back"


def foot_marker(stats: Walk, row: int) -> dict[str, Any]:
    """Return the marker of a foot by its index: its colour and shape, hollow for a hind foot."""
    hollow = is_hind(stats, row)
    symbol = SYMBOLS[row % len(SYMBOLS)] + ("-open" if hollow else "")
    line = {"width": 2 if hollow else 0, "color": foot_colour(row)}
    return {"color": foot_colour(row), "symbol": symbol, "size": 9, "line": line}


def foot_glyph(stats: Walk, row: int) -> str:
    """Return the marker of a foot as a character."""
    return GLYPHS[row % len(GLYPHS)][is_hind(stats, row)]


def label(text: str) -> str:
    """Return a text that Plotly shows as it is.

    Plotly reads a little HTML in its labels, and `%{...}` in its templates.
    """
    return html.escape(printable(text), quote=False).replace("%", "&#37;")


def translucent(colour: str, alpha: float) -> str:
    """Return a colour ``#rrggbb`` that lets the background through."""
    red, green, blue = (int(colour[start : start + 2], 16) for start in (1, 3, 5))
    return f"rgba({red},{green},{blue},{alpha})"


def seconds(stats: Walk, time: Ints) -> Floats:
    """Return times as s since the log's start."""
    since: Floats = (time - stats.origin) / 1e9
    return since


def drawn_seconds(stats: Walk, time: Ints) -> Floats | Float32s:
    """Return times as s since the log's start, to half a millisecond: half as many bytes."""
    exact = seconds(stats, time)
    fits = (stats.end - stats.origin) / 1e9 < LONGEST_FLOAT32_S
    return exact.astype(np.float32) if fits else exact


def drawn_metres(position: Floats) -> Floats | Float32s:
    """Return positions in m to a tenth of a millimetre: near the origin 32 bits tell it."""
    known = position[np.isfinite(position)]
    is_near = bool((np.abs(known) < NEAR_M).all())
    return position.astype(np.float32) if is_near else position


def thinned(count: int, most: int) -> Ints:
    """Return evenly spaced rows, at most so many; the last one is among them."""
    if count <= most:
        return np.arange(count)
    return distinct(np.linspace(0, count - 1, most).astype(np.int64))


def time_axis(stats: Walk) -> dict[str, Any]:
    """Return the x axis of a figure over time."""
    end = (stats.end - stats.origin) / 1e9
    pad = 0.005 * end
    return {
        "title": {"text": "time since the log's start", "standoff": 10},
        "ticksuffix": " s",
        "hoverformat": ".3f",
        "range": [-pad, end + pad],
        "showgrid": True,
        "zeroline": False,
        "ticks": "outside",
    }
