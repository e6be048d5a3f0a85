"""What is drawn in the world, as markers: arrows, texts, lines and balls.

Beside each drawing stand the columns of its slots.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.core.scene.arrows import Arrows
from dogbot_logtool.core.scene.foot_style import FOOT_COLOURS, colour_parts, foot_colour
from dogbot_logtool.core.scene.loads import Labels
from dogbot_logtool.core.scene.styles import LIFETIME_S
from dogbot_logtool.core.scene.support_scene import LegLines, SupportScene
from dogbot_logtool.writer.described import (
    MARKER,
    MARKERS,
    STAMP,
    Described,
    parts,
    parts_of_each,
    slots,
    time,
)
from dogbot_logtool.writer.template import Columns, Literal, Of, Slot

ARROW, LINE_STRIP, LINE_LIST, BALLS, TEXT = 0, 4, 5, 7, 9
"""Types of markers."""
DELETE: Final = 2
"""The action that removes a marker."""
UPRIGHT: Final[Literal] = {"orientation": {"w": 1.0}}
SHAFT_SHARE: Final = 0.77
"""The shaft's share of an arrow's length, as viewers draw ROS markers."""
_COLOURS: Final = np.array([colour_parts(foot_colour(foot)) for foot in range(len(FOOT_COLOURS))])
"""(k, 3) red, green, blue of feet."""
_LABEL_HEIGHT_M: Final = 0.05
_LABEL_WIDTH: Final = 6
"""Characters of the number and its unit in a label, padded with spaces."""
_LARGEST_N: Final = 9999.0
_BEYOND: Final = ">10 kN"
_LABEL_COLOUR: Final = (0.95, 0.95, 0.95)
"""Pale: Foxglove writes it on black, RViz has a dark ground."""
_PRESSURE_COLOUR: Final = (0.8, 0.475, 0.655)
"""Reddish purple; like the next, of Okabe and Ito."""
_PROJECTION_COLOUR: Final = (0.337, 0.706, 0.914)
"""Sky blue."""
_TOUCHDOWN_COLOUR: Final = (0.6, 0.6, 0.6)
"""Where a viewer ignores the colours of the feet."""
_HIP_COLOUR: Final = (0.36, 0.39, 0.44)
"""Colour of a leg's line at the hip; at its foot it has the foot's colour."""


@dataclass(frozen=True, slots=True)
class Look:
    """How all that is drawn looks."""

    arrow_m: float
    """m, diameter of an arrow's shaft."""
    arrow_lifetime_s: float
    """0: for ever."""
    mark_m: float
    """m, diameter of a touchdown's mark, and thickness of a leg's line."""
    mark_lifetime_s: float
    """Of support and legs."""


def _marker(
    frame: str, namespace: str, lifetime_s: float, drawn: Literal, number: int = 0
) -> Literal:
    """Return a marker that replaces the one before it; one of nothing removes it."""
    if drawn:
        drawn = {"lifetime": time(round(lifetime_s * 1e9)), **drawn}
    header = {"stamp": STAMP, "frame_id": frame}
    content = drawn or {"action": DELETE}
    return {"header": header, "ns": namespace, "id": number, "pose": UPRIGHT, **content}


def _colour(rgb: Sequence[float]) -> Literal:
    return dict(zip("rgba", (*rgb, 1.0), strict=True))


def _size(width: float, height: float) -> Literal:
    return {"x": width, "y": width, "z": height}


def arrow(foot: str, frame: str, look: Look, visible: bool) -> Described:  # noqa: FBT001
    """Draw a foot's arrow: slots of a pose, a colour, and ``length``; or remove it."""
    drawn = {
        "type": ARROW,
        "pose": {"position": slots("xyz"), "orientation": slots("xyzw", "q")},
        "scale": {"x": Slot("length"), "y": look.arrow_m, "z": look.arrow_m},
        "color": slots("rgba", of=Of.COLOUR),
    }
    marker = _marker(frame, "dogbot", look.arrow_lifetime_s, drawn if visible else {})
    return Described(MARKER, marker, foot, look.arrow_lifetime_s)


def arrow_columns(arrows: Arrows) -> Columns:
    """Return the columns of arrows; an encoding takes the length, or its parts."""
    return {
        **parts("xyz", arrows.position),
        **parts("xyzw", arrows.orientation, "q"),
        **parts("rgba", arrows.colour),
        "length": arrows.length,
        "shaft": SHAFT_SHARE * arrows.length,
        "head": (1.0 - SHAFT_SHARE) * arrows.length,
    }


def label(foot: str, frame: str, name: str, visible: bool) -> Described:  # noqa: FBT001
    """Draw a foot's load beside it, after a short name: slots of a point, and ``text``."""
    drawn = {
        "type": TEXT,
        "pose": {"position": slots("xyz"), **UPRIGHT},
        "scale": {"z": _LABEL_HEIGHT_M},
        "color": _colour(_LABEL_COLOUR),
        "text": Slot("text", Of.TEXT, f"{name} "),
    }
    marker = _marker(frame, "label", LIFETIME_S, drawn if visible else {})
    return Described(MARKER, marker, foot, LIFETIME_S)


def label_columns(labels: Labels) -> Columns:
    """Return the columns of labels."""
    text = np.full(len(labels.visible), b"", f"S{_LABEL_WIDTH}")
    text[labels.visible] = [
        (_BEYOND if force > _LARGEST_N else f"{force:.0f} N").center(_LABEL_WIDTH).encode()
        for force in labels.force[labels.visible].tolist()
    ]
    return {**parts("xyz", labels.position), "text": text}


def support_points(scene: SupportScene) -> Mapping[str, Floats]:
    """Return the points of what the robot stands on, (n, k, 3), NaN where there are fewer."""
    return {
        "line": scene.outline,
        "pressure": scene.pressure[:, None],
        "projection": scene.projection[:, None],
        "touchdown": scene.touchdowns,
    }


def support(counts: Sequence[int], frame: str, look: Look) -> Described:
    """Draw what the robot stands on: slots of points, and of the colours of line and touchdowns.

    Args:
        counts: how many points there are, in the order of `support_points`; messages of the same
            have one size.
        frame: that of all points.
        look: how all that is drawn looks.
    """
    names = "line", "pressure", "projection", "touchdown"
    line, pressure, projection, touchdowns = (
        [slots("xyz", f"{name}{index}.") for index in range(count)]
        for name, count in zip(names, counts, strict=True)
    )
    wide, flat = 1.5 * look.mark_m, 0.25 * look.mark_m
    outline = {"type": LINE_STRIP, "points": line, "scale": {"x": look.mark_m / 2.0}}
    tints = [slots("rgb", f"touchdown{index}.", Of.COLOUR) for index in range(len(touchdowns))]
    footfalls = _balls(touchdowns, _size(look.mark_m, flat), _TOUCHDOWN_COLOUR)
    every: tuple[Literal, ...] = (
        {**outline, "color": slots("rgba", of=Of.COLOUR)},
        _balls(pressure, _size(wide, wide), _PRESSURE_COLOUR),
        _balls(projection, _size(wide, flat), _PROJECTION_COLOUR),
        {**footfalls, "colors": [{**each, "a": 1.0} for each in tints]},
    )
    lifetime_s = look.mark_lifetime_s
    markers = [
        _marker(frame, "support", lifetime_s, each if each["points"] else {}, number)
        for number, each in enumerate(every)
    ]
    return Described(MARKERS, {"markers": markers}, "support", lifetime_s)


def _balls(points: Sequence[Literal], size: Literal, rgb: Sequence[float]) -> Literal:
    return {"type": BALLS, "points": points, "scale": size, "color": _colour(rgb)}


def support_columns(scene: SupportScene) -> Columns:
    """Return the columns of what the robot stands on."""
    colours = parts_of_each("rgb", _COLOURS[scene.touchdown_feet % len(_COLOURS)], "touchdown")
    columns = {**parts("rgba", scene.colour), **colours}
    for name, points in support_points(scene).items():
        columns |= parts_of_each("xyz", points, name)
    return columns


def legs(feet: Sequence[int], frame: str, look: Look) -> Described:
    """Draw lines from hips to some feet: slots of both ends; without feet, remove them."""
    ends = [(end, foot) for foot in feet for end in ("hip", "foot")]
    drawn = {
        "type": LINE_LIST,
        "points": [slots("xyz", f"{end}{foot}.") for end, foot in ends],
        "scale": {"x": look.mark_m},
        "colors": [
            _colour(_HIP_COLOUR if end == "hip" else colour_parts(foot_colour(foot)))
            for end, foot in ends
        ],
    }
    marker = _marker(frame, "dogbot", look.mark_lifetime_s, drawn if feet else {})
    return Described(MARKER, marker, "legs", look.mark_lifetime_s)


def leg_columns(legs: LegLines) -> Columns:
    """Return the columns of lines from hips to feet."""
    hips, feet = legs.ends[:, :, 0], legs.ends[:, :, 1]
    return {**parts_of_each("xyz", hips, "hip"), **parts_of_each("xyz", feet, "foot")}
