"""The figures of the feet over time: when each is down, and what it carries."""

from collections.abc import Sequence
from typing import Any, Final

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.core.gait.feet import FootSteps
from dogbot_logtool.core.scene.feet import foot_colour, short_names
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.report.page.chart import (
    MARGIN,
    NEUTRAL,
    Drawing,
    Row,
    Trace,
    area,
    grid,
    label,
    seconds,
    time_axis,
    translucent,
)
from dogbot_logtool.report.page.over_time import ROW_PIXELS, Line, line_over_time
from dogbot_logtool.report.tables import NOTHING
from dogbot_logtool.report.text.gait_diagram import default_window

MOST_STANCES: Final = 200
"""Stances of a foot that are drawn one by one."""
_SHARE_BINS: Final = 2000
"""Bins of the share of contact in the rest of a long log."""
_LEFT_OUT: Final = (
    " Of every {:.0f} ms the lowest and the highest sample are drawn, so every peak is there; the "
    "typical strides are drawn in full, and so is a short part that --start and --end choose."
)
_BAR: Final = 0.7
"""Height of a bar, of the distance between two feet."""


def gait_diagram(walk: Walk) -> Drawing | None:
    """Draw a bar a foot, filled where the foot is down (Hildebrand's); None without feet."""
    if not walk.feet:
        return None
    data: list[Trace] = []
    drawn = [_stances_drawn(walk, foot) for foot in walk.feet]
    whole = np.array([[walk.origin, walk.end]], np.int64)
    for row, (foot, spans) in enumerate(zip(walk.feet, drawn, strict=True)):
        unknown = timespans.subtract(whole, foot.known)
        data.append(_bars(walk, foot, unknown, row, _HATCHED, "not known"))
        data.append(_bars(walk, foot, spans, row, _filling(walk, row), "down"))
        if len(spans) < len(foot.record.in_contact):
            data.append(_contact_share(walk, foot, spans, row))
    names = short_names([foot.name for foot in walk.feet])
    layout = {
        "height": 46 * len(names) + 72,
        # The names of events stand above it.
        "margin": {**MARGIN, "t": 18},
        "barmode": "overlay",
        "showlegend": False,
        "hovermode": "closest",
        "xaxis": time_axis(walk),
        "yaxis": {
            "tickvals": list(range(len(names))),
            "ticktext": [label(name) for name in names],
            "range": [len(names) - 0.5, -0.5],
            "fixedrange": True,
            "showgrid": False,
            "zeroline": False,
        },
    }
    down = ", ".join(
        f"{foot.name} {fraction:.1%}"
        for foot in walk.feet
        if (fraction := foot.record.contact_fraction()) is not None and foot.contact_known
    )
    alt = f"A bar a foot over time, filled while the foot is down. Time in contact: {down}."
    rows = [{"yref": "y", "y0": row + 0.5, "y1": row - 0.5} for row in range(len(names))]
    words = _what_bars_are(walk, drawn)
    return Drawing("gait", "Gait diagram", alt, words, data, layout, over_time=True, feet=rows)


def _stances_drawn(walk: Walk, foot: FootSteps) -> Ints:
    """(s, 2) ns, the contacts around the typical strides, as many as can be drawn."""
    spans = foot.record.in_contact
    middle = walk.origin + round(sum(default_window(walk)) / 2.0 * 1e9)
    first = int(np.searchsorted(spans[:, 0], middle)) - MOST_STANCES // 2
    first = max(0, min(first, len(spans) - MOST_STANCES))
    return spans[first : first + MOST_STANCES]


def _what_bars_are(walk: Walk, drawn: Sequence[Ints]) -> str:
    words = "Filled: the foot is down. Hatched: nothing is known of it."
    if walk.settings.contact_from:
        words = "Hatched: the foot is down, as estimated from the joints; grey: nothing is known."
    every = sum(len(foot.record.in_contact) for foot in walk.feet)
    if every > sum(map(len, drawn)):
        words += (
            f" The log has {every} stances: those around the typical strides are drawn one by one, "
            "of the others the height of the bar is the share of time in contact."
        )
    return words


_HATCHED: Final = {
    "color": translucent(NEUTRAL, 0.15),
    "pattern": {"shape": "/", "fgcolor": NEUTRAL, "size": 6, "solidity": 0.2},
    "line": {"width": 0},
}


def _filling(walk: Walk, row: int) -> dict[str, Any]:
    colour = foot_colour(row)
    pale = translucent(colour, 0.3)
    pattern = {"shape": "\\", "fgcolor": colour, "bgcolor": pale, "size": 6}
    hatching = {"pattern": pattern} if walk.settings.contact_from else {}
    return {"color": colour, "line": {"width": 0}, **hatching}


def _bars(
    walk: Walk, foot: FootSteps, spans: Ints, row: int, marker: dict[str, Any], what: str
) -> Trace:
    start, end = seconds(walk, spans[:, 0]), seconds(walk, spans[:, 1])
    return {
        "type": "bar",
        "orientation": "h",
        "base": start,
        "x": end - start,
        "y": np.full(len(spans), row, np.int16),
        "width": _BAR,
        "marker": marker,
        "name": label(foot.name),
        # Plotly's own x is where a bar ends, not how long it is.
        "customdata": np.stack([end - start, end], axis=1),
        "hovertemplate": f"{what} for %{{customdata[0]:.3f}} s<br>"
        "from %{base:.3f} to %{customdata[1]:.3f} s",
    }


def _contact_share(walk: Walk, foot: FootSteps, drawn: Ints, row: int) -> Trace:
    edges = np.linspace(walk.origin, walk.end, _SHARE_BINS + 1).astype(np.int64)
    known = timespans.covered(foot.record.known, edges)
    down = timespans.covered(foot.record.in_contact, edges)
    share = np.divide(down, known, out=np.zeros(_SHARE_BINS), where=known > 0)
    share[(edges[1:] > drawn[0, 0]) & (edges[:-1] < drawn[-1, 1])] = 0.0
    floor = row + _BAR / 2.0
    at = np.repeat(seconds(walk, edges), 2)[1:-1]
    x = np.concatenate([at, at[[-1, 0]]])
    y = np.concatenate([floor - _BAR * np.repeat(share, 2), [floor, floor]])
    return area(x, y, label(foot.name), foot_colour(row), 0.5)


def load_curves(walk: Walk) -> Drawing | None:
    """Draw the load of each foot, one above the other on one scale; None without feet."""
    if not walk.feet:
        return None
    lines = [_loads(walk, foot, row) for row, foot in enumerate(walk.feet)]
    drawn = np.concatenate([[0.0, 1.0], *(each.curve.value for pair in lines for each in pair)])
    low, high = min(0.0, 1.05 * np.nanmin(drawn)), 1.05 * np.nanmax(drawn)
    rows = []
    names = short_names([foot.name for foot in walk.feet])
    for row, (foot, pair) in enumerate(zip(walk.feet, lines, strict=True)):
        start, end = seconds(walk, _stances_drawn(walk, foot)).T
        nothing = np.full(len(start), np.nan)
        corners = np.stack([start, start, end, end, nothing], axis=1).ravel()
        edges = np.tile([low, high, high, low, np.nan], len(start))
        shading = area(corners, edges, label(foot.name), foot_colour(row), 0.15)
        traces = [(0, each) for each in (shading, *(each.trace for each in pair))]
        rows.append(Row(f"{names[row]} (N)", traces, (low, high)))
    peaks = [
        f"{foot.name} {np.nanmax(pair[0].curve.value):.1f} N"
        for foot, pair in zip(walk.feet, lines, strict=True)
        if pair
    ]
    alt = f"The force of each foot over time. Highest: {', '.join(peaks) or NOTHING}."
    words = "The sensors tell contact, not force. Shaded: stance."
    if peaks:
        words = "Line: |F|; dotted: its vertical part, where known; shaded: stance."
        bin_s = max(each.curve.bin_s for pair in lines for each in pair)
        words += _LEFT_OUT.format(bin_s * 1e3) if bin_s else ""
    feet = [{"yref": f"y{row + 1} domain", "y0": 0.0, "y1": 1.0} for row in range(len(rows))]
    drawn_rows = grid(rows, time_axis(walk), ROW_PIXELS)
    return Drawing("loads", "Loads", alt, words, *drawn_rows, over_time=True, feet=feet)


def _loads(walk: Walk, foot: FootSteps, row: int) -> list[Line]:
    """Return |F| and its vertical part, as far as they are known."""
    if not foot.record.has_force:
        return []
    track, gaps, name = foot.record.track, foot.record.gaps, label(foot.name)
    weight = walk.loads.weight_n
    hover = "%{y:.1f} N" + ("" if weight is None else " (%{customdata:.2f} BW)")
    # The page divides the forces by the weight.
    meta = {} if weight is None else {"meta": {"weight": weight}}
    # The whole force is drawn over its vertical part, but named before it.
    styles = {"color": foot_colour(row)}, {"color": NEUTRAL, "width": 1.0, "dash": "dot"}
    lines = (
        line_over_time(walk, f"{name} {what}", (track.time, force), gaps, hover, style, more)
        for what, force, style, more in (
            ("|F|", track.force, styles[0], {"zorder": 1, **meta}),
            ("vertical", track.vertical_force, styles[1], meta),
        )
    )
    return [each for each in lines if each is not None]
