"""Topics whose names differ in nothing but the leg, or also in the place on each foot."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations, takewhile
from typing import Final

from dogbot_logtool.reader.foot import Foot
from dogbot_logtool.robot.readings import Reading, readings_of
from dogbot_logtool.robot.words import (
    LETTERS,
    MERITS,
    NEUTRAL,
    ON_A_FOOT,
    PARTS,
    USABLE,
    Part,
    Word,
    words_of,
)

_MANY: Final = 3
"""Legs from which names that say no more than the leg are believed; a robot has four or six."""
_NUMBERED: Final = 4
"""Legs from which numbers are believed; two may as well be two sensors of a foot."""
_MOST_SLOTS: Final = 4
"""Words of a name that may name its leg together."""


@dataclass(frozen=True, slots=True)
class FootSet:
    """Topics whose names differ only in the leg, or also in the place on each foot."""

    feet: tuple[Foot, ...]
    """In the order front to back, left before right, or of their numbers."""
    kind: str
    """``corners``, ``sides`` or ``numbers``; ``alone``: they are no siblings."""
    part: Part
    words: frozenset[str]
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
    def order(self) -> tuple[int, int]:
        """What sorts sets of which one may be a part of another: large ones come first."""
        return -len(self.feet), ("corners", "sides", "numbers").index(self.kind)

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


def sibling_sets(names: Mapping[str, Sequence[Word]]) -> Iterator[FootSet]:
    """Yield all sets of at least two siblings: their names differ in some words, and no others."""
    alike: dict[object, list[str]] = {}
    for topic, words in names.items():
        shape = tuple((word.gap, word.slot or word.text) for word in words)
        alike.setdefault(shape, []).append(topic)
    for topics in alike.values():
        columns = [
            {word.text for word in each}
            for each in zip(*map(names.__getitem__, topics), strict=True)
        ]
        varying = [at for at, texts in enumerate(columns) if len(texts) > 1]
        for slots in _slots(varying[-_MOST_SLOTS:], names[topics[0]]):
            found: dict[object, dict[str, list[tuple[Reading, str]]]] = {}
            for topic in topics:
                same = tuple(names[topic][at].text for at in varying if at not in slots)
                for reading in readings_of(names[topic], slots):
                    legs = found.setdefault((reading.kind, same), {})
                    legs.setdefault(reading.leg, []).append((reading, topic))
            for legs in found.values():
                # Two topics of one leg whose names differ in letter case only: none is the leg's.
                feet = [entries[0] for entries in legs.values() if len(entries) == 1]
                if len(feet) > 1:
                    feet.sort(key=lambda entry: entry[0].order)
                    yield _foot_set(feet, names[feet[0][1]], slots)


def _slots(varying: Sequence[int], words: Sequence[Word]) -> Iterator[frozenset[int]]:
    """Yield the words that may name the leg together.

    If all legs have the same end or the same side, its word may be that of a robot or a controller:
    it is a leg's only beside the other one, as in ``front_left`` and ``front_right``.
    """
    for count in range(1, len(varying) + 1):
        yield from map(frozenset, combinations(varying, count))
    for one, other in (pair for at in varying for pair in ((at, at - 1), (at, at + 1))):
        if 0 <= other < len(words) and other not in varying:
            told = {words[at].slot.replace("l or r", "side") for at in (one, other)}
            named = told in ({"end", "side"}, {"number", "side"})
            if named and words[one].segment == words[other].segment:
                yield frozenset((one, other))


def _foot_set(
    feet: Sequence[tuple[Reading, str]], words: Sequence[Word], slots: frozenset[int]
) -> FootSet:
    """Return siblings as a set; the first one's words stand for all."""
    first = words[min(slots)].segment
    before = [word for word in words if word.segment == first - 1]
    # A segment before the leg's describes it only if it says nothing else, as `/foot_sensors/`.
    telling = all(word.part is not None or word.text in NEUTRAL | MERITS.keys() for word in before)
    near = [w for at, w in enumerate(words) if at not in slots and w.segment >= first - telling]
    parts = [word.part for word in near if word.part is not None]
    doubtful = any(word.part is Part.NOT_A_FOOT for word in before)
    if len(slots) > 1 and any(words[at].slot == "number" for at in slots):
        # The numbers in `foot_l1` may be those of the sensors of one foot.
        inside = {word.part for word in words if word.segment == first}
        doubtful = Part.FOOT in inside and Part.LEG not in inside
    return FootSet(
        tuple(Foot(each.leg, topic, leg_position=each.position) for each, topic in feet),
        feet[0][0].kind,
        Part.FOOT if Part.FOOT in parts else min(parts, default=Part.UNKNOWN),
        frozenset(word.text for word in near),
        letters_only=all(words[at].text in LETTERS for at in slots),
        doubtful=doubtful,
    )


def with_several(sets: Sequence[FootSet]) -> Iterator[FootSet]:
    """Yield the feet of which each has the same sensors, as ``left_toe`` and ``left_heel``.

    Their names differ in a place on the foot. Where all of them can be legs, they are.
    """
    alike: dict[tuple[str, tuple[str, ...], frozenset[str]], list[FootSet]] = {}
    for one in sets:
        legs, rest = tuple(foot.name for foot in one.feet), one.words - ON_A_FOOT
        if one.kind != "numbers" and rest != one.words:
            alike.setdefault((one.kind, legs, rest), []).append(one)
    all_legs = [one.topics for one in sets]
    corners = {topic for one in sets if one.kind == "corners" for topic in one.topics}
    for (_, _, words), (first, *others) in alike.items():
        feet = tuple(
            replace(foot, name=f"{foot.name}_{number}", sensor_of=foot.name)
            for number, one in enumerate((first, *others), start=1)
            for foot in one.feet
        )
        topics = frozenset(foot.topic for foot in feet)
        is_grid = len(topics) == len(feet) and any(_on_one_foot(first, one) for one in others)
        is_leg = first.kind == "corners" or corners.isdisjoint(topics)
        if is_grid and is_leg and not any(topics <= other for other in all_legs):
            yield replace(first, feet=feet, words=words)


def _on_one_foot(one: FootSet, other: FootSet) -> bool:
    """Tell whether names differ in a place on the foot, and not in the robot that it is of.

    Words such as toe and heel may stand before the leg's, numbers, letters and ends only behind.
    """
    if (one.words ^ other.words) & PARTS.keys():
        return True
    left, right, left_too = (foot.topic for foot in (*one.feet[:2], other.feet[0]))
    return _words_alike(left, left_too) > _words_alike(left, right)


def _words_alike(one: str, other: str) -> int:
    """Count the words with which two names begin alike."""
    pairs = zip(words_of(one), words_of(other), strict=False)
    return sum(1 for _ in takewhile(lambda pair: pair[0] == pair[1], pairs))
