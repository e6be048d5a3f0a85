"""Views of annotated logs, set up for viewers."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import floor, log10, radians
from typing import Any, Final

from dogbot_logtool.core.scene.foot_style import foot_colour
from dogbot_logtool.io.plain_json import to_json
from dogbot_logtool.reader.containers.loss import SOUND, Damage
from dogbot_logtool.writer.topics import (
    EVENTS_TOPIC,
    LEGS_TOPIC,
    ROBOT_DESCRIPTION_TOPIC,
    SUPPORT_TOPIC,
    arrow_topic,
    label_topic,
    load_topic,
)

_ASIDE_DEG: Final = 75.0
"""The camera looks at the robot's front from this much to its right: nearer to the front, a
quadruped's right fore leg hides the left hind one, which stands with it in a trot."""
_STEPS: Final = (1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0)


@dataclass(frozen=True, slots=True)
class View:
    """The robot whose annotated log is shown."""

    feet: tuple[str, ...]
    world_frame: str
    """The frame in which the ground is."""
    base_frame: str
    """The frame to follow."""
    forward_axis: str = "+x"
    """The body axis that points forward."""
    peak_n: float | None = None
    """N, upper bound of the load curves; None: not known."""
    size_m: float = 0.6
    """m, length of the body."""
    turned_deg: float = 0.0
    """Yaw of the base in the world at the log's start."""
    has_stamps: bool = True
    """Whether header stamps tell when a transform holds."""
    damage: Damage = SOUND
    """What could not be read of the log that was looked at."""

    @property
    def camera_deg(self) -> float:
        """Direction of the camera from the base, from its +x to the left: 0 to 360."""
        heading = {"+x": 0.0, "+y": 90.0, "-x": 180.0, "-y": 270.0}[self.forward_axis]
        return (heading - _ASIDE_DEG) % 360.0

    @property
    def camera_in_world_deg(self) -> float:
        """Direction of the camera from the base, from the world's +x to the left: 0 to 360."""
        return (self.camera_deg + self.turned_deg) % 360.0


def upper_bound(value: float) -> float:
    """Return a round number that is at least a positive one, and hardly more."""
    power = 10.0 ** floor(log10(value))
    return next(power * step for step in _STEPS if power * step >= value * (1.0 - 1e-9))


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


@dataclass(frozen=True, slots=True)
class Viewer:
    """One viewer."""

    name: str
    summary: str
    suffix: str
    """Suffix of its files."""
    layout: Callable[[View], bytes]
    """Returns the content of its file."""


def _foxglove(view: View) -> bytes:
    return _json(foxglove_layout(view))


def _rviz(view: View) -> bytes:
    # JSON is YAML, too.
    return _json(rviz_config(view))


def _json(layout: dict[str, Any]) -> bytes:
    return (to_json(layout, indent=2) + "\n").encode()


_VIEWERS: Final = (
    Viewer("foxglove", "Foxglove and Lichtblick", ".json", _foxglove),
    Viewer("rviz", "RViz, for logs converted with --encoding ros1", ".rviz", _rviz),
)
VIEWERS: Final[Mapping[str, Viewer]] = {each.name: each for each in _VIEWERS}
"""By name, in the order of ``--help``."""
