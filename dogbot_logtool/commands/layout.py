"""`dogbot-logtool layout`: a Foxglove layout in which an annotated walk shows at once."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from dogbot_logtool.pipeline.annotated import open_recorded
from dogbot_logtool.pipeline.feet.selection import assign_feet
from dogbot_logtool.pipeline.options import ConvertOptions, TopicOptions
from dogbot_logtool.pipeline.plan import make_plan
from dogbot_logtool.pipeline.probe import DEFAULT_BASE, DEFAULT_WORLD, look_into
from dogbot_logtool.pipeline.selection import select_topics
from dogbot_logtool.report.foot_pens import foot_colour
from dogbot_logtool.robot import load_robot
from dogbot_logtool.writer.annotations import SUPPORT_TOPIC, arrow_topic, load_topic


def foxglove_layout(feet: Sequence[str], world_frame: str, base_frame: str) -> dict[str, Any]:
    """Return a layout: the robot followed in 3D beside load curves and a gait diagram.

    Args:
        feet: names of the feet.
        world_frame: the frame in which the ground is.
        base_frame: the frame to follow.
    """
    return {
        "configById": {
            "3D!robot": _scene(feet, world_frame, base_frame),
            "Plot!load": _loads(feet),
            "StateTransitions!gait": _gait(feet),
        },
        "globalVariables": {},
        "userNodes": {},
        "playbackConfig": {"speed": 0.5},
        "layout": {
            "direction": "row",
            "first": "3D!robot",
            "second": {
                "direction": "column",
                "first": "Plot!load",
                "second": "StateTransitions!gait",
                "splitPercentage": 55,
            },
            "splitPercentage": 45,
        },
    }


def _scene(feet: Sequence[str], world_frame: str, base_frame: str) -> dict[str, Any]:
    return {
        "foxglovePanelTitle": "Robot",
        "cameraState": {
            "perspective": True,
            "distance": 2.4,
            "phi": 65,
            "thetaOffset": 45,
            "targetOffset": [0, 0, 0],
            "target": [0, 0, 0],
            "targetOrientation": [0, 0, 0, 1],
            "fovy": 45,
            "near": 0.01,
            "far": 5000,
        },
        # The camera goes along but does not turn, so that the body's pitch and roll are seen.
        "followMode": "follow-position",
        "followTf": base_frame,
        # A frame's name is drawn 0.2 m high by default: those of a robot's legs hide the robot.
        "scene": {
            "transforms": {"enablePreloading": True, "showLabel": False, "axisScale": 0.4},
        },
        "transforms": {},
        "topics": {topic: {"visible": True} for topic in (*map(arrow_topic, feet), SUPPORT_TOPIC)},
        "layers": {
            "grid": {
                "layerId": "foxglove.Grid",
                "instanceId": "grid",
                "label": "Ground",
                "visible": True,
                "frameLocked": True,
                # Without a frame the grid goes along with the robot.
                "frameId": world_frame,
                "size": 40,
                "divisions": 80,
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
    # The whole log, as in the gait diagram: a view that follows the time is empty at the start.
    return {
        "foxglovePanelTitle": "Load [N]",
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
        "showLegend": True,
        "legendDisplay": "left",
        "isSynced": True,
        "xAxisVal": "timestamp",
        "sidebarDimension": 130,
    }


def _gait(feet: Sequence[str]) -> dict[str, Any]:
    return {
        "foxglovePanelTitle": "Gait diagram",
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
        topics, guessed = options.foot_topics or {}, options.robot is None
        robot = assign_feet(robot, topics, frozenset(), guessed=guessed)
        feet = [foot.name for foot in robot.feet]
        world, base = robot.world_frame or DEFAULT_WORLD, robot.base_frame or DEFAULT_BASE
        return foxglove_layout(feet, world, base)
    opened = open_recorded(log)
    try:
        selection = select_topics(opened, options)
        plan = make_plan(opened, selection, look_into(opened, selection), ConvertOptions())
        feet = [foot.name for foot in selection.robot.feet]
        return foxglove_layout(feet, plan.world_frame, plan.base_frame)
    finally:
        opened.close()
