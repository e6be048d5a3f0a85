"""The walk from above: path and heading of the base, footfalls, centre of pressure."""

from typing import Any, Final

import numpy as np

from dogbot_logtool.core.arrays import Floats, Ints, distinct
from dogbot_logtool.core.base.motion import FORWARD_ANGLES
from dogbot_logtool.core.stability import GroundPoints, footprints, pressure_path
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.report.page.charts.drawing import (
    MARGIN,
    NEUTRAL,
    SECOND,
    Chart,
    Drawing,
    Trace,
    drawn_metres,
    drawn_seconds,
    foot_marker,
    label,
    scatter,
    thinned,
)

MOST_POINTS: Final = 2500
"""Points of a path."""
MOST_FOOTPRINTS: Final = 400
"""Touchdowns of a foot."""
HEADINGS: Final = 12
"""Arrows along the path."""
_AT: Final = "x %{x:.3f} m, y %{y:.3f} m<br>at %{customdata:.3f} s"


def walk_from_above(stats: Walk) -> Drawing | None:
    """Draw the ground; None without odometry and contact points."""
    prints = [footprints(foot.record) for foot in stats.feet]
    base = stats.base_history
    if len(base.time) == 0 and not any(len(each.time) for each in prints):
        return None
    figure = Chart()
    rows = thinned(len(base.time), MOST_POINTS)
    if len(rows):
        figure.data.append(_path(stats, rows))
    centre = _centre_of_pressure(stats)
    if centre is not None:
        figure.data.append(centre)
    for row, (foot, points) in enumerate(zip(stats.feet, prints, strict=True)):
        if len(points.time):
            figure.data.append(_footprints(stats, label(foot.name), points, row))
    if len(rows):
        figure.data.append(_headings(stats))
        figure.data.append(_ends(stats))
    figure.layout.update(
        height=480,
        margin=MARGIN,
        hovermode="closest",
        legend={"orientation": "h", "y": 1.0, "yanchor": "bottom", "x": 0},
        dragmode="pan",
        xaxis={
            "title": {"text": "x (m)", "standoff": 6},
            "zeroline": False,
            "showspikes": False,
        },
        yaxis={
            "title": {"text": "y (m)", "standoff": 2},
            "scaleanchor": "x",
            "scaleratio": 1,
            "zeroline": False,
            "showspikes": False,
        },
    )
    return Drawing("ground", "From above", _words(stats), _caption(prints), figure)


def _broken(time: Ints, gaps: Ints) -> Ints:
    """Return the rows before which a line is to be broken."""
    return distinct(np.searchsorted(time, gaps[:, 1]))


def _path(stats: Walk, rows: Ints) -> Trace:
    base = stats.base_history
    time, position = base.time[rows], drawn_metres(base.position[rows, :2])
    at = _broken(time, base.gaps)
    at = at[(at > 0) & (at < len(time))]
    return scatter(
        x=np.insert(position[:, 0], at, np.nan),
        y=np.insert(position[:, 1], at, np.nan),
        customdata=np.insert(drawn_seconds(stats, time), at, np.nan),
        mode="lines",
        line={"color": NEUTRAL, "width": 3},
        name="base",
        hovertemplate=_AT,
    )


def _centre_of_pressure(stats: Walk) -> Trace | None:
    if stats.stability is None or stats.stability.centre_of_pressure_forward_m is None:
        return None
    centre = pressure_path([foot.record for foot in stats.feet])
    rows = thinned(len(centre.time), MOST_POINTS)
    return scatter(
        x=drawn_metres(centre.point[rows, 0]),
        y=drawn_metres(centre.point[rows, 1]),
        customdata=drawn_seconds(stats, centre.time[rows]),
        mode="lines",
        line={"color": SECOND, "width": 1.2},
        name="centre of pressure",
        hovertemplate=_AT,
    )


def _footprints(stats: Walk, name: str, points: GroundPoints, row: int) -> Trace:
    rows = thinned(len(points.time), MOST_FOOTPRINTS)
    return scatter(
        x=points.point[rows, 0],
        y=points.point[rows, 1],
        customdata=drawn_seconds(stats, points.time[rows]),
        mode="markers",
        marker=foot_marker(stats, row),
        name=name,
        hovertemplate="footfall at " + _AT,
    )


def _headings(stats: Walk) -> Trace:
    base = stats.base_history
    rows = thinned(len(base.time), HEADINGS)
    heading: Floats = base.angles[rows, 2] + FORWARD_ANGLES[stats.settings.forward_axis]
    marker: dict[str, Any] = {
        "symbol": "arrow-wide",
        "angleref": "up",
        "angle": np.round(90.0 - np.degrees(heading), 3),
        "size": 13,
        "color": NEUTRAL,
    }
    return scatter(
        x=base.position[rows, 0],
        y=base.position[rows, 1],
        customdata=np.stack([drawn_seconds(stats, base.time[rows]), np.degrees(heading)], axis=1),
        mode="markers",
        marker=marker,
        name="heading",
        hovertemplate="heading %{customdata[1]:.1f} deg from +x<br>at %{customdata[0]:.3f} s",
    )


def _ends(stats: Walk) -> Trace:
    base = stats.base_history
    return scatter(
        x=base.position[[0, -1], 0],
        y=base.position[[0, -1], 1],
        customdata=drawn_seconds(stats, base.time[[0, -1]]),
        mode="text",
        text=["<b>start</b>", "<b>end</b>"],
        textposition=["bottom right", "top left"],
        showlegend=False,
        hovertemplate=_AT,
    )


def _words(stats: Walk) -> str:
    base = stats.base
    if base is None or base.path_length_m is None:
        return "The footfalls seen from above; the base's path is not known."
    return (
        f"The walk seen from above: a path of {base.path_length_m:.2f} m that ends "
        f"{base.net_displacement_m:.2f} m from where it began, turning "
        f"{base.yaw_change_rad:.2f} rad."
    )


def _caption(prints: list[GroundPoints]) -> str:
    words = (
        "Arrows: where the robot heads. Markers: footfalls, each in its foot's colour and shape, "
        "hollow for hind feet."
    )
    count = sum(len(each.time) for each in prints)
    shown = sum(len(thinned(len(each.time), MOST_FOOTPRINTS)) for each in prints)
    if shown < count:
        words += f" {shown} of {count} footfalls are drawn, evenly spaced."
    return words
