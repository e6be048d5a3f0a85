"""The walk from above: path and heading of the base, footfalls, centre of pressure."""

from collections.abc import Sequence
from typing import Any, Final

import numpy as np

from dogbot_logtool.core.arrays import Floats, Ints, distinct
from dogbot_logtool.core.gait.feet import FootSteps
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.report.page.chart import (
    MARGIN,
    NEUTRAL,
    SECOND,
    Drawing,
    Trace,
    foot_marker,
    label,
    line,
    seconds,
    thinned,
)

MOST_POINTS: Final = 2500
"""Points of a path."""
MOST_FOOTPRINTS: Final = 400
"""Touchdowns of a foot."""
HEADINGS: Final = 12
"""Arrows along the path."""
_AT: Final = "x %{x:.3f} m, y %{y:.3f} m<br>at %{customdata:.3f} s"


def walk_from_above(walk: Walk) -> Drawing | None:
    """Draw the ground; None without odometry and contact points."""
    prints = [_footprints(foot) for foot in walk.feet]
    has_base = len(walk.base_history.time) > 0
    if not has_base and not any(len(time) for time, _ in prints):
        return None
    data = [_path(walk)] if has_base else []
    centre = walk.instants
    if centre is not None and walk.vertical_known:
        rows = thinned(len(centre.time), MOST_POINTS)
        x, y = centre.pressure[rows].T
        at = seconds(walk, centre.time[rows])
        words = {"customdata": at, "hovertemplate": _AT}
        data.append(line(x, y, "centre of pressure", {"color": SECOND, "width": 1.2}, words))
    for row, (foot, (time, place)) in enumerate(zip(walk.feet, prints, strict=True)):
        if len(time):
            rows = thinned(len(time), MOST_FOOTPRINTS)
            look = {"marker": foot_marker(walk, row), "hovertemplate": f"footfall at {_AT}"}
            at = seconds(walk, time[rows])
            data.append(_markers(place[rows], at, label(foot.name), **look))
    if has_base:
        data += [_headings(walk), _ends(walk)]
    title = {"zeroline": False, "showspikes": False}
    layout = {
        "height": 480,
        "margin": MARGIN,
        "hovermode": "closest",
        "legend": {"orientation": "h", "y": 1.0, "yanchor": "bottom", "x": 0},
        "dragmode": "pan",
        "xaxis": {"title": {"text": "x (m)", "standoff": 6}, **title},
        "yaxis": {
            "title": {"text": "y (m)", "standoff": 2},
            "scaleanchor": "x",
            "scaleratio": 1,
            **title,
        },
    }
    return Drawing("ground", "From above", _words(walk), _caption(prints), data, layout)


def _path(walk: Walk) -> Trace:
    base = walk.base_history
    rows = thinned(len(base.time), MOST_POINTS)
    time = base.time[rows]
    breaks: Ints = distinct(np.searchsorted(time, base.gaps[:, 1]))
    breaks = breaks[(breaks > 0) & (breaks < len(time))]
    x, y, at = (
        np.insert(each, breaks, np.nan)
        for each in (*base.position[rows, :2].T, seconds(walk, time))
    )
    more = {"customdata": at, "hovertemplate": _AT}
    return line(x, y, "base", {"color": NEUTRAL, "width": 3}, more)


def _markers(point: Floats, at: Floats, name: str, **look: Any) -> Trace:  # noqa: ANN401 - Plotly's
    x, y = point.T
    return {"type": "scatter", "mode": "markers", "x": x, "y": y, "name": name,
            "customdata": at, **look}  # fmt: skip


def _headings(walk: Walk) -> Trace:
    base = walk.base_history
    rows = thinned(len(base.time), HEADINGS)
    heading = np.degrees(base.angles[rows, 2] + walk.settings.forward_rad)
    marker = {
        "symbol": "arrow-wide",
        "angleref": "up",
        "angle": np.round(90.0 - heading, 3),
        "size": 13,
        "color": NEUTRAL,
    }
    at = np.stack([seconds(walk, base.time[rows]), heading], axis=1)
    words = "heading %{customdata[1]:.1f} deg from +x<br>at %{customdata[0]:.3f} s"
    return _markers(base.position[rows, :2], at, "heading", marker=marker, hovertemplate=words)


def _ends(walk: Walk) -> Trace:
    base = walk.base_history
    at = seconds(walk, base.time[[0, -1]])
    words = {"text": ["<b>start</b>", "<b>end</b>"], "textposition": ["bottom right", "top left"]}
    look = {"mode": "text", **words, "showlegend": False, "hovertemplate": _AT}
    return _markers(base.position[[0, -1], :2], at, "", **look)


def _words(walk: Walk) -> str:
    base = walk.base
    if base is None or base.path_length_m is None:
        return "The footfalls seen from above; the base's path is not known."
    return (
        f"The walk seen from above: a path of {base.path_length_m:.2f} m that ends "
        f"{base.net_displacement_m:.2f} m from where it began, turning "
        f"{base.yaw_change_rad:.2f} rad."
    )


def _footprints(foot: FootSteps) -> tuple[Ints, Floats]:
    """Return when, (k,) ns, and where, (k, 2) m, a foot stands."""
    known = np.isfinite(foot.stood.position[:, 0])
    return foot.stood.time[known], foot.stood.position[known, :2]


def _caption(prints: Sequence[tuple[Ints, Floats]]) -> str:
    words = (
        "Arrows: where the robot heads. Markers: footfalls, each in its foot's colour and shape, "
        "hollow for hind feet."
    )
    count = sum(len(time) for time, _ in prints)
    drawn = sum(min(len(time), MOST_FOOTPRINTS) for time, _ in prints)
    if drawn < count:
        words += f" {drawn} of {count} footfalls are drawn, evenly spaced."
    return words
