"""A view for RViz of ROS 1: robot, arrows, labels and support, the base followed."""

from math import radians
from typing import Any, Final

from dogbot_logtool.report.layouts.view import View
from dogbot_logtool.writer.topics import LEGS_TOPIC, SUPPORT_TOPIC, arrow_topic, label_topic

_WINDOW: Final = {
    "Width": 1280,
    "Height": 720,
    "X": 0,
    "Y": 0,
    "Hide Left Dock": True,
    "Displays": {"collapsed": True},
}
"""Pixels: without them RViz opens a window too small to see anything in. Without the last two, its
list of displays covers the robot."""


def rviz_config(view: View) -> dict[str, Any]:
    """Return the content of a ``.rviz`` file, which is YAML.

    RViz takes the robot from the parameter ``robot_description``, not from the topic.
    """
    topics = [topic(foot) for foot in view.feet for topic in (arrow_topic, label_topic)]
    topics.append(LEGS_TOPIC)
    return {
        "Panels": [{"Class": "rviz/Displays", "Name": "Displays"}],
        "Visualization Manager": {
            "Class": "",
            "Enabled": True,
            "Displays": [
                _grid(view),
                {
                    "Class": "rviz/RobotModel",
                    "Name": "Robot",
                    "Enabled": True,
                    "Robot Description": "robot_description",
                    "Collision Enabled": False,
                    "Visual Enabled": True,
                },
                *(_markers("Marker", topic) for topic in topics),
                _markers("MarkerArray", SUPPORT_TOPIC),
            ],
            "Global Options": {
                "Background Color": "48; 48; 48",
                "Fixed Frame": view.world_frame,
                "Frame Rate": 30,
            },
            "Tools": [{"Class": "rviz/MoveCamera"}, {"Class": "rviz/Measure"}],
            "Views": {"Current": _camera(view)},
        },
        "Window Geometry": _WINDOW,
    }


def _grid(view: View) -> dict[str, Any]:
    return {
        "Class": "rviz/Grid",
        "Name": "Ground",
        "Enabled": True,
        "Alpha": 0.3,
        "Cell Size": 0.5,
        "Color": "160; 160; 164",
        "Plane": "XY",
        "Plane Cell Count": 80,
        "Reference Frame": view.world_frame,
    }


def _markers(kind: str, topic: str) -> dict[str, Any]:
    return {
        "Class": f"rviz/{kind}",
        "Name": topic,
        "Enabled": True,
        "Marker Topic": topic,
        "Queue Size": 100,
    }


def _camera(view: View) -> dict[str, Any]:
    return {
        "Class": "rviz/Orbit",
        "Name": "Robot",
        "Target Frame": view.base_frame,
        "Distance": round(4.4 * view.size_m, 2),
        "Pitch": 0.35,
        "Yaw": round(radians(view.camera_in_world_deg), 4),
        "Focal Point": {"X": 0, "Y": 0, "Z": 0},
    }
