"""Views of annotated logs, set up for viewers: a template each, in which names stand for values."""

import json
from collections.abc import Callable, Mapping, Sequence
from math import floor, log10, radians
from pathlib import Path
from string import Template
from typing import Any, Final, NamedTuple

from dogbot_logtool.core.scene.feet import foot_colour
from dogbot_logtool.io.plain_json import to_json
from dogbot_logtool.reader.containers.loss import SOUND, Damage
from dogbot_logtool.writer import topics

_ASIDE_DEG: Final = 75.0
"""The camera looks at the robot's front from this much to its right: nearer to the front, a
quadruped's right fore leg hides the left hind one, which stands with it in a trot."""
_STEPS: Final = (1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0)


class View(NamedTuple):
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


def upper_bound(value: float) -> float:
    """Return a round number that is at least a positive one, and hardly more."""
    power = 10.0 ** floor(log10(value))
    return next(power * step for step in _STEPS if power * step >= value * (1.0 - 1e-9))


Json = dict[str, Any]


def _template(name: str) -> Any:  # noqa: ANN401 - JSON
    return json.loads((Path(__file__).parent / "viewers" / name).read_text(encoding="utf-8"))


def _filled(value: Any, names: Mapping[str, Any]) -> Any:  # noqa: ANN401 - any part of a template
    """Put values in the place of names: ``"$name"`` is the value itself, of whatever type."""
    if isinstance(value, dict):
        return {_filled(key, names): _filled(each, names) for key, each in value.items()}
    if isinstance(value, list):
        return [_filled(each, names) for each in value]
    if isinstance(value, str) and value.startswith("$") and value[1:] in names:
        return names[value[1:]]
    return Template(value).safe_substitute(names) if isinstance(value, str) else value


_MOST_CURVES: Final = 4
"""Panels of curves: more would be too low to read."""
_ROW, _AXIS, _TITLE, _SCREEN = 64, 30, 31, 613
"""Pixels of a row of the gait diagram, of its time axis, of a panel's title, and between the bars
of a viewer on a screen of 1280 x 720."""
_MOST_GAIT: Final = 0.55
"""Share of the height for the gait diagram; what does not fit is scrolled."""


def foxglove_layout(view: View) -> Json:
    """Return a layout: the robot followed in 3D and events beside load curves and gait diagram."""
    names = {
        "world": view.world_frame,
        "base": view.base_frame,
        "distance": round(3.7 * view.size_m, 2),
        # The camera stands at -90 degrees minus this.
        "theta": (-90.0 - view.camera_deg) % 360.0,
        # Arrows stand above the robot as high as its feet are below it, and more.
        "target_height": round(0.05 * view.size_m, 2),
        # Without stamps, transforms read ahead would take the place of the present ones.
        "has_stamps": view.has_stamps,
        "events_topic": topics.EVENTS,
    }
    layout: Json = _filled(_template("foxglove.json"), names)
    panels = layout["configById"]
    curve, gait = panels.pop("Plot!load"), panels.pop("StateTransitions!gait")
    of_feet = [topic(foot) for foot in view.feet for topic in (topics.arrow, topics.label)]
    drawn = (*of_feet, topics.SUPPORT, topics.LEGS, topics.ROBOT_DESCRIPTION)
    panels["3D!robot"]["topics"] = {topic: {"visible": True} for topic in drawn}
    per_panel = max(-(-len(view.feet) // _MOST_CURVES), 1)
    rows = range(len(view.feet))
    stack = {
        f"Plot!load{number}": _curves(curve, view, rows[first : first + per_panel])
        for number, first in enumerate(rows[::per_panel])
    }
    share = min((_ROW * len(view.feet) + _AXIS + _TITLE) / _SCREEN, _MOST_GAIT)
    heights = [(1.0 - share) / max(len(stack), 1)] * len(stack) + [share]
    stack["StateTransitions!gait"] = gait | {"paths": _paths(gait, view, rows)}
    panels.update(stack)
    layout["layout"]["second"] = _stacked(list(stack), heights)
    return layout


def _curves(panel: Json, view: View, rows: Sequence[int]) -> Json:
    """Return the panel of the loads of some feet."""
    unit = "[N]" if view.peak_n is None else f"0 to {view.peak_n:g} N"
    title = f"{', '.join(view.feet[row] for row in rows)}  {unit}"
    filled: Json = _filled(panel, {"title": title, "peak_n": view.peak_n})
    if view.peak_n is None:
        del filled["maxYValue"]
    return filled | {"paths": _paths(panel, view, rows)}


def _paths(panel: Json, view: View, rows: Sequence[int]) -> list[Json]:
    """Return the path of a panel for each of some feet."""
    (path,) = panel["paths"]
    return [
        _filled(
            path,
            {
                "foot": view.feet[row],
                "colour": foot_colour(row),
                "load_topic": topics.load(view.feet[row]),
            },
        )
        for row in rows
    ]


def _stacked(panels: Sequence[str], heights: Sequence[float]) -> str | Json:
    """Return panels one below the other, their heights in proportion."""
    if len(panels) == 1:
        return panels[0]
    return {
        "direction": "column",
        "first": panels[0],
        "second": _stacked(panels[1:], heights[1:]),
        "splitPercentage": round(100.0 * heights[0] / sum(heights), 2),
    }


def rviz_config(view: View) -> Json:
    """Return the content of a ``.rviz`` file, which is YAML.

    RViz takes the robot from the parameter ``robot_description``, not from the topic.
    """
    names = {
        "world": view.world_frame,
        "base": view.base_frame,
        "distance": round(4.4 * view.size_m, 2),
        "yaw": round(radians((view.camera_deg + view.turned_deg) % 360.0), 4),
    }
    config: Json = _filled(_template("rviz.json"), names)
    displays = config["Visualization Manager"]["Displays"]
    markers = displays.pop()
    of_feet = [topic(foot) for foot in view.feet for topic in (topics.arrow, topics.label)]
    displays += [_filled(markers, {"kind": "Marker", "topic": topic}) for topic in of_feet]
    displays.append(_filled(markers, {"kind": "Marker", "topic": topics.LEGS}))
    displays.append(_filled(markers, {"kind": "MarkerArray", "topic": topics.SUPPORT}))
    return config


VIEWERS: Final[Mapping[str, Callable[[View], Json]]] = {
    "foxglove": foxglove_layout,
    "rviz": rviz_config,
}
"""What a viewer's file holds."""


def layout_file(viewer: str, view: View) -> bytes:
    """Return the content of a viewer's file: JSON, which is YAML, too."""
    return (to_json(VIEWERS[viewer](view), indent=2) + "\n").encode()
