"""The two figures over time: when each foot is down, and what it carries."""

from typing import Any, Final

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.core.contact.curves import Curve
from dogbot_logtool.core.gait.feet import FootSteps
from dogbot_logtool.core.scene.foot_style import foot_colour, short_names
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.report.numbers import NOTHING, decimal, percent
from dogbot_logtool.report.page.charts.drawing import (
    MARGIN,
    NEUTRAL,
    Chart,
    Drawing,
    Trace,
    bars,
    drawn_seconds,
    label,
    scatter,
    seconds,
    time_axis,
    translucent,
)
from dogbot_logtool.report.text.gait_diagram import default_window

MOST_STANCES: Final = 200
"""Stances of a foot that are drawn one by one."""
SHARE_BINS: Final = 2000
"""Bins of the share of contact in the rest of a long log."""
_BAR: Final = 0.7
"""Height of a bar, of the distance between two feet."""


def gait_diagram(stats: Walk) -> Drawing | None:
    """Draw a bar a foot, filled where the foot is down (Hildebrand's); None without feet."""
    if not stats.feet:
        return None
    short = short_names([foot.name for foot in stats.feet])
    figure = Chart()
    parts = [_stances_drawn(stats, foot) for foot in stats.feet]
    for row, (foot, drawn) in enumerate(zip(stats.feet, parts, strict=True)):
        figure.data.append(_unknown_bars(stats, foot, row))
        figure.data.append(_bars(stats, foot, drawn, row))
        if len(drawn) < len(foot.record.in_contact):
            figure.data.append(_contact_share(stats, foot, drawn, row))
    figure.layout.update(
        height=46 * len(stats.feet) + 72,
        # The names of the bands stand above it.
        margin={**MARGIN, "t": 18},
        barmode="overlay",
        showlegend=False,
        hovermode="closest",
        xaxis=time_axis(stats),
        yaxis={
            "tickvals": list(range(len(short))),
            "ticktext": [label(name) for name in short],
            "range": [len(short) - 0.5, -0.5],
            "fixedrange": True,
            "showgrid": False,
            "zeroline": False,
        },
    )
    down = ", ".join(
        f"{foot.name} {percent(fraction)}"
        for foot in stats.feet
        if (fraction := foot.record.contact_fraction()) is not None and foot.contact_known
    )
    return Drawing(
        "gait",
        "Gait diagram",
        f"A bar a foot over time, filled while the foot is down. Time in contact: {down}.",
        _caption(stats) + _partly(stats, parts),
        figure,
        over_time=True,
        feet=_rows(len(stats.feet), 1.0),
    )


def _rows(feet: int, height: float) -> list[tuple[float, float]]:
    """Return the lower and the upper edge of each foot's row, as shares of the figure's height."""
    return [(1.0 - (row + height) / feet, 1.0 - row / feet) for row in range(feet)]


def _partly(stats: Walk, parts: list[Ints]) -> str:
    """Say which stances are not drawn one by one."""
    shown = sum(map(len, parts))
    every = sum(len(foot.record.in_contact) for foot in stats.feet)
    if shown == every:
        return ""
    return (
        f" The log has {every} stances: those around the typical strides are drawn one by one, of "
        "the others the height of the bar is the share of time in contact."
    )


def _stances_drawn(stats: Walk, foot: FootSteps) -> Ints:
    """(s, 2) ns, the contacts around the typical strides, as many as can be drawn."""
    spans = timespans.no_spans() if foot.is_dead else foot.record.in_contact
    middle = stats.origin + round(sum(default_window(stats)) / 2.0 * 1e9)
    first = int(np.searchsorted(spans[:, 0], middle)) - MOST_STANCES // 2
    first = max(0, min(first, len(spans) - MOST_STANCES))
    return spans[first : first + MOST_STANCES]


def _caption(stats: Walk) -> str:
    if stats.settings.contact_from:
        return "Hatched: the foot is down, as estimated from the joints; grey: nothing is known."
    return "Filled: the foot is down. Hatched: nothing is known of it."


def _bars(stats: Walk, foot: FootSteps, spans: Ints, row: int) -> Trace:
    start, end = seconds(stats, spans[:, 0]), seconds(stats, spans[:, 1])
    marker: dict[str, object] = {"color": foot_colour(row), "line": {"width": 0}}
    if stats.settings.contact_from:
        colour = foot_colour(row)
        pale = translucent(colour, 0.3)
        marker["pattern"] = {"shape": "\\", "fgcolor": colour, "bgcolor": pale, "size": 6}
    return bars(
        base=start,
        x=end - start,
        y=np.full(len(spans), row, np.int16),
        width=_BAR,
        marker=marker,
        name=label(foot.name),
        customdata=np.stack([end - start, end], axis=1).astype(np.float32),
        hovertemplate="down for %{customdata[0]:.3f} s<br>"
        "from %{base:.3f} to %{customdata[1]:.3f} s",
    )


def _unknown_bars(stats: Walk, foot: FootSteps, row: int) -> Trace:
    known = timespans.no_spans() if foot.is_dead else foot.record.known
    everything = np.array([[stats.origin, stats.end]], np.int64)
    spans = timespans.subtract(everything, known)
    start = seconds(stats, spans[:, 0])
    length = seconds(stats, spans[:, 1]) - start
    return bars(
        base=start,
        x=length,
        y=np.full(len(spans), row, np.int16),
        width=_BAR,
        marker={
            "color": translucent(NEUTRAL, 0.15),
            "pattern": {"shape": "/", "fgcolor": NEUTRAL, "size": 6, "solidity": 0.2},
            "line": {"width": 0},
        },
        name=label(foot.name),
        # Plotly's own x is where a bar ends, not how long it is.
        customdata=length,
        hovertemplate="not known for %{customdata:.3f} s<br>from %{base:.3f} s",
    )


def _contact_share(stats: Walk, foot: FootSteps, drawn: Ints, row: int) -> Trace:
    edges = np.linspace(stats.origin, stats.end, SHARE_BINS + 1).astype(np.int64)
    known = timespans.covered(foot.record.known, edges)
    share = np.full(SHARE_BINS, np.nan)
    down = timespans.covered(foot.record.in_contact, edges)
    share[known > 0] = down[known > 0] / known[known > 0]
    share[(edges[1:] > drawn[0, 0]) & (edges[:-1] < drawn[-1, 1])] = 0.0
    floor = row + _BAR / 2.0
    at = np.repeat(drawn_seconds(stats, edges), 2)[1:-1]
    height = np.repeat(np.nan_to_num(share), 2)
    return scatter(
        x=np.concatenate([at, at[[-1, 0]]]),
        y=np.concatenate([floor - _BAR * height, [floor, floor]]).astype(np.float32),
        mode="lines",
        line={"width": 0},
        fill="toself",
        fillcolor=translucent(foot_colour(row), 0.5),
        hoverinfo="skip",
        name=label(foot.name),
    )


def load_curves(stats: Walk) -> Drawing | None:
    """Draw the load of each foot, one above the other on one scale; None without feet."""
    if not stats.feet:
        return None
    short = short_names([foot.name for foot in stats.feet])
    low, high = _extent(stats)
    figure = Chart()
    for row, foot in enumerate(stats.feet):
        axis = f"y{row + 1}" if row else "y"
        for trace in _load_traces(stats, foot, row, (low, high)):
            figure.data.append({**trace, "xaxis": "x", "yaxis": axis})
    rows = len(stats.feet)
    edges = _rows(rows, 0.88)
    axes: dict[str, Any] = {
        f"yaxis{row + 1 if row else ''}": {
            "domain": edges[row],
            "range": [low, high],
            "fixedrange": True,
            "nticks": 4,
            "title": {"text": f"{label(name)} (N)", "standoff": 2},
            "zeroline": True,
        }
        for row, name in enumerate(short)
    }
    figure.layout.update(
        height=100 * rows + 50,
        margin=MARGIN,
        showlegend=False,
        hovermode="x unified",
        hoversubplots="axis",
        xaxis={**time_axis(stats), "anchor": f"y{rows}" if rows > 1 else "y"},
        **axes,
    )
    words = _peaks(stats), _what_is_drawn(stats)
    return Drawing("loads", "Loads", *words, figure, over_time=True, feet=edges)


def _extent(stats: Walk) -> tuple[float, float]:
    """Range of all feet's forces, N."""
    drawn = [curve for foot in stats.feet for curve in _curves(foot)]
    low = min((float(curve.value.min()) for curve in drawn), default=0.0)
    high = max((float(curve.value.max()) for curve in drawn), default=1.0)
    return min(0.0, 1.05 * low), max(1.05 * high, 1.0)


def _curves(foot: FootSteps) -> list[Curve]:
    curves = foot.record.curves
    return [each for each in (curves.force, curves.vertical) if each] if curves else []


def _load_traces(
    stats: Walk, foot: FootSteps, row: int, extent: tuple[float, float]
) -> list[Trace]:
    curves, colour = foot.record.curves, foot_colour(row)
    traces = [_shading(stats, _stances_drawn(stats, foot), colour, extent)]
    if curves is None or curves.force is None:
        return traces
    gaps = foot.record.gaps
    line: dict[str, Any] = {"color": colour, "width": 1.5}
    traces.append(_line(stats, curves.force, gaps, f"{label(foot.name)} |F|", line))
    if curves.vertical is not None:
        unknown = timespans.merge(np.concatenate([gaps, foot.record.track.vertical_unknown]))
        line = {"color": NEUTRAL, "width": 1, "dash": "dot"}
        name = f"{label(foot.name)} vertical"
        traces.append(_line(stats, curves.vertical, unknown, name, line))
    return traces


def _line(stats: Walk, curve: Curve, breaks: Ints, name: str, line: dict[str, Any]) -> Trace:
    time, force = curve.line(breaks)
    weight = stats.loads.weight_n
    return scatter(
        x=drawn_seconds(stats, time),
        y=force.astype(np.float32),
        mode="lines",
        line=line,
        # The whole force is drawn over its vertical part, but named before it.
        zorder=0 if line.get("dash") else 1,
        name=name,
        # The page divides the forces by it.
        meta={} if weight is None else {"weight": weight},
        hovertemplate="%{y:.1f} N" + ("" if weight is None else " (%{customdata:.2f} BW)"),
    )


def _shading(stats: Walk, spans: Ints, colour: str, extent: tuple[float, float]) -> Trace:
    start, end = (drawn_seconds(stats, each) for each in spans.T)
    nothing = np.full(len(spans), np.nan, np.float32)
    low, high = (np.full(len(spans), each) for each in extent)
    return scatter(
        x=np.stack([start, start, end, end, nothing], axis=1).ravel(),
        y=np.stack([low, high, high, low, nothing], axis=1).ravel().astype(np.float32),
        mode="lines",
        line={"width": 0},
        fill="toself",
        fillcolor=translucent(colour, 0.15),
        hoverinfo="skip",
    )


def _peaks(stats: Walk) -> str:
    peaks = [
        f"{foot.name} {decimal(float(curves.force.value.max()), 1)} N"
        for foot in stats.feet
        if (curves := foot.record.curves) and curves.force
    ]
    return f"The force of each foot over time. Highest: {', '.join(peaks) or NOTHING}."


def _what_is_drawn(stats: Walk) -> str:
    words = "Line: |F|; dotted: its vertical part, where known; shaded: stance."
    bins = [curves.bin_ns for foot in stats.feet if (curves := foot.record.curves)]
    if not bins:
        return "The sensors tell contact, not force. Shaded: stance."
    if max(bins) > 1:
        words += (
            f" Of every {max(bins) / 1e6:.3g} ms the lowest and the highest sample are drawn, so "
            "every peak is there; the typical strides are drawn in full, and so is a short part "
            "that --start and --end choose."
        )
    return words
