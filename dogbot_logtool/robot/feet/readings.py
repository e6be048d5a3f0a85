"""All the ways in which a name can be read as that of a leg."""

from collections.abc import Iterator, Sequence
from itertools import pairwise, product
from typing import Final

from dogbot_logtool.core.leg_position import LegPosition
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.robot.feet.words import (
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
_MOST_SLOTS: Final = 4
"""Words of a name that may name its leg together."""


@dataclass(frozen=True, slots=True)
class Reading:
    """A name, understood as that of a leg."""

    kind: str
    """``corners``, ``sides`` or ``numbers``."""
    leg: str
    """Its name."""
    position: LegPosition | None
    order: tuple[int, int]
    """Sorts legs front to back and left before right, or by number."""
    scheme: str
    """Which letters or words name the leg; siblings use the same."""
    slots: frozenset[int]
    """Indices of the words that name it."""


def template(words: Sequence[Word], reading: Reading) -> str:
    """Return a name with slots in place of the words that name the leg: siblings have the same."""
    texts = []
    for index, word in enumerate(words):
        texts.append(word.gap)
        texts.append(_slot(word, reading.kind) if index in reading.slots else word.text)
        texts.append(" ")
    return "".join(texts)


def _slot(word: Word, kind: str) -> str:
    if kind == "corners":
        return "{leg}" if word.text in LETTERS else "{end}" if word.text in ENDS else "{side}"
    return "{" + kind + "}"


def readings_of(words: Sequence[Word]) -> Iterator[Reading]:
    """Return all ways in which a name can be read as that of a leg."""
    yield from corners(words)
    yield from sides(words)
    yield from numbers(words)
    yield from rows(words)


def corners(words: Sequence[Word]) -> Iterator[Reading]:
    """Read a name as that of one of four or six legs."""
    letters = {LETTERS[word.text] for word in words if word.text in LETTERS}
    ends = {ENDS[word.text] for word in words if word.text in ENDS}
    pairs = product(ends, {SIDES[word.text] for word in words if word.text in SIDES})
    for position in sorted(letters.union(pairs)):
        agreeing = [index for index, word in enumerate(words) if word.agrees(position)]
        for slots in _runs(agreeing):
            if _tells_corner(words, slots) and not _one_foot(words, slots):
                order = _ORDER.index(position[0]), _ORDER.index(position[1])
                leg = "_".join(position)
                yield from (
                    Reading("corners", leg, position, order, scheme, slots)
                    for scheme in _schemes(words, slots)
                )


def _runs(indices: Sequence[int]) -> Iterator[frozenset[int]]:
    """Return all runs of words that may name the leg, the last and shortest first.

    The words before and after a run may be the same for all siblings.
    """
    last = indices[-_MOST_SLOTS:]
    for count in range(1, len(last) + 1):
        for end in range(len(last), count - 1, -1):
            yield frozenset(last[end - count : end])


def _schemes(words: Sequence[Word], slots: frozenset[int]) -> list[str]:
    """Return the ways of writing legs that the letters follow: ``rr`` follows both."""
    letters = [words[index].text for index in slots if words[index].text in LETTERS]
    if not letters:
        return ["words"]
    named = (("lf", SIDE_FIRST), ("fl", END_FIRST))
    schemes = [name for name, scheme in named if all(each in scheme for each in letters)]
    mixed = len(letters) < len(slots)
    return [f"{name} and words" for name in schemes] if mixed else schemes


def _tells_corner(words: Sequence[Word], slots: frozenset[int]) -> bool:
    """Tell whether words name one of four or six legs.

    In ``left_foot_front``, ``left_foot/fl`` and ``front_sensor/left_foot`` they name a sensor of
    one of two feet.
    """
    if not slots:
        return False
    first = min(slots)
    if words[first].text in SIDES and first + 1 < len(words) and words[first + 1].is_leg:
        return any(word.is_leg for word in words[first + 2 :]) and _tells_corner(
            words[first + 2 :], frozenset(index - first - 2 for index in slots if index > first + 1)
        )
    texts = [words[index].text for index in slots]
    ends = [index for index in slots if words[index].text in ENDS]
    if any(text in LETTERS for text in texts):
        return True
    of_sensors = [words[index + 1 : index + 2] for index in ends]
    if any(word.text in {"sensor", "sensors"} for after in of_sensors for word in after):
        return False
    return bool(ends) and any(text in SIDES for text in texts)


def joined(words: Sequence[Word], slots: frozenset[int]) -> bool:
    """Tell whether words that name one of four or six legs stand side by side."""
    chosen = [(index, words[index]) for index in sorted(slots)]
    return any(word.text in LETTERS for _, word in chosen) or any(
        other_at == at + 1
        and other.segment == word.segment
        and (word.text in ENDS) != (other.text in ENDS)
        for (at, word), (other_at, other) in pairwise(chosen)
    )


def sides(words: Sequence[Word]) -> Iterator[Reading]:
    """Read a name as that of one of two legs."""
    for number, side in enumerate(("left", "right")):
        agreeing = [index for index, word in enumerate(words) if SIDES.get(word.text) == side]
        for slots in _runs(agreeing):
            if not _one_foot(words, slots):
                # `l` and `left` never name the legs of one set.
                lengths = "".join(str(min(len(words[index].text), 2)) for index in sorted(slots))
                yield Reading("sides", side, None, (number, 0), lengths, slots)


def numbers(words: Sequence[Word]) -> Iterator[Reading]:
    """Read a name as that of one of several legs that are numbered, or lettered from a to h."""
    for index, word in enumerate(words):
        lettered = len(word.text) == 1 and word.text in "abcdefgh"
        if not (word.text.isdecimal() or lettered):
            continue
        beside = [one for one in words if one.segment == word.segment and one is not word]
        if not beside:
            beside = [one for one in words if one.segment == word.segment - 1][-1:]
        parts = [one.text for one in beside if one.is_leg]
        slots = frozenset({index})
        if parts and not _one_foot(words, slots):
            number = ord(word.text) - ord("a") if lettered else int(word.text[:9])
            order = (number, len(word.text))
            scheme = "letters" if lettered else "digits"
            yield Reading("numbers", f"{parts[-1]}_{word.text}", None, order, scheme, slots)


def rows(words: Sequence[Word]) -> Iterator[Reading]:
    """Read a name as that of one of two rows of numbered legs: ``l1``, ``left_leg_1``, ``leg1_l``.

    Which end the numbers begin at is not known, so such a leg has no position.
    """
    for index, word in enumerate(words):
        if word.text in ROWS:
            row, side = ROWS[word.text]
            yield _row_reading(side, row, frozenset({index}), "row and side")
        if not word.text.isdecimal():
            continue
        for step in (-1, 1):
            at = index + step
            if 0 <= at < len(words) and words[at].part is Part.LEG:
                at += step
            if not 0 <= at < len(words) or words[at].segment != word.segment:
                continue
            before = words[index - 1] if index else None
            if step > 0 and before and before.segment == word.segment and not before.is_leg:
                # The number of something else, as in `robot1_left_leg`.
                continue
            side_word = words[at].text
            slots = frozenset({index, at})
            if side_word in SIDES and not (
                _one_foot(words, slots) or _may_number_sensors(words, slots)
            ):
                scheme = f"{len(side_word) > 1} {step}"
                yield _row_reading(SIDES[side_word], word.text, slots, scheme)


def _may_number_sensors(words: Sequence[Word], slots: frozenset[int]) -> bool:
    """Tell whether a number may be that of one of a foot's sensors, as in ``left_foot_1``."""
    one, other = min(slots), max(slots)
    inside = {word.part for word in words if word.segment == words[one].segment}
    is_one_word = other == one + 1 and not words[other].gap
    return Part.FOOT in inside and Part.LEG not in inside and not is_one_word


def _row_reading(side: str, row: str, slots: frozenset[int], scheme: str) -> Reading:
    number = int(row[:9]) if row.isdecimal() else ord(row) - ord("a")
    order = (number, _ORDER.index(side))
    return Reading("numbers", f"{side}_{row}", None, order, f"rows {scheme}", slots)


def _one_foot(words: Sequence[Word], slots: frozenset[int]) -> bool:
    """Tell whether the words outside the slots name one foot: its siblings are its sensors."""
    for index, (one, other) in enumerate(pairwise(words)):
        if index in slots or index + 1 in slots or one.segment != other.segment:
            continue
        named = (one.is_leg and other.is_position) or (other.is_leg and one.is_position)
        if named and _says_only_leg(words, one.segment, slots):
            return True
    return False


def _says_only_leg(words: Sequence[Word], segment: int, slots: frozenset[int]) -> bool:
    """Tell whether a segment is about a leg: ``left_leg_controller`` is not, without a slot."""
    inside = [index for index, word in enumerate(words) if word.segment == segment]
    return not slots.isdisjoint(inside) or all(
        words[index].is_leg
        or words[index].is_position
        or words[index].text in NEUTRAL
        or words[index].text.isdecimal()
        for index in inside
    )


def describing_words(words: Sequence[Word], slots: frozenset[int]) -> list[Word]:
    """Return the words that describe the leg: of its segment, of those after, and just before.

    A segment before counts only if it says nothing else, as ``/foot_sensors/`` and ``/desired/``.
    """
    first = words[min(slots)].segment
    before = [word for word in words if word.segment == first - 1]
    telling = all(
        word.part is not None or word.text in NEUTRAL or word.text in MERITS for word in before
    )
    outside = [word for index, word in enumerate(words) if index not in slots]
    return [
        word for word in outside if word.segment >= first or (telling and word.segment == first - 1)
    ]


def named_part(words: Sequence[Word], slots: frozenset[int]) -> Part:
    """Return the part of a body that a name is about; words beside the leg's decide first."""
    near = describing_words(words, slots)
    first = words[min(slots)].segment
    for group in ([word for word in near if word.segment >= first], near):
        parts = [word.part for word in group if word.part is not None]
        if parts:
            if Part.FOOT in parts:
                return Part.FOOT
            split = not {"upper", "lower"}.isdisjoint(word.text for word in group)
            return Part.UPPER_LEG if split and Part.LEG in parts else min(parts)
    return Part.UNKNOWN


def is_doubtful(words: Sequence[Word], slots: frozenset[int]) -> bool:
    """Tell whether the segment before the leg's names something that is no foot.

    So are the numbers in ``foot_l1`` doubtful: they may be those of the sensors of one foot.
    """
    first = words[min(slots)].segment
    inside = {word.part for word in words if word.segment == first}
    if len(slots) > 1 and any(words[index].text.isdecimal() for index in slots):
        return Part.FOOT in inside and Part.LEG not in inside
    return any(word.part is Part.NOT_A_FOOT for word in words if word.segment == first - 1)
