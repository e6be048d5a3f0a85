"""All the ways in which words of a name can be read as those of a leg."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Final

from dogbot_logtool.core.leg_position import LegPosition
from dogbot_logtool.robot.words import (
    END_FIRST,
    ENDS,
    LETTERS,
    MERITS,
    NEUTRAL,
    ROWS,
    SIDE_FIRST,
    SIDES,
    Part,
    Word,
)

_ORDER: Final = ("front", "middle", "back", "left", "right")


@dataclass(frozen=True, slots=True)
class Reading:
    """A name, understood as that of a leg."""

    kind: str
    """``corners``, ``sides`` or ``numbers``."""
    scheme: str
    """Which letters or words name the leg; siblings use the same."""
    leg: str
    """Its name."""
    position: LegPosition | None
    order: tuple[int, int]
    """Sorts legs front to back and left before right, or by number."""


def readings_of(words: Sequence[Word], slots: frozenset[int]) -> Iterator[Reading]:
    """Yield the ways in which some of a name's words can be read as the name of a leg."""
    if _names_one_foot(words, slots):
        return
    texts = [words[at].text for at in sorted(slots)]
    if not _is_of_one_foot(words, slots):
        letters = not LETTERS.keys().isdisjoint(texts)
        for scheme in (SIDE_FIRST, END_FIRST) if letters else (SIDE_FIRST,):
            if position := _position(texts, scheme):
                order = _ORDER.index(position[0]), _ORDER.index(position[1])
                kind = scheme is SIDE_FIRST and letters
                yield Reading("corners", str(kind), "_".join(position), position, order)
    if len({SIDES.get(text, text) for text in texts}) == 1 and texts[0] in SIDES:
        side = SIDES[texts[0]]
        yield Reading("sides", "", side, None, (_ORDER.index(side), 0))
    if len(slots) == 1:
        yield from _numbers(words, min(slots))
    elif len(slots) == 2:
        yield from _rows(words, *sorted(slots))


def _position(texts: Sequence[str], scheme: Mapping[str, LegPosition]) -> LegPosition | None:
    """Return the position that all of some words tell; None: they tell none, or several."""
    pairs = {scheme.get(text) for text in texts if text in LETTERS}
    ends = {ENDS[text] for text in texts if text in ENDS} | {pair[0] for pair in pairs if pair}
    sides = {SIDES[text] for text in texts if text in SIDES} | {pair[1] for pair in pairs if pair}
    known = all(text in LETTERS or text in ENDS or text in SIDES for text in texts)
    if not known or None in pairs or (len(ends), len(sides)) != (1, 1):
        return None
    return ends.pop(), sides.pop()


def _is_of_one_foot(words: Sequence[Word], slots: frozenset[int]) -> bool:
    """Tell whether words name a sensor of one of two feet, as in ``left_foot_front``."""
    first, *rest = words[min(slots) :]
    return first.text in SIDES and bool(rest) and rest[0].is_leg


def _numbers(words: Sequence[Word], at: int) -> Iterator[Reading]:
    """Read a word as the number of a leg, or its letter, or as its row and side: ``bl``."""
    word = words[at]
    if word.text in ROWS:
        row, side = ROWS[word.text]
        yield _of_row(side, row, "row and side")
    if word.slot not in {"number", "row"}:
        return
    beside = [one for one in words if one.segment == word.segment and one is not word]
    beside = beside or [one for one in words if one.segment == word.segment - 1][-1:]
    parts = [one.text for one in beside if one.is_leg]
    if parts:
        order = _number(word.text), len(word.text)
        yield Reading("numbers", word.slot, f"{parts[-1]}_{word.text}", None, order)


def _rows(words: Sequence[Word], one: int, other: int) -> Iterator[Reading]:
    """Read two words as one of two rows of numbered legs: ``l1``, ``left_leg_1``, ``leg1_l``.

    Which end the numbers begin at is not known, so such a leg has no position.
    """
    at, side = (one, other) if words[one].slot == "number" else (other, one)
    between = words[one + 1 : other]
    if (
        words[at].slot != "number"
        or words[side].text not in SIDES
        or words[at].segment != words[side].segment
        or len(between) > 1
        or any(word.part is not Part.LEG for word in between)
    ):
        return
    before = words[at - 1] if at else None
    if side > at and before and before.segment == words[at].segment and not before.is_leg:
        # The number of something else, as in `robot1_left_leg`.
        return
    yield _of_row(SIDES[words[side].text], words[at].text, str(side > at))


def _of_row(side: str, row: str, scheme: str) -> Reading:
    order = _number(row), _ORDER.index(side)
    return Reading("numbers", f"rows {scheme}", f"{side}_{row}", None, order)


def _number(text: str) -> int:
    return int(text[:9]) if text.isdecimal() else ord(text) - ord("a")


def _names_one_foot(words: Sequence[Word], slots: frozenset[int]) -> bool:
    """Tell whether words outside the slots name one foot: its siblings are its sensors.

    A segment without a slot must say nothing else: ``left_leg_controller`` names no leg.
    """
    for segment in {word.segment for word in words}:
        inside = [at for at, word in enumerate(words) if word.segment == segment]
        others = [words[at] for at in inside if at not in slots]
        named = any(
            b == a + 1
            and (words[a].is_leg, words[a].is_position) == (words[b].is_position, words[b].is_leg)
            and (words[a].is_leg or words[a].is_position)
            for a, b in pairwise(at for at in inside if at not in slots)
        )
        telling = (w.is_leg or w.is_position or w.text in NEUTRAL for w in others)
        if named and (len(others) < len(inside) or all(telling)):
            return True
    return False


def describing(words: Sequence[Word], slots: frozenset[int]) -> list[Word]:
    """Return the words that describe the leg: of its segment, of those after, and just before.

    A segment before counts only if it says nothing else, as ``/foot_sensors/`` and ``/desired/``.
    """
    first = words[min(slots)].segment
    before = [word for word in words if word.segment == first - 1]
    telling = all(word.part is not None or word.text in NEUTRAL | MERITS.keys() for word in before)
    outside = [word for at, word in enumerate(words) if at not in slots]
    return [word for word in outside if word.segment >= first - telling]


def part_of(near: Sequence[Word]) -> Part:
    """Return the part of a body that a name is about, by the words that describe the leg."""
    parts = [word.part for word in near if word.part is not None]
    return Part.FOOT if Part.FOOT in parts else min(parts, default=Part.UNKNOWN)


def is_doubtful(words: Sequence[Word], slots: frozenset[int]) -> bool:
    """Tell whether the segment before the leg's names something that is no foot.

    So are the numbers in ``foot_l1`` doubtful: they may be those of the sensors of one foot.
    """
    first = words[min(slots)].segment
    inside = {word.part for word in words if word.segment == first}
    if len(slots) > 1 and any(words[at].slot == "number" for at in slots):
        return Part.FOOT in inside and Part.LEG not in inside
    return any(word.part is Part.NOT_A_FOOT for word in words if word.segment == first - 1)
