"""Where on the body a leg is: fore or hind, left or right."""

from collections.abc import Sequence
from typing import Final

LegPosition = tuple[str, str]
"""("front" | "middle" | "back", "left" | "right" | "centre")."""


CORNERS: Final[tuple[LegPosition, ...]] = (
    ("front", "left"),
    ("front", "right"),
    ("back", "left"),
    ("back", "right"),
)


def quadruped(places: Sequence[LegPosition | None]) -> tuple[int, int, int, int] | None:
    """Return which foot is front left, front right, back left, back right.

    None unless the robot has exactly these four.
    """
    if sorted(place for place in places if place) != sorted(CORNERS) or len(places) != 4:
        return None
    front_left, front_right, back_left, back_right = (places.index(corner) for corner in CORNERS)
    return front_left, front_right, back_left, back_right
