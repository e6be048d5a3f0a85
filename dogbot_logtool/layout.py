"""`dogbot-logtool layout`: a Foxglove layout in which an annotated walk shows at once."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from dogbot_logtool.evidence import look_into
from dogbot_logtool.plan import DEFAULT_BASE, ConvertOptions, make_plan
from dogbot_logtool.reader.opening import open_log
from dogbot_logtool.report.foot_pens import foot_colour
from dogbot_logtool.robot import load_robot
from dogbot_logtool.selection import TopicOptions, select_topics
from dogbot_logtool.writer.annotations import SUPPORT_TOPIC, arrow_topic, load_topic


def foxglove_layout(feet: Sequence[str], base_frame: str) -> dict[str, Any]:
    """Return a layout: the robot followed in 3D above load curves and a gait diagram.

    Args:
        feet: names of the feet.
        base_frame: the frame to follow.
    """
    return {
        "configById": {
            "3D!robot": _scene(feet, base_frame),
            "Plot!load": _loads(feet),
            "StateTransitions!gait": _gait(feet),
        },
        "globalVariables": {},
        "userNodes": {},
        "playbackConfig": {"speed": 0.5},
        "layout": {
            "direction": "column",
            "first": "3D!robot",
            "second": {
                "direction": "column",
                "first": "Plot!load",
                "second": "StateTransitions!gait",
                "splitPercentage": 60,
            },
            "splitPercentage": 60,
        },
    }


def _scene(feet: Sequence[str], base_frame: str) -> dict[str, Any]:
    return {
        "cameraState": {
            "perspective": True,
            "distance": 2.5,
            "phi": 65,
            "thetaOffset": 45,
            "targetOffset": [0, 0, 0],
            "target": [0, 0, 0],
            "targetOrientation": [0, 0, 0, 1],
            "fovy": 45,
            "near": 0.01,
            "far": 5000,
        },
        "followMode": "follow-pose",
        "followTf": base_frame,
        "scene": {"transforms": {"enablePreloading": True}},
        "transforms": {},
        "topics": {topic: {"visible": True} for topic in (*map(arrow_topic, feet), SUPPORT_TOPIC)},
        "layers": {
            "grid": {
                "layerId": "foxglove.Grid",
                "instanceId": "grid",
                "label": "Ground",
                "visible": True,
                "frameLocked": True,
                "size": 20,
                "divisions": 20,
                "lineWidth": 1,
                "color": "#888888ff",
                "position": [0, 0, 0],
                "rotation": [0, 0, 0],
                "order": 1,
            }
        },
        "publish": {"type": "point"},
        "imageMode": {},
    }


def _loads(feet: Sequence[str]) -> dict[str, Any]:
    return {
        "title": "Load",
        "paths": [
            {
                "value": f"{load_topic(foot)}.force",
                "enabled": True,
                "timestampMethod": "receiveTime",
                "label": foot,
                "color": foot_colour(index),
                "showLine": True,
            }
            for index, foot in enumerate(feet)
        ],
        "showXAxisLabels": True,
        "showYAxisLabels": True,
        "yAxisLabel": "force [N]",
        "showLegend": True,
        "legendDisplay": "floating",
        "isSynced": True,
        "xAxisVal": "timestamp",
        "followingViewWidth": 5,
        "sidebarDimension": 240,
    }


def _gait(feet: Sequence[str]) -> dict[str, Any]:
    return {
        "title": "Gait diagram",
        "paths": [
            {
                "value": f"{load_topic(foot)}.in_contact",
                "label": foot,
                "enabled": True,
                "timestampMethod": "receiveTime",
            }
            for foot in feet
        ],
        "isSynced": True,
    }


def layout_for(log: Path | None, options: TopicOptions) -> dict[str, Any]:
    """Return the layout for a log's feet, or for a robot's.

    Raises:
        CallError: no such robot, log or topic.
        LogError: the log cannot be read.
    """
    if log is None:
        robot = load_robot(options.robot or "dogbot")
        feet = [foot.name for foot in robot.feet]
        feet += [name for name in options.foot_topics or {} if name not in feet]
        return foxglove_layout(feet, robot.base_frame or DEFAULT_BASE)
    opened = open_log(log)
    try:
        selection = select_topics(opened, options)
        plan = make_plan(opened, selection, look_into(opened, selection), ConvertOptions())
        return foxglove_layout([foot.name for foot in selection.robot.feet], plan.base_frame)
    finally:
        opened.close()
