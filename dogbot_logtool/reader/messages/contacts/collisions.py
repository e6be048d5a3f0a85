"""Which body of a pair is the foot, told by the names of the collisions."""

from collections.abc import Sequence
from fnmatch import fnmatchcase
from typing import Final

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.contact.contacts import (
    FOOT_IS_COLLISION1,
    FOOT_IS_COLLISION2,
    NOT_THIS_FOOT,
)
from dogbot_logtool.core.geometry.arrays import Ints
from dogbot_logtool.reader.decode.columns import Texts
from dogbot_logtool.robot import Foot

_GROUND_WORDS: Final = ("ground", "plane", "terrain", "heightmap", "floor", "world")


def foot_sides(
    first_names: Texts, second_names: Texts, foot: Ints, feet: Sequence[Foot]
) -> NDArray[np.int8]:
    """Tell which body of each pair is the foot.

    Args:
        first_names: (s,) names of body 1.
        second_names: (s,) names of body 2.
        foot: (s,) index of the foot whose sensor tells of the pair.
        feet: the robot's feet.

    Returns:
        (s,) as in `Contacts.foot_side`.
    """
    # Few pairs of names make few cases: each is judged once, and looked up. Whatever stands between
    # two names, their lengths for one, can only make more pairs of them. Each foot has its own.
    start = np.minimum(first_names.start, second_names.start)
    end = np.maximum(first_names.end, second_names.end)
    pair, rows = Texts(first_names.buffer, start, end - start).alike(foot)
    sides = [
        _side(feet[int(foot[row])], first_names.text(row), second_names.text(row)) for row in rows
    ]
    side: NDArray[np.int8] = np.array(sides, np.int8)[pair]
    return side


def _side(foot: Foot, first: str, second: str) -> int:
    """Tell which of two bodies is the foot, by their names."""
    if _of_same_robot(first, second):
        return NOT_THIS_FOOT
    is_first, is_second = _is_foot(foot, first), _is_foot(foot, second)
    if is_first != is_second:
        return FOOT_IS_COLLISION1 if is_first else FOOT_IS_COLLISION2
    if is_first or foot.collision:
        return NOT_THIS_FOOT
    # Without a pattern, and with names that do not tell, the ground's name may; else the sensor's
    # own body stands first.
    only_first_is_ground = _is_ground(first) and not _is_ground(second)
    return FOOT_IS_COLLISION2 if only_first_is_ground else FOOT_IS_COLLISION1


def _of_same_robot(first: str, second: str) -> bool:
    """Tell whether two bodies belong to one model that is not the ground's."""
    models = [name.split("::")[0] for name in (first, second) if name.count("::") >= 2]
    ground = _is_ground(first) or _is_ground(second)
    return len(models) == 2 and models[0] == models[1] and not ground


def link_of_collision(collision: str) -> str | None:
    """Return the link in Gazebo's name of a collision, ``model::link::collision``; None: none.

    Nested models add parts in front; the link is always the last but one.
    """
    parts = collision.split("::")
    return parts[-2] if len(parts) >= 3 else None


def _is_foot(foot: Foot, name: str) -> bool:
    if foot.collision:
        return fnmatchcase(name, foot.collision)
    return foot.name.lower() in name.lower()


def _is_ground(name: str) -> bool:
    return any(word in name.lower() for word in _GROUND_WORDS)
