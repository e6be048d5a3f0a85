"""A layout for Foxglove and Lichtblick: the robot beside load curves, gait diagram and events."""

from collections.abc import Sequence
from typing import Any, Final

from dogbot_logtool.core.scene.foot_style import foot_colour
from dogbot_logtool.report.layouts.view import View
from dogbot_logtool.writer.annotations import (
    SUPPORT_TOPIC,
    arrow_topic,
    label_topic,
    load_topic,
)
from dogbot_logtool.writer.robot_description import ROBOT_DESCRIPTION_TOPIC

EVENTS_TOPIC: Final = "/events"
_ASIDE_DEG: Final = 40.0
"""The camera looks at the robot's front from this much to its right."""
_GAIT_ROWS, _LOG_ROWS = 1.6, 1.0
"""Heights of the gait diagram and of the events, in those of a curve."""

Node = str | dict[str, Any]


def foxglove_layout(view: View) -> dict[str, Any]:
    """Return a layout: the robot followed in 3D beside a load curve a foot, gait and events."""
    curves = {f"Plot!load{row}": _load(view, row) for row in range(len(view.feet))}
    below = {"StateTransitions!gait": _gait(view.feet), "RosOut!events": _events()}
    heights = [1.0] * len(curves) + [_GAIT_ROWS, _LOG_ROWS]
    return {
        "configById": {"3D!robot": _scene(view), **curves, **below},
        "globalVariables": {},
        "userNodes": {},
        "playbackConfig": {"speed": 0.5},
        "layout": {
            "direction": "row",
            "first": "3D!robot",
            "second": _stacked([*curves, *below], heights),
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
    topics = (*drawn, SUPPORT_TOPIC, ROBOT_DESCRIPTION_TOPIC)
    return {
        **_titled("Robot"),
        "cameraState": {
            "perspective": True,
            "distance": 1.8,
            "phi": 68,
            # The camera stands at -90 degrees minus this.
            "thetaOffset": (_ASIDE_DEG - view.heading_deg - 90.0) % 360.0,
            "targetOffset": [0, 0, 0],
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
                "enablePreloading": True,
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


def _load(view: View, row: int) -> dict[str, Any]:
    # The whole log, as in the gait diagram: a view that follows the time is empty at the start.
    foot = view.feet[row]
    return {
        **_titled(f"{foot} [N]"),
        "paths": [
            {
                "value": f"{load_topic(foot)}.force",
                "enabled": True,
                "timestampMethod": "receiveTime",
                "label": foot,
                "color": foot_colour(row),
                "showLine": True,
            }
        ],
        "minYValue": 0,
        "showXAxisLabels": row == len(view.feet) - 1,
        "showYAxisLabels": True,
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
