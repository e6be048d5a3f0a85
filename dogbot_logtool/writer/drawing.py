"""What is drawn in the world, in terms of no encoding: arrows, texts, lines and balls.

Beside each drawing stand the columns of its slots.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Any, Final

import numpy as np

from dogbot_logtool.core.arrays import Float32s, Floats
from dogbot_logtool.core.scene.arrows import Arrows
from dogbot_logtool.core.scene.foot_style import FOOT_COLOURS, colour_parts, foot_colour
from dogbot_logtool.core.scene.loads import Labels
from dogbot_logtool.core.scene.styles import LIFETIME_S
from dogbot_logtool.core.scene.support_scene import LegLines, SupportScene
from dogbot_logtool.writer.template import Columns, Of, Slot

Point = tuple[Slot, Slot, Slot]
"""m: x, y, z."""
Colour = tuple[Slot | float, ...]
"""Red, green, blue and alpha in [0, 1]."""
SHAFT_SHARE: Final = 0.77
"""The shaft's share of an arrow's length, as viewers draw ROS markers."""
HEAD_TO_SHAFT: Final = 2.0
"""Diameter of an arrow's head over its shaft's."""
_COLOURS: Final = np.array([colour_parts(foot_colour(foot)) for foot in range(len(FOOT_COLOURS))])
"""(k, 3) red, green, blue of feet."""
_LABEL_HEIGHT_M: Final = 0.05
_LABEL_WIDTH: Final = 6
"""Characters of the number and its unit in a label, padded with spaces."""
_LARGEST_N: Final = 9999.0
_BEYOND: Final = ">10 kN"
_LABEL_COLOUR: Final = (0.95, 0.95, 0.95, 1.0)
"""Pale: Foxglove writes it on black, RViz has a dark ground."""
_PRESSURE_COLOUR: Final = (0.8, 0.475, 0.655, 1.0)
"""Reddish purple; like the next, of Okabe and Ito."""
_PROJECTION_COLOUR: Final = (0.337, 0.706, 0.914, 1.0)
"""Sky blue."""
_TOUCHDOWN_COLOUR: Final = (0.6, 0.6, 0.6, 1.0)
"""Where a viewer ignores the colours of the feet."""
_HIP_COLOUR: Final = (0.36, 0.39, 0.44, 1.0)
"""Colour of a leg's line at the hip; at its foot it has the foot's colour."""


class Shape(Enum):
    """The shape of a primitive."""

    ARROW = 0
    LINE_STRIP = 1
    LINE_LIST = 2
    BALLS = 3
    TEXT = 4


@dataclass(frozen=True, slots=True)
class Primitive:
    """Something drawn, of one shape."""

    shape: Shape
    points: tuple[Point, ...]
    """One of an arrow or a text; an arrow is turned by the slots ``qx`` to ``qw``."""
    width: float
    """m: of a line or an arrow's shaft; diameter of balls."""
    height: float = 0.0
    """m, of balls or a text."""
    colour: Colour | None = None
    colours: tuple[Colour, ...] = ()
    """Of each point; none: all have `colour`."""
    text: Slot | None = None


@dataclass(frozen=True, slots=True)
class Drawing:
    """A message that replaces the one before it on its topic."""

    name: str
    """Identifies it on its topic in Foxglove's messages."""
    namespace: str
    """The same in ROS markers."""
    frame: str
    lifetime_s: float
    """0: for ever."""
    primitives: tuple[Primitive | None, ...]
    """None: one that is there in other messages of the topic, and is removed by this one."""


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


def colour_slots(prefix: str = "") -> tuple[Slot, ...]:
    """Return slots for red, green and blue, of values in [0, 1]."""
    return tuple(Slot(f"{prefix}{part}", Of.COLOUR) for part in "rgb")


def point_slots(prefix: str = "") -> Point:
    """Return slots for x, y and z."""
    return Slot(f"{prefix}x"), Slot(f"{prefix}y"), Slot(f"{prefix}z")


def _points(name: str, count: int) -> tuple[Point, ...]:
    return tuple(point_slots(f"{name}{index}.") for index in range(count))


def parts(names: str, values: Floats | Float32s, prefix: str = "") -> Columns:
    """Return the parts of vectors, quaternions or colours, (n, parts)."""
    return {f"{prefix}{name}": column for name, column in zip(names, values.T, strict=True)}


def arrow(foot: str, frame: str, look: Look) -> Drawing:
    """Draw a foot's arrow: slots of a pose, a colour, and ``length``, or ``shaft`` and ``head``."""
    colour = (*colour_slots(), Slot("a", Of.COLOUR))
    one = Primitive(Shape.ARROW, (point_slots(),), look.arrow_m, colour=colour)
    return Drawing(foot, "dogbot", frame, look.arrow_lifetime_s, (one,))


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


def label(foot: str, frame: str, name: str) -> Drawing:
    """Draw a foot's load beside it, after a short name: slots of a point, and ``text``."""
    one = Primitive(
        Shape.TEXT,
        (point_slots(),),
        0.0,
        _LABEL_HEIGHT_M,
        _LABEL_COLOUR,
        text=Slot("text", Of.TEXT, f"{name} "),
    )
    return Drawing(foot, "label", frame, LIFETIME_S, (one,))


def label_columns(labels: Labels) -> Columns:
    """Return the columns of labels."""
    text = np.full(len(labels.shown), b"", f"S{_LABEL_WIDTH}")
    text[labels.shown] = [
        (_BEYOND if force > _LARGEST_N else f"{force:.0f} N").center(_LABEL_WIDTH).encode()
        for force in labels.force[labels.shown].tolist()
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


def support(counts: Sequence[int], frame: str, look: Look) -> Drawing:
    """Draw what the robot stands on: slots of points, and of the colours of line and touchdowns.

    Args:
        counts: how many points there are, in the order of `support_points`; messages of the same
            have one size.
        frame: that of all points.
        look: how all that is drawn looks.
    """
    names = "line", "pressure", "projection", "touchdown"
    line, pressure, projection, touchdowns = map(_points, names, counts)
    wide, flat = 1.5 * look.mark_m, 0.25 * look.mark_m
    outline = (*colour_slots(), Slot("a", Of.COLOUR))
    colours: tuple[Colour, ...] = tuple(
        (*colour_slots(f"touchdown{index}."), 1.0) for index in range(len(touchdowns))
    )
    every = (
        Primitive(Shape.LINE_STRIP, line, look.mark_m / 2.0, colour=outline),
        Primitive(Shape.BALLS, pressure, wide, wide, _PRESSURE_COLOUR),
        Primitive(Shape.BALLS, projection, wide, flat, _PROJECTION_COLOUR),
        Primitive(Shape.BALLS, touchdowns, look.mark_m, flat, _TOUCHDOWN_COLOUR, colours),
    )
    drawn = tuple(each if each.points else None for each in every)
    return Drawing("support", "support", frame, look.mark_lifetime_s, drawn)


def support_columns(scene: SupportScene) -> Columns:
    """Return the columns of what the robot stands on."""
    columns = dict(parts("rgba", scene.colour))
    for name, points in support_points(scene).items():
        for index in range(points.shape[1]):
            columns |= parts("xyz", points[:, index], f"{name}{index}.")
    for index, feet in enumerate(scene.touchdown_feet.T):
        columns |= parts("rgb", _COLOURS[feet % len(_COLOURS)], f"touchdown{index}.")
    return columns


def legs(feet: Sequence[int], frame: str, look: Look) -> Drawing:
    """Draw lines from hips to some feet: slots of both ends."""
    points = tuple(point_slots(f"{end}{foot}.") for foot in feet for end in ("hip", "foot"))
    ends: list[Colour] = [(*colour_parts(foot_colour(foot)), 1.0) for foot in feet]
    colours = tuple(colour for end in ends for colour in (_HIP_COLOUR, end))
    lines = Primitive(Shape.LINE_LIST, points, look.mark_m, colours=colours)
    return Drawing("legs", "dogbot", frame, look.mark_lifetime_s, (lines,))


def leg_columns(legs: LegLines) -> Columns:
    """Return the columns of lines from hips to feet."""
    columns: dict[str, Any] = {}
    for foot in range(legs.ends.shape[1]):
        columns |= parts("xyz", legs.ends[:, foot, 0], f"hip{foot}.")
        columns |= parts("xyz", legs.ends[:, foot, 1], f"foot{foot}.")
    return columns
