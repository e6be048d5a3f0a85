"""EUROBENCH's names of gait events: ``l_heel_strike``, ``r_toe_off``, for robots with two feet."""

import re
from collections.abc import Mapping, Sequence
from typing import Final

from dogbot_logtool.core.events.event import EventType

LABELS: Final = {"heel_strike": EventType.TOUCHDOWN, "toe_off": EventType.LIFT_OFF}
SIDES: Final = {"l": "left", "r": "right"}


def feet_by_side(feet: Mapping[str, Sequence[str] | None]) -> dict[str, str] | None:
    """Return the foot of the left and of the right side; None where there are not just these two.

    Args:
        feet: position of the leg (``("middle", "left")``) by name, None where only the name tells.
    """
    sides = {_side(name, at): name for name, at in feet.items()}
    return sides if len(feet) == 2 and set(sides) == set(SIDES.values()) else None


def _side(name: str, leg_position: Sequence[str] | None) -> str:
    if leg_position is not None:
        return leg_position[1]
    words = re.split(r"[^a-z]+", name.lower())
    return next((side for short, side in SIDES.items() if {short, side} & {*words}), "")
