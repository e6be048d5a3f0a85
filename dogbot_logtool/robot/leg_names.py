"""Words of a name as those of a leg: which leg, by its end and side, its row or its number."""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Final

from dogbot_logtool.core.leg_position import LegPosition
from dogbot_logtool.robot.words import ENDS, LETTERS, ROWS, SIDES, Part, Word, words_of

_HALVES: Final = frozenset({*ENDS, *SIDES})
_POSITIONS: Final = frozenset({*_HALVES, *LETTERS})
ORDER: Final = ("front", "middle", "back", "left", "right")
"""Ends and sides, as legs are sorted by them."""


def leg_of(name: str) -> LegPosition:
    """Return the end and the side of the robot that a name tells; each empty where it does not."""
    return _ends_and_sides([word.text for word in words_of(name)])


def leg_position(name: str) -> LegPosition | None:
    """Return where a leg sits whose name is given, such as ``hind_left`` or ``LF_FOOT``.

    None where the name does not tell, or tells several.
    """
    end, side = leg_of(name)
    return (end, side) if end and side else None


def foot_name(label: str) -> str:
    """Return a name for a foot that messages call by a label, such as ``LF_FOOT``."""
    end, side = leg_of(label)
    if side:
        return f"{end}_{side}" if end else side
    words = words_of(label)
    numbered = {leg.name for at in range(len(words)) if (leg := _numbered(words, [at]))}
    return numbered.pop() if len(numbered) == 1 else sanitised(label)


def sanitised(name: str) -> str:
    """Return a name of letters, digits and underscores."""
    return re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_") or "foot"


def _ends_and_sides(texts: Sequence[str]) -> LegPosition:
    """Return the end and the side that words tell; each empty where they tell none, or several."""
    letters = [LETTERS[text] for text in texts if text in LETTERS]
    ends = {ENDS[text] for text in texts if text in ENDS} | {end for end, _ in letters}
    sides = {SIDES[text] for text in texts if text in SIDES} | {side for _, side in letters}
    return (ends.pop() if len(ends) == 1 else ""), (sides.pop() if len(sides) == 1 else "")


@dataclass(frozen=True, slots=True)
class Leg:
    """A name, understood as that of a leg."""

    name: str
    order: tuple[int, int]
    """Sorts legs front to back and left before right, or by number."""
    slots: tuple[int, ...]
    """The words that name it."""
    position: LegPosition | None = None


def _corner(words: Sequence[Word], differ: Sequence[int]) -> Leg | None:
    """Read words as one of four or six legs: ``lf``, ``front_left``.

    If all legs have the same end or the same side, its word may be that of a robot or a controller:
    it is a leg's only beside the other one, as in ``front_left`` and ``front_right``.
    """
    slots = [at for at in differ if words[at].text in _POSITIONS]
    if not slots:
        return None
    beside = {
        at
        for one in slots
        for at in (one - 1, one + 1)
        if 0 <= at < len(words) and words[at].segment == words[one].segment
        if words[at].text in _HALVES
    }
    texts = [words[at].text for at in slots]
    after = words[slots[0] + 1 : slots[0] + 2]
    # The name of a sensor of one of two feet, as in `left_foot_front`; but `left_foot_fl` is clear.
    is_sensor = texts[0] in SIDES and any(word.is_leg for word in after)
    if is_sensor and LETTERS.keys().isdisjoint(texts):
        return None
    for own in (slots, sorted(beside.union(slots))):
        end, side = _ends_and_sides([words[at].text for at in own])
        if end and side:
            order = ORDER.index(end), ORDER.index(side)
            return Leg(f"{end}_{side}", order, tuple(own), (end, side))
    return None


def _row(words: Sequence[Word], differ: Sequence[int]) -> Leg | None:
    """Read words as one of two rows of numbered legs: ``l1``, ``left_leg_1``, ``leg1_l``, ``bl``.

    Which end the numbers begin at is not known, so such a leg has no position.
    """
    for at in differ:
        if words[at].text in ROWS:
            row, its_side = ROWS[words[at].text]
            return _of_row(its_side, row, at)
    numbers = [at for at in differ if words[at].slot == "number"]
    sides = [at for at in differ if words[at].text in SIDES]
    for at, side in product(numbers, sides):
        between = words[min(at, side) + 1 : max(at, side)]
        before = words[at - 1] if at else None
        own = words[at].segment
        is_near = not between or (len(between) == 1 and between[0].part is Part.LEG)
        # The number of something else, as in `robot1_left_leg`.
        is_other = side > at and before and before.segment == own and not before.is_leg
        if is_near and own == words[side].segment and not is_other:
            return _of_row(SIDES[words[side].text], words[at].text, min(at, side), max(at, side))
    return None


def _of_row(side: str, row: str, *slots: int) -> Leg:
    return Leg(f"{side}_{row}", (_number(row), ORDER.index(side)), slots)


def _numbered(words: Sequence[Word], differ: Sequence[int]) -> Leg | None:
    """Read a word as the number of a leg, or its letter: ``leg_1``, ``leg/1``, ``leg_a``."""
    if len(differ) != 1 or words[differ[0]].slot not in {"number", "row"}:
        return None
    at = differ[0]
    word = words[at]
    beside = [one for one in words if one.segment == word.segment and one is not word]
    beside = beside or [one for one in words if one.segment == word.segment - 1][-1:]
    parts = [one.text for one in beside if one.is_leg]
    order = _number(word.text), len(word.text)
    return Leg(f"{parts[-1]}_{word.text}", order, (at,)) if parts else None


def _side(words: Sequence[Word], differ: Sequence[int]) -> Leg | None:
    """Read a word as the side of one of two legs."""
    for at in differ:
        if side := SIDES.get(words[at].text):
            return Leg(side, (ORDER.index(side), 0), (at,))
    return None


def _number(text: str) -> int:
    return int(text[:9]) if text.isdecimal() else ord(text) - ord("a")


KINDS: Final[Sequence[tuple[str, Callable[[Sequence[Word], Sequence[int]], Leg | None]]]] = (
    ("corners", _corner),
    ("numbers", _row),
    ("numbers", _numbered),
    ("sides", _side),
)
"""How the words of siblings that differ are read, the surest first."""
