"""What is drawn in the world, in terms of no encoding: arrows, texts, lines and balls."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Final, NamedTuple

from dogbot_logtool.core.scene.foot_style import colour_parts, foot_colour
from dogbot_logtool.core.scene.styles import LIFETIME_S
from dogbot_logtool.writer.template import Slot

Point = tuple[Slot, Slot, Slot]
"""m: x, y, z."""
Colour = tuple[Slot | float, ...]
"""Red, green, blue and alpha in [0, 1]."""
SHAFT_SHARE: Final = 0.77
"""The shaft's share of an arrow's length, as viewers draw ROS markers."""
HEAD_TO_SHAFT: Final = 2.0
"""Diameter of an arrow's head over its shaft's."""
_LABEL_HEIGHT_M: Final = 0.05
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
class ArrowLook:
    """How all arrows of a style look."""

    shaft_diameter_m: float
    lifetime_s: float
    """0: for ever."""


class SupportShape(NamedTuple):
    """How many points a support message has; messages of one shape have one size."""

    line: int
    """Points of the outline."""
    pressure: int
    """1 where the centre of pressure is known; also `projection`, the base's."""
    projection: int
    touchdown: int


@dataclass(frozen=True, slots=True)
class SupportLook:
    """How all support messages look."""

    line_m: float
    """m, thickness of the outline."""
    mark_m: float
    """m, diameter of a touchdown's mark."""
    lifetime_s: float


def colour_slots(prefix: str = "") -> tuple[Slot, ...]:
    """Return slots for red, green and blue."""
    return tuple(Slot(f"{prefix}{part}") for part in "rgb")


def point_slots(prefix: str = "") -> Point:
    """Return slots for x, y and z."""
    return Slot(f"{prefix}x"), Slot(f"{prefix}y"), Slot(f"{prefix}z")


def _points(name: str, count: int) -> tuple[Point, ...]:
    return tuple(point_slots(f"{name}{index}.") for index in range(count))


def arrow(foot: str, frame: str, look: ArrowLook) -> Drawing:
    """Draw a foot's arrow: slots of a pose, a colour, and ``length``, or ``shaft`` and ``head``."""
    colour = (*colour_slots(), Slot("a"))
    one = Primitive(Shape.ARROW, (point_slots(),), look.shaft_diameter_m, colour=colour)
    return Drawing(foot, "dogbot", frame, look.lifetime_s, (one,))


def label(foot: str, frame: str, name: str) -> Drawing:
    """Draw a foot's load beside it, after a short name: slots of a point, and ``text``."""
    one = Primitive(
        Shape.TEXT,
        (point_slots(),),
        0.0,
        _LABEL_HEIGHT_M,
        _LABEL_COLOUR,
        text=Slot("text", f"{name} "),
    )
    return Drawing(foot, "label", frame, LIFETIME_S, (one,))


def support(shape: SupportShape, frame: str, look: SupportLook) -> Drawing:
    """Draw what the robot stands on: slots of points, and of the colours of line and touchdowns."""
    line, pressure, projection, touchdowns = map(_points, shape._fields, shape)
    wide, flat = 1.5 * look.mark_m, 0.25 * look.mark_m
    outline = (*colour_slots(), Slot("a"))
    colours: tuple[Colour, ...] = tuple(
        (*colour_slots(f"touchdown{index}."), 1.0) for index in range(shape.touchdown)
    )
    every = (
        Primitive(Shape.LINE_STRIP, line, look.line_m, colour=outline),
        Primitive(Shape.BALLS, pressure, wide, wide, _PRESSURE_COLOUR),
        Primitive(Shape.BALLS, projection, wide, flat, _PROJECTION_COLOUR),
        Primitive(Shape.BALLS, touchdowns, look.mark_m, flat, _TOUCHDOWN_COLOUR, colours),
    )
    drawn = tuple(each if each.points else None for each in every)
    return Drawing("support", "support", frame, look.lifetime_s, drawn)


def legs(feet: Sequence[int], frame: str, look: SupportLook) -> Drawing:
    """Draw lines from hips to some feet: slots of both ends."""
    points = tuple(point_slots(f"{end}{foot}.") for foot in feet for end in ("hip", "foot"))
    ends: list[Colour] = [(*colour_parts(foot_colour(foot)), 1.0) for foot in feet]
    colours = tuple(colour for end in ends for colour in (_HIP_COLOUR, end))
    lines = Primitive(Shape.LINE_LIST, points, look.mark_m, colours=colours)
    return Drawing("legs", "dogbot", frame, look.lifetime_s, (lines,))
