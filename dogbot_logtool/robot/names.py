"""Which foot a topic tells of, judged by the names of all topics of its type together.

One name alone misleads: ``rl_controller`` is no left hind leg and the ``front`` of
``left_foot_front`` is no front leg. So topics are compared with their siblings:

1. Names are siblings that differ in nothing but words that may name a leg or a place on a foot.
   Words in which all siblings agree, such as a robot's or a controller's name, name no leg.
2. The words that differ are read as legs: as one of four or six (`LETTERS`, or an end and a side),
   as one of two rows of numbered legs, as one of several that are numbered, or as one of two (a
   side). Where several topics are about one leg, the other words that differ tell its sensors
   apart, or else two robots.
3. A set of siblings is dropped if its words say that it is no foot (`PARTS`) or name one foot,
   whose sensors its topics are (``/left_foot/front_{side}``).
4. The rest are ranked: by the part of the leg that they name, then by what they tell of it
   (`MERITS`: a measured force before a planned one, one without offset before the raw one).
   A single best one that is clear is chosen. All others are offered to the user.
"""

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Final

from dogbot_logtool.reader.foot import Foot
from dogbot_logtool.robot.leg_names import KINDS, Leg, foot_name, leg_position, sanitised
from dogbot_logtool.robot.words import (
    LETTERS,
    MERITS,
    NEUTRAL,
    ON_A_FOOT,
    USABLE,
    Part,
    Word,
    words_of,
)

_MOST_LEGS: Final = 16
_MOST_TOPICS: Final = 2000
"""Topics of a type whose names are compared; no robot has more."""
_MANY: Final = 3
"""Legs from which names that say no more than the leg are believed; a robot has four or six."""
_NUMBERED: Final = 4
"""Legs from which numbers are believed; two may as well be two sensors of a foot."""
Group = Mapping[str, Sequence[Word]]
"""Words of names by topic."""


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
    def rank(self) -> tuple[int, int]:
        """What sorts sets: the part of the leg, then how good its topics are."""
        return -self.part, -self.merit

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

    def may_be_feet(self, *, contacts_only: bool) -> bool:
        """Tell whether it is worth offering: forces of any left and right thing are not."""
        if self.kind == "sides" and self.part == Part.UNKNOWN and not contacts_only:
            distinct = self.words - NEUTRAL - MERITS.keys()
            return not self.doubtful and not any(map(str.isalpha, distinct))
        return self.part > Part.NOT_A_FOOT and len(self.feet) <= _MOST_LEGS


def name_feet(
    topics: Iterable[str], *, contacts_only: bool
) -> tuple[FootSet | None, tuple[FootSet, ...]]:
    """Find the feet among the topics of one message type.

    Args:
        topics: their names.
        contacts_only: such messages tell of contacts and of nothing else, so that every topic may
            be a foot's. Else only those may be whose names say so.

    Returns:
        the set that is clearly the feet, None where none is; and others that may be, the most
        likely first.
    """
    names = {topic: words_of(topic) for topic in sorted(set(topics))[:_MOST_TOPICS]}
    groups: dict[object, dict[str, Sequence[Word]]] = {}
    for topic, words in names.items():
        template = tuple((word.segment, word.slot or word.text) for word in words)
        groups.setdefault(template, {})[topic] = words
    sets = [one for group in groups.values() for one in _sets(group, contacts_only=contacts_only)]
    possible = [one for one in sets if one.may_be_feet(contacts_only=contacts_only)]
    in_sets = {topic for one in sets for topic in one.topics}
    rest = {topic: words for topic, words in names.items() if topic not in in_sets}
    possible.sort(key=lambda one: (one.rank, -len(one.feet)))
    ranked = [*possible, *_alone(rest, contacts_only=contacts_only)]
    clear = [one for one in ranked if one.is_clear(contacts_only=contacts_only)]
    chosen = None
    if clear and (len(clear) == 1 or clear[0].rank < clear[1].rank):
        chosen = clear[0]
    return chosen, tuple(one for one in ranked if one is not chosen)


# --- siblings ------------------------------------------------------------------------------------


def _sets(group: Group, *, contacts_only: bool) -> Iterator[FootSet]:
    """Yield siblings as sets of feet; more than one set where they are of several robots."""
    differ = _that_differ(group.values())
    kind, legs = _read_legs(group, differ)
    if not legs or _name_one_foot(next(iter(group.values())), differ):
        return
    of_leg: dict[str, dict[str, Sequence[Word]]] = {}
    for topic in sorted(group, key=lambda topic: legs[topic].order):
        of_leg.setdefault(legs[topic].name, {})[topic] = group[topic]
    if len(of_leg) == len(group) > 1:
        yield _as_feet(group, legs, kind)
        return
    others = sorted({at for own in of_leg.values() for at in _that_differ(own.values())})
    parts: dict[tuple[str, ...], dict[str, Sequence[Word]]] = {}
    for own in of_leg.values():
        for topic, words in own.items():
            parts.setdefault(tuple(words[at].text for at in others), {})[topic] = words
    is_grid = len(of_leg) > 1 and all(len(part) == len(of_leg) for part in parts.values())
    if kind != "numbers" and is_grid and _are_places(group, legs, others):
        sensors = [part for _, part in sorted(parts.items())]
        several = _as_feet(group, legs, kind, sensors)
        if several.is_clear(contacts_only=contacts_only):
            yield several
            return
    for part in parts.values() if len(parts) > 1 else ():
        yield from _sets(part, contacts_only=contacts_only)


def _that_differ(names: Iterable[Sequence[Word]]) -> list[int]:
    """Return which words of siblings differ."""
    columns = enumerate(zip(*names, strict=True))
    return [at for at, words in columns if len({word.text for word in words}) > 1]


def _read_legs(group: Group, differ: Sequence[int]) -> tuple[str, dict[str, Leg]]:
    """Return the leg of each name, all read in the same way, and its kind; none: no way fits."""
    for kind, read in KINDS if differ else ():
        legs = {topic: leg for topic, words in group.items() if (leg := read(words, differ))}
        if len(legs) == len(group):
            return kind, legs
    return "", {}


def _are_places(group: Group, legs: Mapping[str, Leg], others: Sequence[int]) -> bool:
    """Tell whether the other words that differ are places on a foot.

    Words such as toe and heel may stand before the leg's, numbers, letters and ends only behind.
    """
    return all(
        words[at].text in ON_A_FOOT and (at > legs[topic].slots[0] or words[at].part is not None)
        for topic, words in group.items()
        for at in others
    )


def _as_feet(
    group: Group,
    legs: Mapping[str, Leg],
    kind: str,
    sensors: Sequence[Group] = (),
) -> FootSet:
    """Return siblings as feet, or as the sensors of each foot; one's words stand for all."""
    topics = sorted(group, key=lambda topic: legs[topic].order)
    words, slots = group[topics[0]], legs[topics[0]].slots
    first = words[slots[0]].segment
    before = [word for word in words if word.segment == first - 1]
    # A segment before the leg's describes it only if it says nothing else, as `/foot_sensors/`.
    telling = all(word.part is not None or word.text in NEUTRAL | MERITS.keys() for word in before)
    near = [w for at, w in enumerate(words) if at not in slots and w.segment >= first - telling]
    parts = [word.part for word in near if word.part is not None]
    doubtful = any(word.part is Part.NOT_A_FOOT for word in before)
    if len(slots) > 1 and kind == "numbers":
        # The numbers in `foot_l1` may be those of the sensors of one foot.
        inside = {word.part for word in words if word.segment == first}
        doubtful = Part.FOOT in inside and Part.LEG not in inside
    near_words = frozenset(word.text for word in near)
    feet = [Foot(legs[t].name, t, leg_position=legs[t].position) for t in topics]
    if sensors:
        near_words -= ON_A_FOOT
        number = {topic: n for n, part in enumerate(sensors, start=1) for topic in part}
        feet = [replace(f, name=f"{f.name}_{number[f.topic]}", sensor_of=f.name) for f in feet]
        feet.sort(key=lambda foot: number[foot.topic])
    return FootSet(
        tuple(feet),
        kind,
        Part.FOOT if Part.FOOT in parts else min(parts, default=Part.UNKNOWN),
        near_words,
        letters_only=all(words[at].text in LETTERS for at in slots),
        doubtful=doubtful,
    )


def _name_one_foot(words: Sequence[Word], differ: Sequence[int]) -> bool:
    """Tell whether words in which siblings agree name one foot: they are its sensors.

    A segment in which none differs must say nothing else: ``left_leg_controller`` names no leg.
    """
    for segment in {word.segment for word in words}:
        inside = [at for at, word in enumerate(words) if word.segment == segment]
        same = [at for at in inside if at not in differ]
        named = any(
            b == a + 1
            and (
                (words[a].is_leg and words[b].is_position)
                or (words[a].is_position and words[b].is_leg)
            )
            for a, b in pairwise(same)
        )
        agreed = [words[at] for at in same]
        telling = all(w.is_leg or w.is_position or w.text in NEUTRAL for w in agreed)
        if named and (len(same) < len(inside) or telling):
            return True
    return False


# --- topics without siblings, and labels ---------------------------------------------------------


def _alone(names: Group, *, contacts_only: bool) -> Iterator[FootSet]:
    """Yield topics without siblings that may be feet, as one set to offer."""
    topics = {
        topic: foot_name(topic)
        for topic, words in names.items()
        if _may_be_foot(words, contacts_only=contacts_only)
    }
    counts = Counter(topics.values())
    feet: dict[str, Foot] = {}
    for topic, name in topics.items():
        own = name if counts[name] == 1 else sanitised(topic)
        feet[own] = Foot(own, topic, leg_position=leg_position(name))
    if feet:
        yield FootSet(tuple(feet.values())[:_MOST_LEGS], "alone")


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
    chosen, others = name_feet(labels, contacts_only=True)
    for together in (chosen, *others):
        if together and together.kind != "alone" and together.topics == set(labels):
            by_label = {foot.topic: foot for foot in together.feet}
            return [by_label[label] for label in labels]
    return [Foot(foot_name(label), label, leg_position=leg_position(label)) for label in labels]
