"""Names that differ in nothing but the leg, or also in the place on each foot.

Every name is read in all the ways in which some of its words, the slots, name a leg. Names that
are alike but for their slots are siblings.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from dogbot_logtool.reader.foot import Foot
from dogbot_logtool.robot.readings import Reading, names_one_foot, readings
from dogbot_logtool.robot.words import (
    LETTERS,
    MERITS,
    NEUTRAL,
    ON_A_FOOT,
    PARTS,
    USABLE,
    Part,
    Word,
)

_MANY: Final = 3
"""Legs from which names that say no more than the leg are believed; a robot has four or six."""
_NUMBERED: Final = 4
"""Legs from which numbers are believed; two may as well be two sensors of a foot."""
_KINDS: Final = ("corners", "sides", "numbers")


@dataclass(frozen=True, slots=True)
class FootSet:
    """Topics whose names differ only in the leg, or also in the place on each foot."""

    feet: tuple[Foot, ...]
    """In the order front to back, left before right, or of their numbers."""
    kind: str
    """``corners``, ``sides`` or ``numbers``; ``alone``: they are no siblings."""
    part: Part = Part.UNKNOWN
    words: frozenset[str] = frozenset()
    """Words that describe the leg, without those that name it."""
    letters_only: bool = False
    """Whether the legs are named by two letters, of which ``lf`` may also be a left foot."""
    doubtful: bool = False
    """Whether the segment before the leg's names something that is no foot."""

    @property
    def topics(self) -> frozenset[str]:
        """The topics."""
        return frozenset(foot.topic for foot in self.feet)

    @property
    def order(self) -> tuple[int, bool, int]:
        """What sorts sets of which one may be a part of another: the largest comes first."""
        has_several = any(foot.sensor_of for foot in self.feet)
        return -len(self.feet), has_several, _KINDS.index(self.kind)

    @property
    def missing(self) -> tuple[str, ...]:
        """Names of legs that such a robot has and this set lacks."""
        there = {foot.leg_position for foot in self.feet if foot.leg_position}
        ends = dict.fromkeys(["front", "back", *(end for end, _ in there)] if there else ())
        pairs = [(end, side) for end in ends for side in ("left", "right")]
        return tuple("_".join(pair) for pair in pairs if pair not in there)

    def completes(self, other: "FootSet") -> bool:
        """Tell whether these are the very feet that another set lacks, as other messages tell."""
        return self.is_usable and sorted(foot.name for foot in self.feet) == sorted(other.missing)

    @property
    def merit(self) -> int:
        """How good what it tells is for telling a foot's contact."""
        return sum(MERITS.get(word, 0) for word in self.words)

    @property
    def is_usable(self) -> bool:
        """Whether it tells of measured forces, and of no other part than a foot."""
        return self.merit >= USABLE and self.part >= Part.UNKNOWN and not self.doubtful

    def is_clear(self, *, contacts_only: bool) -> bool:
        """Tell whether it may be taken for the feet without asking.

        Args:
            contacts_only: its messages tell of contacts, and of nothing else.
        """
        is_leg = self.part >= Part.LEG
        if not self.is_usable:
            return False
        if self.kind == "alone":
            return len(self.feet) == 1 and contacts_only and bool(self.feet[0].leg_position)
        if self.kind == "numbers":
            return is_leg and len(self.feet) >= _NUMBERED
        if self.kind == "sides":
            return is_leg or (contacts_only and self.words.isdisjoint({"bumper", "bumpers"}))
        ends = {foot.leg_position[0] for foot in self.feet if foot.leg_position}
        fronts = self.letters_only and ends == {"front"}
        return len(self.feet) >= _MANY or ((is_leg or contacts_only) and not fronts)


@dataclass(frozen=True, slots=True)
class _Named:
    """A topic whose name is read as that of a leg."""

    topic: str
    reading: Reading
    slots: tuple[int, ...]
    place: tuple[str, ...] = ()
    """Words that may tell where on the foot a sensor is."""


def sibling_sets(names: Mapping[str, Sequence[Word]]) -> Iterator[FootSet]:
    """Yield all sets of at least two siblings, and of feet of which each has several sensors."""
    groups: dict[object, dict[str, list[_Named]]] = {}
    for topic, words in names.items():
        for slots, told_by in readings(words):
            places = tuple(at for at in range(len(words)) if _may_be_place(words, at, slots))
            told = tuple(words[at].text for at in places)
            for left_out in dict.fromkeys(((), places)):
                if names_one_foot(words, (*slots, *left_out)):
                    continue
                template = _template(words, slots, left_out)
                for reading in told_by:
                    legs = groups.setdefault((reading.kind, template), {})
                    legs.setdefault(reading.leg, []).append(_Named(topic, reading, slots, told))
    for legs in groups.values():
        rows = [sorted(row, key=lambda each: each.place) for row in legs.values()]
        rows.sort(key=lambda row: row[0].reading.order)
        if len(rows) > 1 and all(len(row) == 1 for row in rows):
            yield from _siblings([row[0] for row in rows], names)
        elif len(rows) > 1 and rows[0][0].reading.kind != "numbers":
            yield from _several(rows, names)


def _template(words: Sequence[Word], slots: Sequence[int], places: Sequence[int]) -> object:
    """Return what names have in common that differ only in some of their words."""
    kept = (
        word.slot if at in slots else "place" if at in places else word.text
        for at, word in enumerate(words)
    )
    return tuple(zip((word.gap for word in words), kept, strict=True))


def _may_be_place(words: Sequence[Word], at: int, slots: Sequence[int]) -> bool:
    """Tell whether a word may be that of one of several sensors of a foot.

    Words such as toe and heel may stand before the leg's, numbers, letters and ends only behind.
    """
    word = words[at]
    return at not in slots and word.text in ON_A_FOOT and (at > slots[0] or word.text in PARTS)


def _siblings(feet: Sequence[_Named], names: Mapping[str, Sequence[Word]]) -> Iterator[FootSet]:
    """Yield feet as a set; the first one's words stand for all.

    If all legs have the same end or the same side, its word may be that of a robot or a controller:
    it is a leg's only beside the other one, as in ``front_left`` and ``front_right``.
    """
    words, slots = names[feet[0].topic], feet[0].slots
    for at in slots:
        is_constant = len({names[each.topic][at].text for each in feet}) == 1
        if is_constant and not any(
            other in (at - 1, at + 1) and words[other].segment == words[at].segment
            for other in slots
        ):
            return
    first = words[slots[0]].segment
    before = [word for word in words if word.segment == first - 1]
    # A segment before the leg's describes it only if it says nothing else, as `/foot_sensors/`.
    telling = all(word.part is not None or word.text in NEUTRAL | MERITS.keys() for word in before)
    near = [w for at, w in enumerate(words) if at not in slots and w.segment >= first - telling]
    parts = [word.part for word in near if word.part is not None]
    doubtful = any(word.part is Part.NOT_A_FOOT for word in before)
    if len(slots) > 1 and feet[0].reading.kind == "numbers":
        # The numbers in `foot_l1` may be those of the sensors of one foot.
        inside = {word.part for word in words if word.segment == first}
        doubtful = Part.FOOT in inside and Part.LEG not in inside
    yield FootSet(
        tuple(Foot(e.reading.leg, e.topic, leg_position=e.reading.position) for e in feet),
        feet[0].reading.kind,
        Part.FOOT if Part.FOOT in parts else min(parts, default=Part.UNKNOWN),
        frozenset(word.text for word in near),
        letters_only=all(words[at].text in LETTERS for at in slots),
        doubtful=doubtful,
    )


def _several(
    rows: Sequence[Sequence[_Named]], names: Mapping[str, Sequence[Word]]
) -> Iterator[FootSet]:
    """Yield the feet of which each has the same sensors, as ``left_toe`` and ``left_heel``."""
    places = [each.place for each in rows[0]]
    if len(set(places)) < len(places) or any([e.place for e in row] != places for row in rows):
        return
    for first in _siblings([row[0] for row in rows], names):
        feet = [
            Foot(
                f"{each.reading.leg}_{number}",
                each.topic,
                leg_position=each.reading.position,
                sensor_of=each.reading.leg,
            )
            for number, sensors in enumerate(zip(*rows, strict=True), start=1)
            for each in sensors
        ]
        words = first.words - ON_A_FOOT
        yield FootSet(
            tuple(feet), first.kind, first.part, words, first.letters_only, first.doubtful
        )
