"""Which body of a pair is the foot, told by the names of the collisions."""

from collections.abc import Sequence
from fnmatch import fnmatchcase
from typing import Final

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.arrays import Flags, Ints
from dogbot_logtool.core.contacts import FOOT_IS_COLLISION1, FOOT_IS_COLLISION2, NOT_THIS_FOOT
from dogbot_logtool.reader.columns import Texts
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
    code1, names1 = first_names.encode()
    code2, names2 = second_names.encode()
    first = _matches(feet, names1)[foot, code1]
    second = _matches(feet, names2)[foot, code2]
    side = np.select(
        [first & ~second, second & ~first], [FOOT_IS_COLLISION1, FOOT_IS_COLLISION2], NOT_THIS_FOOT
    )
    # Without a pattern, and with names that do not tell, the ground's name may; else the sensor's
    # own body stands first.
    guess = np.array([not one.collision for one in feet], np.bool_)[foot]
    guess &= ~(first | second)
    ground1 = np.array([_is_ground(name) for name in names1], np.bool_)[code1]
    ground2 = np.array([_is_ground(name) for name in names2], np.bool_)[code2]
    guessed = np.where(ground1 & ~ground2, FOOT_IS_COLLISION2, FOOT_IS_COLLISION1)
    return np.where(guess, guessed, side).astype(np.int8)


def link_of_collision(collision: str) -> str | None:
    """Return the link in Gazebo's name of a collision, ``model::link::collision``; None: none.

    Nested models add parts in front; the link is always the last but one.
    """
    parts = collision.split("::")
    return parts[-2] if len(parts) >= 3 else None


def _matches(feet: Sequence[Foot], names: Sequence[str]) -> Flags:
    """(feet, names) whether a name is the foot's."""
    table = [[_is_foot(foot, name) for name in names] for foot in feet]
    return np.array(table, np.bool_).reshape(len(feet), len(names))


def _is_foot(foot: Foot, name: str) -> bool:
    if foot.collision:
        return fnmatchcase(name, foot.collision)
    return foot.name.lower() in name.lower()


def _is_ground(name: str) -> bool:
    return any(word in name.lower() for word in _GROUND_WORDS)
