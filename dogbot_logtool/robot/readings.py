"""All the ways in which words of a name can be read as those of a leg."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise
from typing import Final

from dogbot_logtool.core.leg_position import LegPosition
from dogbot_logtool.robot.words import ENDS, LETTERS, NEUTRAL, ROWS, SIDES, Part, Word

_MOST_SLOTS: Final = 5
"""Words of a name, from its end, that may name its leg."""
_ORDER: Final = ("front", "middle", "back", "left", "right")


@dataclass(frozen=True, slots=True)
class Reading:
    """A name, understood as that of a leg."""

    kind: str
    """``corners``, ``sides`` or ``numbers``."""
    leg: str
    """Its name."""
    order: tuple[int, int]
    """Sorts legs front to back and left before right, or by number."""
    position: LegPosition | None = None


def readings(words: Sequence[Word]) -> Iterator[tuple[tuple[int, ...], Sequence[Reading]]]:
    """Yield words of a name that may name a leg, with the ways in which they do."""
    possible = [at for at, word in enumerate(words) if word.slot][-_MOST_SLOTS:]
    for count in (1, 2, 3):
        for slots in combinations(possible, count):
            if readings := tuple(readings_of(words, slots)):
                yield slots, readings


def readings_of(words: Sequence[Word], slots: Sequence[int]) -> Iterator[Reading]:
    """Yield the ways in which some of a name's words can be read as the name of a leg."""
    texts = [words[at].text for at in slots]
    after = slots[0] + 1
    # The name of a sensor of one of two feet, as in `left_foot_front`; but `left_foot_fl` is clear.
    is_sensor = texts[0] in SIDES and after < len(words) and words[after].is_leg
    is_sensor = is_sensor and LETTERS.keys().isdisjoint(texts)
    # A number beside a position says nothing more, as in `foot_1_fl`.
    told = [text for text in texts if not text.isdecimal()]
    if not is_sensor and len(told) > len(texts) - 2 and (position := position_of(told)):
        order = _ORDER.index(position[0]), _ORDER.index(position[1])
        yield Reading("corners", "_".join(position), order, position)
    sides = {SIDES.get(text, "") for text in texts}
    if len(sides) == 1 and (side := sides.pop()):
        yield Reading("sides", side, (_ORDER.index(side), 0))
    if len(slots) == 1:
        yield from _numbers(words, slots[0])
    elif len(slots) == 2:
        yield from _rows(words, *slots)


def position_of(texts: Sequence[str]) -> LegPosition | None:
    """Return the position that all of some words tell; None: they tell none, or several."""
    pairs = [LETTERS[text] for text in texts if text in LETTERS]
    ends = {ENDS[text] for text in texts if text in ENDS} | {end for end, _ in pairs}
    sides = {SIDES[text] for text in texts if text in SIDES} | {side for _, side in pairs}
    known = all(text in LETTERS or text in ENDS or text in SIDES for text in texts)
    return (ends.pop(), sides.pop()) if known and len(ends) == len(sides) == 1 else None


def _numbers(words: Sequence[Word], at: int) -> Iterator[Reading]:
    """Read a word as the number of a leg, or its letter, or as its row and side: ``bl``."""
    word = words[at]
    if word.text in ROWS:
        row, side = ROWS[word.text]
        yield _of_row(side, row)
    beside = [one for one in words if one.segment == word.segment and one is not word]
    beside = beside or [one for one in words if one.segment == word.segment - 1][-1:]
    parts = [one.text for one in beside if one.is_leg]
    if parts and word.slot in {"number", "row"}:
        order = _number(word.text), len(word.text)
        yield Reading("numbers", f"{parts[-1]}_{word.text}", order)


def _rows(words: Sequence[Word], one: int, other: int) -> Iterator[Reading]:
    """Read two words as one of two rows of numbered legs: ``l1``, ``left_leg_1``, ``leg1_l``.

    Which end the numbers begin at is not known, so such a leg has no position.
    """
    at, side = (one, other) if words[one].slot == "number" else (other, one)
    between = words[one + 1 : other]
    before = words[at - 1] if at else None
    own = words[at].segment
    if words[at].slot != "number" or words[side].text not in SIDES or own != words[side].segment:
        return
    if len(between) > 1 or any(word.part is not Part.LEG for word in between):
        return
    # The number of something else, as in `robot1_left_leg`.
    if side > at and before and before.segment == own and not before.is_leg:
        return
    yield _of_row(SIDES[words[side].text], words[at].text)


def _of_row(side: str, row: str) -> Reading:
    return Reading("numbers", f"{side}_{row}", (_number(row), _ORDER.index(side)))


def _number(text: str) -> int:
    return int(text[:9]) if text.isdecimal() else ord(text) - ord("a")


def names_one_foot(words: Sequence[Word], slots: Sequence[int]) -> bool:
    """Tell whether words outside the slots name one foot: siblings are its sensors.

    A segment without a slot must say nothing else: ``left_leg_controller`` names no leg.
    """
    for segment in {word.segment for word in words}:
        inside = [at for at, word in enumerate(words) if word.segment == segment]
        others = [at for at in inside if at not in slots]
        named = any(
            b == a + 1
            and (
                (words[a].is_leg and words[b].is_position)
                or (words[a].is_position and words[b].is_leg)
            )
            for a, b in pairwise(others)
        )
        said = [words[at] for at in others]
        telling = all(w.is_leg or w.is_position or w.text in NEUTRAL for w in said)
        if named and (len(others) < len(inside) or telling):
            return True
    return False
