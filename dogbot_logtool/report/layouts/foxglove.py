"""A layout for Foxglove and Lichtblick: robot and events beside load curves and gait diagram.

Curves and gait diagram have the same width and no labels at their left, since only then their time
axes line up: what a curve spans stands in its title.
"""

from collections.abc import Sequence
from typing import Any, Final

from dogbot_logtool.core.scene.foot_style import foot_colour
from dogbot_logtool.report.layouts.view import View
from dogbot_logtool.writer.topics import (
    EVENTS_TOPIC,
    LEGS_TOPIC,
    ROBOT_DESCRIPTION_TOPIC,
    SUPPORT_TOPIC,
    arrow_topic,
    label_topic,
    load_topic,
)

_MOST_CURVES: Final = 4
"""Panels of curves: more would be too low to read."""
_ROW, _AXIS, _TITLE, _SCREEN = 64, 30, 31, 613
"""Pixels of a row of the gait diagram, of its time axis, of a panel's title, and between the bars
of a viewer on a screen of 1280 x 720."""
_MOST_GAIT: Final = 0.55
"""Share of the height for the gait diagram; what does not fit is scrolled."""
_EVENTS_SHARE: Final = 20.0
"""Percent of the height, below the robot."""

Node = str | dict[str, Any]


def foxglove_layout(view: View) -> dict[str, Any]:
    """Return a layout: the robot followed in 3D and events beside load curves and gait diagram."""
    per_panel = max(-(-len(view.feet) // _MOST_CURVES), 1)
    rows = range(len(view.feet))
    groups = [rows[first : first + per_panel] for first in rows[::per_panel]]
    curves = {f"Plot!load{number}": _loads(view, group) for number, group in enumerate(groups)}
    panels = {**curves, "StateTransitions!gait": _gait(view.feet)}
    gait = min((_ROW * len(view.feet) + _AXIS + _TITLE) / _SCREEN, _MOST_GAIT)
    heights = [(1.0 - gait) / max(len(curves), 1)] * len(curves) + [gait]
    return {
        "configById": {"3D!robot": _scene(view), "RosOut!events": _events(), **panels},
        "globalVariables": {},
        "userNodes": {},
        "playbackConfig": {"speed": 0.5},
        "layout": {
            "direction": "row",
            "first": {
                "direction": "column",
                "first": "3D!robot",
                "second": "RosOut!events",
                "splitPercentage": 100.0 - _EVENTS_SHARE,
            },
            "second": _stacked(list(panels), heights),
            "splitPercentage": 50,
        },
    }


def _stacked(panels: Sequence[str], heights: Sequence[float]) -> Node:
    """Return panels one below the other, their heights in proportion."""
    if len(panels) == 1:
        return panels[0]
    return {
        "direction": "column",
        "first": panels[0],
        "second": _stacked(panels[1:], heights[1:]),
        "splitPercentage": round(100.0 * heights[0] / sum(heights), 2),
    }


def _titled(title: str) -> dict[str, Any]:
    """Return a panel's title under the keys that Foxglove and Lichtblick read."""
    return {"foxglovePanelTitle": title, "lichtblickPanelTitle": title}


def _scene(view: View) -> dict[str, Any]:
    drawn = [topic(foot) for foot in view.feet for topic in (arrow_topic, label_topic)]
    topics = (*drawn, SUPPORT_TOPIC, LEGS_TOPIC, ROBOT_DESCRIPTION_TOPIC)
    return {
        **_titled("Robot"),
        "cameraState": {
            "perspective": True,
            "distance": round(3.7 * view.size_m, 2),
            "phi": 66,
            # The camera stands at -90 degrees minus this.
            "thetaOffset": (-90.0 - view.camera_deg) % 360.0,
            # Arrows stand above the robot as high as its feet are below it, and more.
            "targetOffset": [0, 0, round(0.05 * view.size_m, 2)],
            "target": [0, 0, 0],
            "targetOrientation": [0, 0, 0, 1],
            "fovy": 45,
            "near": 0.01,
            "far": 5000,
        },
        # The camera goes along but does not turn, so that the body's pitch and roll are seen.
        "followMode": "follow-position",
        "followTf": view.base_frame,
        "scene": {
            # Axes, lines and names of frames would hide the robot.
            "transforms": {
                # Without stamps, transforms read ahead would take the place of the present ones.
                "enablePreloading": view.has_stamps,
                "showLabel": False,
                "axisScale": 0,
                "lineWidth": 0,
            },
        },
        "transforms": {
            f"frame:{frame}": {"visible": False} for frame in (view.world_frame, view.base_frame)
        },
        "topics": {topic: {"visible": True} for topic in topics},
        "layers": {
            "grid": {
                "layerId": "foxglove.Grid",
                "instanceId": "grid",
                "label": "Ground",
                "visible": True,
                "frameLocked": True,
                # Without a frame the grid goes along with the robot.
                "frameId": view.world_frame,
                "size": 40,
                "divisions": 80,
                "lineWidth": 1,
                "color": "#88888840",
                "position": [0, 0, 0],
                "rotation": [0, 0, 0],
                "order": 1,
            }
        },
        "publish": {"type": "point"},
        "imageMode": {},
    }


def _loads(view: View, rows: range) -> dict[str, Any]:
    # The whole log, as in the gait diagram: a view that follows the time is empty at the start.
    names = ", ".join(view.feet[row] for row in rows)
    unit = "[N]" if view.peak_n is None else f"0 to {view.peak_n:g} N"
    bound = {} if view.peak_n is None else {"maxYValue": view.peak_n}
    return {
        **_titled(f"{names}  {unit}"),
        "paths": [
            {
                "value": f"{load_topic(view.feet[row])}.force",
                "enabled": True,
                "timestampMethod": "receiveTime",
                "label": view.feet[row],
                "color": foot_colour(row),
                "showLine": True,
            }
            for row in rows
        ],
        "minYValue": 0,
        **bound,
        "showXAxisLabels": False,
        "showYAxisLabels": False,
        "showLegend": False,
        "legendDisplay": "none",
        "isSynced": True,
        "xAxisVal": "timestamp",
        "sidebarDimension": 0,
    }


def _gait(feet: Sequence[str]) -> dict[str, Any]:
    return {
        **_titled("Gait diagram"),
        "paths": [
            {
                "value": f"{load_topic(foot)}.state",
                "label": foot,
                "enabled": True,
                "timestampMethod": "receiveTime",
            }
            for foot in feet
        ],
        "isSynced": True,
    }


def _events() -> dict[str, Any]:
    return {
        **_titled("Events"),
        "searchTerms": [],
        "minLogLevel": 1,
        "topicToRender": EVENTS_TOPIC,
    }
