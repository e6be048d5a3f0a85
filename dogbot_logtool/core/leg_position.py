"""The position of a leg on the body: fore or hind, left or right."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Floats, median_of

LegPosition = tuple[str, str]
"""("front" | "middle" | "back", "left" | "right" | "centre")."""


def are_some_of(leg_positions: Sequence[LegPosition | None]) -> bool:
    """Tell whether a robot with these feet has others, too, by how many there are and by names."""
    if len(leg_positions) == 1:
        return True
    known = {each for each in leg_positions if each}
    ends, sides = {end for end, _ in known}, {side for _, side in known}
    if len(known) < len(leg_positions) or not ends <= set(_ENDS) or not sides <= set(_SIDES):
        return False
    # A biped's legs may be called middle ones.
    return not ends <= {"middle"} and len(known) < 2 * len(ends | {"front", "back"})


_ENDS: Final = ("front", "middle", "back")
_SIDES: Final = ("left", "right")


def legs_in_order(positions: Sequence[LegPosition | None]) -> tuple[int, ...] | None:
    """Return the feet from front to back, left before right: the order of a gait's phases.

    Two feet need no positions. None for robots whose gaits have no names (other than two, four
    or six feet), where the positions of four or six feet are not known, and for a pair of feet of
    a robot that has more.
    """
    if len(positions) == 2:
        if any(position and position[0] in {"front", "back"} for position in positions):
            return None
        swapped = [position[1] if position else "" for position in positions] == ["right", "left"]
        return (1, 0) if swapped else (0, 1)
    ends = {4: ("front", "back"), 6: _ENDS}.get(len(positions), ())
    wanted = [(end, side) for end in ends for side in _SIDES]
    if not wanted or sorted(each for each in positions if each) != sorted(wanted):
        return None
    return tuple(positions.index(each) for each in wanted)


def leg_names(points: Floats) -> tuple[str, ...]:
    """Name legs by where their feet are.

    Two feet are left and right; four and six are told by their order along x on each side. Any
    other number, or one with more feet on a side, is only counted: ``foot_1``.

    Args:
        points: (k, 3) m, in the base's frame; x is forward, y to the left.
    """
    numbered = tuple(f"foot_{number + 1}" for number in range(len(points)))
    left = points[:, 1] > median_of(points[:, 1]) if len(points) else np.zeros(0, np.bool_)
    ends = {1: ("",), 2: ("front", "back"), 3: _ENDS}.get(int(left.sum()), ())
    if 2 * len(ends) != len(points):
        return numbered
    names = list(numbered)
    for side, rows in (("left", np.flatnonzero(left)), ("right", np.flatnonzero(~left))):
        from_front = rows[np.argsort(-points[rows, 0], kind="stable")]
        for end, row in zip(ends, from_front.tolist(), strict=True):
            names[row] = f"{end}_{side}" if end else side
    return tuple(names)
