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
from dataclasses import dataclass, replace
from itertools import combinations, takewhile
from typing import Final

from dogbot_logtool.core.leg_position import LegPosition
from dogbot_logtool.robot.readings import Reading, describing, is_doubtful, part_of, readings_of
from dogbot_logtool.robot.words import (
    ENDS,
    LETTERS,
    MERITS,
    NEUTRAL,
    ON_A_FOOT,
    PARTS,
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


@dataclass(frozen=True, slots=True)
class NamedFoot:
    """A foot and its topic."""

    name: str
    topic: str
    position: LegPosition | None = None


@dataclass(frozen=True, slots=True)
class FootSet:
    """Topics whose names differ only in the leg, or also in the place on each foot."""

    feet: tuple[NamedFoot, ...]
    """In the order front to back, left before right, or of their numbers; sensors of one foot have
    one name."""
    kind: str
    """``corners``, ``sides`` or ``numbers``."""
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
        if self.kind != "corners":
            return ()
        there = {foot.position for foot in self.feet if foot.position}
        ends = dict.fromkeys(["front", "back", *(end for end, _ in there)])
        pairs = [(end, side) for end in ends for side in ("left", "right")]
        return tuple("_".join(pair) for pair in pairs if pair not in there)

    def completes(self, other: "FootSet") -> bool:
        """Tell whether these are the very feet that another set lacks, as other messages tell."""
        usable = self.merit >= USABLE and self.part >= Part.UNKNOWN and not self.doubtful
        return usable and sorted(foot.name for foot in self.feet) == sorted(other.missing)

    @property
    def merit(self) -> int:
        """How good what it tells is for telling a foot's contact."""
        return sum(MERITS.get(word, 0) for word in self.words)

    def is_clear(self, *, contacts_only: bool) -> bool:
        """Tell whether it may be taken for the feet without asking.

        Args:
            contacts_only: its messages tell of contacts, and of nothing else.
        """
        if self.merit < USABLE or self.part < Part.UNKNOWN or self.doubtful:
            return False
        is_leg = self.part >= Part.LEG
        if self.kind == "alone":
            return len(self.feet) == 1 and contacts_only and self.feet[0].position is not None
        if self.kind == "numbers":
            return is_leg and len(self.feet) >= _NUMBERED
        if self.kind == "sides":
            return is_leg or (contacts_only and self.words.isdisjoint({"bumper", "bumpers"}))
        if len(self.feet) >= _MANY:
            return True
        fronts = self.letters_only and {foot.position for foot in self.feet} == {
            ("front", "left"),
            ("front", "right"),
        }
        return (is_leg or contacts_only) and not fronts


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
    words = words_of(name)
    letters = {LETTERS[word.text] for word in words if word.text in LETTERS}
    ends = {ENDS[word.text] for word in words if word.text in ENDS}
    sides = {SIDES[word.text] for word in words if word.text in SIDES}
    pairs = letters | {(end, side) for end in ends for side in sides}
    return next(iter(pairs)) if len(pairs) == 1 else None


def name_feet(topics: Iterable[str], *, contacts_only: bool) -> FootNames:
    """Find the feet among the topics of one message type.

    Args:
        topics: their names.
        contacts_only: such messages tell of contacts and of nothing else, so that every topic may
            be a foot's. Else only those may be whose names say so.
    """
    names = {topic: words_of(topic) for topic in sorted(set(topics))[:_MOST_TOPICS]}
    siblings = list(_sibling_sets(names))
    several = [one for one in _with_several(siblings) if one.is_clear(contacts_only=contacts_only)]
    sets = [
        one
        for one in _without_parts(siblings)
        if not any(one.topics <= other.topics for other in several)
    ] + several
    possible = [one for one in sets if _may_be_feet(one, contacts_only=contacts_only)]
    ranked = sorted(possible, key=_rank)
    in_sets = {topic for one in sets for topic in one.topics}
    rest = {topic: words for topic, words in names.items() if topic not in in_sets}
    ranked += _alone(rest, contacts_only=contacts_only)
    clear = [one for one in ranked if one.is_clear(contacts_only=contacts_only)]
    chosen = None
    if clear and (len(clear) == 1 or _rank(clear[0]) < _rank(clear[1])):
        chosen = clear[0]
    return FootNames(chosen, tuple(one for one in ranked if one is not chosen))


def _rank(one: FootSet) -> tuple[int, int]:
    return -one.part, -one.merit


def _may_be_feet(one: FootSet, *, contacts_only: bool) -> bool:
    """Tell whether a set is worth offering: forces of any left and right thing are not."""
    if one.kind == "sides" and one.part == Part.UNKNOWN and not contacts_only:
        said = one.words - NEUTRAL - MERITS.keys()
        return not one.doubtful and not any(map(str.isalpha, said))
    return one.part > Part.NOT_A_FOOT and len(one.feet) <= _MOST_LEGS


def _sibling_sets(names: Mapping[str, Sequence[Word]]) -> Iterator[FootSet]:
    """Yield all sets of at least two siblings."""
    alike: dict[object, list[str]] = {}
    for topic, words in names.items():
        shape = tuple((word.gap, word.slot or word.text) for word in words)
        alike.setdefault(shape, []).append(topic)
    for topics in alike.values():
        columns = list(zip(*(names[topic] for topic in topics), strict=True))
        varying = [n for n, column in enumerate(columns) if len({w.text for w in column}) > 1]
        for slots in _slots(varying[-_MOST_SLOTS:], names[topics[0]]):
            yield from _siblings(topics, names, slots, frozenset(varying) - slots)


def _slots(varying: Sequence[int], words: Sequence[Word]) -> Iterator[frozenset[int]]:
    """Yield the words that may name the leg together.

    If all legs have the same end or the same side, its word may be that of a robot or a controller:
    it is a leg's only beside the other one, as in ``front_left`` and ``front_right``.
    """
    for count in range(1, len(varying) + 1):
        for chosen in combinations(varying, count):
            yield frozenset(chosen)
    for one, other in (pair for at in varying for pair in ((at, at - 1), (at, at + 1))):
        if 0 <= other < len(words) and other not in varying:
            told = {words[at].slot.replace("l or r", "side") for at in (one, other)}
            named = told in ({"end", "side"}, {"number", "side"})
            if named and words[one].segment == words[other].segment:
                yield frozenset((one, other))


def _siblings(
    topics: Sequence[str],
    names: Mapping[str, Sequence[Word]],
    slots: frozenset[int],
    others: frozenset[int],
) -> Iterator[FootSet]:
    """Yield the sets of topics whose names differ in some words, and not in some others."""
    found: dict[object, dict[str, list[tuple[Reading, str]]]] = {}
    for topic in topics:
        words = names[topic]
        same = tuple(words[at].text for at in sorted(others))
        for reading in readings_of(words, slots):
            legs = found.setdefault((reading.kind, reading.scheme, same), {})
            legs.setdefault(reading.leg, []).append((reading, topic))
    for legs in found.values():
        # Two topics of one leg whose names differ in letter case only: none is the leg's.
        feet = [entries[0] for entries in legs.values() if len(entries) == 1]
        if len(feet) > 1:
            feet.sort(key=lambda entry: entry[0].order)
            yield _foot_set(feet, names[feet[0][1]], slots)


def _foot_set(
    feet: Sequence[tuple[Reading, str]], words: Sequence[Word], slots: frozenset[int]
) -> FootSet:
    """Return siblings as a set; the first one's words stand for all."""
    near = describing(words, slots)
    return FootSet(
        tuple(NamedFoot(each.leg, topic, each.position) for each, topic in feet),
        feet[0][0].kind,
        part_of(near),
        frozenset(word.text for word in near),
        letters_only=all(words[at].text in LETTERS for at in slots),
        doubtful=is_doubtful(words, slots),
    )


def _without_parts(sets: Sequence[FootSet]) -> list[FootSet]:
    """Leave out sets that are a part of another; of several of the same topics, keep the first."""
    order = {"corners": 0, "sides": 1, "numbers": 2}
    by_size = sorted(sets, key=lambda one: (-len(one.feet), order[one.kind]))
    holders: dict[str, list[frozenset[str]]] = {}
    kept = []
    for one in by_size:
        topics = one.topics
        if not any(topics <= other for other in holders.get(one.feet[0].topic, ())):
            kept.append(one)
            for topic in topics:
                holders.setdefault(topic, []).append(topics)
    return kept


def _with_several(sets: Sequence[FootSet]) -> Iterator[FootSet]:
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
    for (_, _, rest), (first, *others) in alike.items():
        feet = tuple(foot for one in (first, *others) for foot in one.feet)
        topics = frozenset(foot.topic for foot in feet)
        is_grid = len(topics) == len(feet) and any(_on_one_foot(first, one) for one in others)
        is_leg = first.kind == "corners" or corners.isdisjoint(topics)
        if is_grid and is_leg and not any(topics <= other for other in all_legs):
            yield replace(first, feet=feet, words=rest)


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


def _alone(names: Mapping[str, Sequence[Word]], *, contacts_only: bool) -> list[FootSet]:
    """Return topics without siblings that may be feet, as one set to offer."""
    topics = {
        topic: _lone_name(topic, words)
        for topic, words in names.items()
        if _may_be_foot(words, contacts_only=contacts_only)
    }
    counts = Counter(topics.values())
    feet = [
        NamedFoot(name if counts[name] == 1 else _sanitised(topic), topic, leg_position(name))
        for topic, name in topics.items()
    ]
    unique = tuple({foot.name: foot for foot in feet}.values())[:_MOST_LEGS]
    return [FootSet(unique, "alone", Part.UNKNOWN, frozenset())] if unique else []


def _may_be_foot(words: Sequence[Word], *, contacts_only: bool) -> bool:
    """Tell whether a single topic may be a foot's."""
    parts = {word.part for word in words}
    if Part.FOOT in parts:
        return True
    if Part.NOT_A_FOOT in parts:
        return False
    return contacts_only or (Part.LEG in parts and any(word.is_position for word in words))


def label_names(labels: Sequence[str]) -> list[NamedFoot]:
    """Return feet that messages call by labels, in their order; ``topic`` is the label.

    Labels that differ in the leg only are read together: ``BR_tip`` is a middle leg beside
    ``AR_tip``, and else a hind one.
    """
    found = name_feet(labels, contacts_only=True)
    for together in (found.chosen, *found.offered):
        if together and together.kind != "alone" and together.topics == set(labels):
            by_label = {foot.topic: foot for foot in together.feet}
            return [by_label[label] for label in labels]
    return [NamedFoot(foot_name(label), label, leg_position(label)) for label in labels]


def foot_name(label: str) -> str:
    """Return a name for a foot that messages call by a label, such as ``LF_FOOT``."""
    return _lone_name(label, words_of(label))


def _lone_name(topic: str, words: Sequence[Word]) -> str:
    """Return a name for a foot whose topic has no siblings."""
    slots = [at for at, word in enumerate(words) if word.slot][-_MOST_SLOTS:]
    chosen = [frozenset(each) for n in range(1, 5) for each in combinations(slots, n)]
    found = [reading for each in chosen for reading in readings_of(words, each)]
    for kind in ("corners", "sides", "numbers"):
        legs = {each.leg for each in found if each.kind == kind}
        if len(legs) == 1:
            return legs.pop()
    return _sanitised(topic)


def _sanitised(topic: str) -> str:
    return re.sub(r"[^A-Za-z0-9]+", "_", topic).strip("_") or "foot"
