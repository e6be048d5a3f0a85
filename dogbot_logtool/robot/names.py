"""Which foot a topic tells of, judged by the names of all topics of its type together.

One name alone misleads: ``rl_controller`` is no left hind leg and the ``front`` of
``left_foot_front`` is no front leg. So topics are compared with their siblings:

1. Every name is read in all ways that name a leg: as one of four or six legs (`LETTERS`, or an end
   and a side), as one of two (a side), as one of several that are numbered. The words that name the
   leg are replaced by a slot; where a name has several such words, as ``/left_leg/left_foot``, the
   last one is tried first, then others and more of them. The rest of the name is the template.
2. Names with the same template are siblings: they differ in nothing but the leg. Words that all of
   them share, such as a robot's or a controller's name, thereby stay in the template.
3. A set of siblings is dropped if its template says that it is no foot (`PARTS`), or that its
   topics are several sensors of one foot (``/left_foot/front_{side}``).
4. The rest are ranked: by the part of the leg that they name, then by what they tell of it
   (`MERITS`: a measured force before a planned one, one without offset before the raw one).
   A single best one that is clear is chosen. All others are offered to the user.
"""

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Final

from dogbot_logtool.core.leg_position import LegPosition
from dogbot_logtool.reader.foot import Foot
from dogbot_logtool.robot.readings import Reading, position_of, readings_of
from dogbot_logtool.robot.words import (
    ENDS,
    LETTERS,
    MERITS,
    NEUTRAL,
    SIDES,
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
_MOST_LEGS: Final = 16
_MOST_TOPICS: Final = 2000
"""Topics of a type whose names are compared; no robot has more."""
_KINDS: Final = ("corners", "sides", "numbers")


@dataclass(frozen=True, slots=True)
class FootSet:
    """Topics whose names differ only in the leg."""

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
        if self.kind == "numbers":
            return is_leg and len(self.feet) >= _NUMBERED
        if self.kind == "sides":
            return is_leg or (contacts_only and self.words.isdisjoint({"bumper", "bumpers"}))
        ends = {foot.leg_position[0] for foot in self.feet if foot.leg_position}
        fronts = self.letters_only and ends == {"front"}
        return len(self.feet) >= _MANY or ((is_leg or contacts_only) and not fronts)


@dataclass(frozen=True, slots=True)
class FootNames:
    """Feet as the names of topics give them."""

    chosen: FootSet | None = None
    """None: no set is clearly the feet."""
    offered: tuple[FootSet, ...] = ()
    """Sets that may be the feet, the most likely first, without the chosen one."""


def leg_position(name: str) -> LegPosition | None:
    """Return where a leg sits whose name is given, such as ``hind_left`` or ``LF_FOOT``.

    None where the name does not tell, or tells several.
    """
    return position_of(
        [word.text for word in words_of(name) if word.is_position or word.text in ENDS]
    )


def name_feet(topics: Iterable[str], *, contacts_only: bool) -> FootNames:
    """Find the feet among the topics of one message type.

    Args:
        topics: their names.
        contacts_only: such messages tell of contacts and of nothing else, so that every topic may
            be a foot's. Else only those may be whose names say so.
    """
    names = {topic: words_of(topic) for topic in sorted(set(topics))[:_MOST_TOPICS]}
    sets: list[FootSet] = []
    for one in sorted(
        _sibling_sets(names), key=lambda one: (-len(one.feet), _KINDS.index(one.kind))
    ):
        # Parts of another set say nothing; of several of the same topics, the first one stands.
        if not any(one.topics <= other.topics for other in sets):
            sets.append(one)
    possible = [one for one in sets if _may_be_feet(one, contacts_only=contacts_only)]
    ranked = sorted(possible, key=_rank)
    clear = [one for one in ranked if one.is_clear(contacts_only=contacts_only)]
    chosen = None
    if clear and (len(clear) == 1 or _rank(clear[0]) < _rank(clear[1])):
        chosen = clear[0]
    offered = [one for one in ranked if one is not chosen]
    in_sets = {topic for one in sets for topic in one.topics}
    rest = {topic: words for topic, words in names.items() if topic not in in_sets}
    return FootNames(chosen, (*offered, *_alone(rest, contacts_only=contacts_only)))


def _rank(one: FootSet) -> tuple[int, int]:
    return -one.part, -one.merit


def _may_be_feet(one: FootSet, *, contacts_only: bool) -> bool:
    """Tell whether a set is worth offering: forces of any left and right thing are not."""
    if one.kind == "sides" and one.part == Part.UNKNOWN and not contacts_only:
        said = one.words - NEUTRAL - MERITS.keys()
        return not one.doubtful and not any(map(str.isalpha, said))
    return one.part > Part.NOT_A_FOOT and len(one.feet) <= _MOST_LEGS


def _sibling_sets(names: Mapping[str, Sequence[Word]]) -> Iterator[FootSet]:
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


def _alone(names: Mapping[str, Sequence[Word]], *, contacts_only: bool) -> Iterator[FootSet]:
    """Yield topics without siblings that may be feet, as one set to offer."""
    topics = {
        topic: foot_name(topic)
        for topic, words in names.items()
        if _may_be_foot(words, contacts_only=contacts_only)
    }
    counts = Counter(topics.values())
    feet = [
        Foot(name if counts[name] == 1 else _sanitised(topic), topic)
        for topic, name in topics.items()
    ]
    if unique := tuple({foot.name: foot for foot in feet}.values())[:_MOST_LEGS]:
        yield FootSet(unique, "alone", Part.UNKNOWN, frozenset())


def _may_be_foot(words: Sequence[Word], *, contacts_only: bool) -> bool:
    """Tell whether a single topic may be a foot's."""
    parts = {word.part for word in words}
    if Part.FOOT in parts or Part.NOT_A_FOOT in parts:
        return Part.FOOT in parts
    return contacts_only or (Part.LEG in parts and any(word.is_position for word in words))


def label_names(labels: Sequence[str]) -> list[Foot]:
    """Return feet that messages call by labels, in their order; ``topic`` is the label.

    Labels that differ in the leg only are read together: ``BR_tip`` is a middle leg beside
    ``AR_tip``, and else a hind one.
    """
    found = name_feet(labels, contacts_only=True)
    for together in (found.chosen, *found.offered):
        if together and together.kind != "alone" and together.topics == set(labels):
            by_label = {foot.topic: foot for foot in together.feet}
            return [by_label[label] for label in labels]
    return [Foot(foot_name(label), label, leg_position=leg_position(label)) for label in labels]


def foot_name(label: str) -> str:
    """Return a name for a foot that messages call by a label, such as ``LF_FOOT``."""
    words = words_of(label)
    if position := leg_position(label):
        return "_".join(position)
    sides = {SIDES[word.text] for word in words if word.text in SIDES}
    slots = [at for at, word in enumerate(words) if word.slot][-_MOST_SLOTS:]
    read = (each for at in slots for each in readings_of(words, frozenset({at})))
    names = sides if len(sides) == 1 else {each.leg for each in read if each.kind == "numbers"}
    return names.pop() if len(names) == 1 else _sanitised(label)


def _sanitised(topic: str) -> str:
    return re.sub(r"[^A-Za-z0-9]+", "_", topic).strip("_") or "foot"
