"""What every figure of the page shares: names that stay text, margins, thinning."""

import html
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from dogbot_logtool.core.geometry.arrays import Floats, Ints
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.io.printable import printable

NEUTRAL: Final = "#808080"
"""Seen on white and on black."""
BAD: Final = "#c8382e"
"""Gaps and damage."""
SYMBOLS: Final = ("triangle-up", "triangle-down", "square", "diamond", "circle", "cross")
"""A marker a foot, in turn, for those who cannot tell the colours."""
MARGIN: Final = {"l": 48, "r": 10, "t": 6, "b": 44}
"""Pixels; the same on the left for all figures over time, so that they stand in line."""


@dataclass(frozen=True, slots=True)
class Drawing:
    """A figure with its words."""

    name: str
    """Its id on the page."""
    title: str
    alt: str
    """What it shows, for those who do not see it."""
    caption: str
    figure: Any
    """A Plotly figure."""
    over_time: bool = False
    """Whether its x axis is the time that all such figures share."""


def label(text: str) -> str:
    """Return a text that Plotly shows as it is.

    Plotly reads a little HTML in its labels, and `%{...}` in its templates.
    """
    return html.escape(printable(text), quote=False).replace("%", "&#37;")


def translucent(colour: str, alpha: float) -> str:
    """Return a colour ``#rrggbb`` that lets the background through."""
    red, green, blue = (int(colour[start : start + 2], 16) for start in (1, 3, 5))
    return f"rgba({red},{green},{blue},{alpha})"


def seconds(stats: Stats, time: Ints) -> Floats:
    """Return times as s since the log's start."""
    since: Floats = (time - stats.origin) / 1e9
    return since


def thinned(count: int, most: int) -> Ints:
    """Return evenly spaced rows, at most so many; the last one is among them."""
    if count <= most:
        return np.arange(count)
    return np.unique(np.linspace(0, count - 1, most).astype(np.int64))


def time_axis(stats: Stats) -> dict[str, Any]:
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
