"""What is drawn in the world, as markers: arrows, texts, lines and balls."""

from collections.abc import Sequence
from typing import Final, NamedTuple

from dogbot_logtool.core.scene.arrows import LIFETIME_S
from dogbot_logtool.core.scene.feet import colour_parts, foot_colour
from dogbot_logtool.writer.described import MARKER, MARKERS, STAMP, Described, slots, time
from dogbot_logtool.writer.template import Literal, Of, Slot

ARROW, LINE_STRIP, LINE_LIST, BALLS, TEXT = 0, 4, 5, 7, 9
"""Types of markers."""
DELETE: Final = 2
"""The action that removes a marker."""
UPRIGHT: Final[Literal] = {"orientation": {"w": 1.0}}
_LABEL_HEIGHT_M: Final = 0.05
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


class Look(NamedTuple):
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
    """Draw a foot's arrow, or remove it."""
    drawn = {
        "type": ARROW,
        "pose": {
            "position": slots("xyz", "position"),
            "orientation": slots("xyzw", "orientation"),
        },
        "scale": {"x": Slot("length"), "y": look.arrow_m, "z": look.arrow_m},
        "color": slots("rgba", "colour", of=Of.COLOUR),
    }
    marker = _marker(frame, "dogbot", look.arrow_lifetime_s, drawn if visible else {})
    return Described(MARKER, marker, foot, look.arrow_lifetime_s)


def label(foot: str, frame: str, name: str, visible: bool) -> Described:  # noqa: FBT001
    """Draw a foot's load beside it, after a short name; or remove it."""
    drawn = {
        "type": TEXT,
        "pose": {"position": slots("xyz", "position"), **UPRIGHT},
        "scale": {"z": _LABEL_HEIGHT_M},
        "color": _colour(_LABEL_COLOUR),
        "text": Slot("text", of=Of.TEXT, before=f"{name} "),
    }
    marker = _marker(frame, "label", LIFETIME_S, drawn if visible else {})
    return Described(MARKER, marker, foot, LIFETIME_S)


SUPPORT_POINTS: Final = "outline", "pressure", "projection", "touchdowns"
"""Columns of the points that support is drawn with."""


def support(counts: Sequence[int], frame: str, look: Look) -> Described:
    """Draw what the robot stands on.

    Args:
        counts: how many of `SUPPORT_POINTS` there are; messages of the same have one size.
        frame: that of all points.
        look: how all that is drawn looks.
    """
    line, pressure, projection, touchdowns = (
        [slots("xyz", name, index) for index in range(count)]
        for name, count in zip(SUPPORT_POINTS, counts, strict=True)
    )
    wide, flat = 1.5 * look.mark_m, 0.25 * look.mark_m
    outline = {"type": LINE_STRIP, "points": line, "scale": {"x": look.mark_m / 2.0}}
    tints = [slots("rgb", "tints", index, of=Of.COLOUR) for index in range(len(touchdowns))]
    footfalls = _balls(touchdowns, _size(look.mark_m, flat), _TOUCHDOWN_COLOUR)
    every: tuple[Literal, ...] = (
        {**outline, "color": slots("rgba", "colour", of=Of.COLOUR)},
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


def legs(stands: Sequence[int], frame: str, look: Look) -> Described:
    """Draw lines from hips to the feet that stand; without any, remove them."""
    feet = [foot for foot, down in enumerate(stands) if down]
    colours = [(_HIP_COLOUR, colour_parts(foot_colour(foot))) for foot in feet]
    drawn = {
        "type": LINE_LIST,
        "points": [slots("xyz", "ends", foot, end) for foot in feet for end in (0, 1)],
        "scale": {"x": look.mark_m},
        "colors": [_colour(each) for ends in colours for each in ends],
    }
    marker = _marker(frame, "dogbot", look.mark_lifetime_s, drawn if feet else {})
    return Described(MARKER, marker, "legs", look.mark_lifetime_s)
