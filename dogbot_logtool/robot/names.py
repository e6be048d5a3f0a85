"""Which foot a topic tells of, judged by the names of all topics of its type together.

One name alone misleads: ``rl_controller`` is no left hind leg and the ``front`` of
``left_foot_front`` is no front leg. So topics are compared with their siblings:

1. Names are siblings that differ in nothing but words that may name a leg or a place on a foot.
   Words in which all siblings agree, such as a robot's or a controller's name, name no leg.
2. The words that differ are read as legs: as one of four or six (`LETTERS`, or an end and a side),
   as one of two rows of numbered legs, as one of several that are numbered, or as one of two (a
   side). Where several topics are about one leg, the other words that differ tell its sensors
   apart, or else two robots.
3. A set of siblings is dropped if its words say that it is no foot (`PARTS`).
4. The rest are ranked: by the part of the leg that they name, then by what they tell of it
   (`MERITS`: a measured force before a planned one, one without offset before the raw one).
   A single best one that is clear is chosen. All others are offered to the user.
"""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Final, NamedTuple

from dogbot_logtool.core.settings import LegPosition
from dogbot_logtool.reader.foot import Foot
from dogbot_logtool.robot.words import (
    ENDS,
    LETTERS,
    MERITS,
    NEUTRAL,
    ROWS,
    SIDES,
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
_USABLE: Final = -2
"""Merit below which a topic tells no measured force: it is planned, or an error."""
_ORDER: Final = ("front", "middle", "back", "left", "right", "centre", "")
"""Ends and sides, as legs are sorted by them."""
Words = Sequence[Word]
Group = Mapping[str, Words]
"""Words of names by topic."""


class FootSet(NamedTuple):
    """Topics or fields that may be the feet of a robot, and what their names tell."""

    feet: tuple[Foot, ...]
    """In the order front to back, left before right, or of their numbers."""
    kind: str
    """``corners``, ``sides``, ``rows`` or ``numbers``, as names differ; of fields also ``elements``
    of an array or bits, of which messages have fewer."""
    part: Part = Part.UNKNOWN
    words: frozenset[str] = frozenset()
    """Words that describe the leg, without those that name it."""
    reasons: tuple[str, ...] = ()
    """What speaks for fields; none for topics."""

    @property
    def topics(self) -> frozenset[str]:
        """The topics."""
        return frozenset(foot.topic for foot in self.feet)

    @property
    def told(self) -> str:
        """The feet with their topics and fields, and what speaks for them."""
        feet = ", ".join(f"{foot.name} = {foot.word}" for foot in self.feet)
        return f"{feet} ({'; '.join(self.reasons)})" if self.reasons else feet

    @property
    def missing(self) -> tuple[str, ...]:
        """Names of legs that such a robot has and this set lacks."""
        there = {foot.leg_position for foot in self.feet if foot.leg_position}
        ends = dict.fromkeys(["front", "back", *(end for end, _ in there)] if there else ())
        pairs = [(end, side) for end in ends for side in ("left", "right")]
        return tuple("_".join(pair) for pair in pairs if pair not in there)

    @property
    def merit(self) -> int:
        """How good its words are for telling a foot's contact."""
        return sum(MERITS.get(word, 0) for word in self.words)

    @property
    def rank(self) -> tuple[int, int]:
        """What sorts sets, the best first: the part of the leg, then how good its words are."""
        return -self.part, -self.merit

    def is_clear(self, *, contacts_only: bool) -> bool:
        """Tell whether it may be taken for the feet without asking.

        Args:
            contacts_only: its messages tell of contacts, and of nothing else.
        """
        is_leg, count = self.part >= Part.LEG, len(self.feet)
        if self.merit < _USABLE or self.part < Part.UNKNOWN:
            return False
        if self.kind in {"rows", "numbers"}:
            return is_leg and count >= _NUMBERED
        if self.kind == "sides":
            return is_leg or (contacts_only and self.words.isdisjoint({"bumper", "bumpers"}))
        # The legs of `lf` and `rf` alone may also be a left and a right foot.
        ends = {foot.leg_position[0] for foot in self.feet if foot.leg_position}
        return count >= _MANY or ((is_leg or contacts_only) and ends != {"front"})

    def may_be_feet(self, *, contacts_only: bool) -> bool:
        """Tell whether it is worth offering: forces of any two or numbered things are not."""
        is_anything = self.kind in {"sides", "numbers"} and self.part == Part.UNKNOWN
        is_anything &= not contacts_only
        return self.part > Part.NOT_A_FOOT and len(self.feet) <= _MOST_LEGS and not is_anything


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
    groups: dict[object, dict[str, Words]] = {}
    for topic, words in names.items():
        template = tuple((word.segment, word.slot or word.text) for word in words)
        groups.setdefault(template, {})[topic] = words
    sets = [one for group in groups.values() for one in _sets(group)]
    possible = [one for one in sets if one.may_be_feet(contacts_only=contacts_only)]
    possible.sort(key=lambda one: (one.rank, -len(one.feet)))
    clear = [one for one in possible if one.is_clear(contacts_only=contacts_only)]
    is_best = len(clear) == 1 or (clear and clear[0].rank < clear[1].rank)
    chosen = clear[0] if is_best else None
    if contacts_only and len(names) == 1:
        ((topic, words),) = names.items()
        chosen = _lone_foot(topic, words)
    return chosen, tuple(one for one in possible if one is not chosen)


def _lone_foot(topic: str, words: Words) -> FootSet | None:
    """Return the one foot that tells of contacts, where its name says where it sits."""
    name = foot_name(topic)
    position = leg_position(name)
    parts = {word.part for word in words}
    if position is None or parts & {Part.NOT_A_FOOT, Part.UPPER_LEG}:
        return None
    return FootSet((Foot(name, topic, leg_position=position),), "corners")


# --- siblings ------------------------------------------------------------------------------------


def _sets(group: Group) -> Iterator[FootSet]:
    """Yield siblings as sets of feet; more than one set where they are of several robots."""
    legs = _read_legs(group, _that_differ(group.values()))
    if not legs:
        return
    of_leg: dict[str, dict[str, Words]] = {}
    for topic, words in group.items():
        of_leg.setdefault(legs[topic].name, {})[topic] = words
    if len(of_leg) == len(group):
        yield _as_feet(group, legs)
        return
    others = sorted({at for own in of_leg.values() for at in _that_differ(own.values())})
    parts: dict[tuple[str, ...], dict[str, Words]] = {}
    for own in of_leg.values():
        for topic, words in own.items():
            parts.setdefault(tuple(words[at].text for at in others), {})[topic] = words
    is_grid = len(of_leg) > 1 and all(len(part) == len(of_leg) for part in parts.values())
    if is_grid and _are_places(group, legs, others):
        yield _as_feet(group, legs, [part for _, part in sorted(parts.items())])
        return
    for part in parts.values() if len(parts) > 1 else ():
        yield from _sets(part)


def _that_differ(names: Iterable[Words]) -> list[int]:
    """Return which words of siblings differ."""
    columns = enumerate(zip(*names, strict=True))
    return [at for at, words in columns if len({word.text for word in words}) > 1]


def _are_places(group: Group, legs: "Mapping[str, _Leg]", others: Sequence[int]) -> bool:
    """Tell whether the other words that differ are places on a foot.

    Words such as toe and heel may stand before the leg's, numbers, letters and ends only behind.
    """
    return all(
        legs[topic].kind != "rows"
        and words[at].slot
        and (at > legs[topic].slots[0] or words[at].part is not None)
        for topic, words in group.items()
        for at in others
    )


def _as_feet(group: Group, legs: "Mapping[str, _Leg]", sensors: Sequence[Group] = ()) -> FootSet:
    """Return siblings as feet, or as the sensors of each foot; one's words stand for all."""
    topics = sorted(group, key=lambda topic: leg_order(legs[topic].name, legs[topic].position))
    words, (kind, _, slots, _) = group[topics[0]], legs[topics[0]]
    first = words[slots[0]].segment
    before = [word for word in words if word.segment == first - 1]
    # A segment before the leg's describes it only if it says nothing else, as `/foot_sensors/`.
    telling = all(word.part is not None or word.text in NEUTRAL | MERITS.keys() for word in before)
    near = [w for at, w in enumerate(words) if at not in slots and w.segment >= first - telling]
    parts = [word.part for word in near if word.part is not None]
    part = Part.FOOT if Part.FOOT in parts else min(parts, default=Part.UNKNOWN)
    if len(slots) > 1 and kind == "rows":
        # The numbers in `foot_l1` may be those of the sensors of one foot.
        inside = {word.part for word in words if word.segment == first}
        part = Part.UNKNOWN if Part.FOOT in inside and Part.LEG not in inside else part
    feet = [Foot(legs[t].name, t, leg_position=legs[t].position) for t in topics]
    if sensors:
        number = {topic: n for n, part in enumerate(sensors, start=1) for topic in part}
        feet = [replace(f, name=f"{f.name}_{number[f.topic]}", sensor_of=f.name) for f in feet]
        feet.sort(key=lambda foot: number[foot.topic])
    return FootSet(tuple(feet), kind, part, frozenset(word.text for word in near))


# --- words that are read as a leg ----------------------------------------------------------------


class _Leg(NamedTuple):
    """A name, understood as that of a leg."""

    kind: str
    """See `FootSet`."""
    name: str
    slots: tuple[int, ...]
    """The words that name it."""
    position: LegPosition | None = None


def _read_legs(group: Group, differ: Sequence[int]) -> dict[str, _Leg]:
    """Return the leg of each name, all read in the same way; none: no way fits."""
    for read in (_corner, _numbered, _side):
        legs = {topic: leg for topic, words in group.items() if (leg := read(words, differ))}
        if len(legs) == len(group) and len({leg.kind for leg in legs.values()}) == 1:
            return legs
    return {}


def _corner(words: Words, differ: Sequence[int]) -> _Leg | None:
    """Read words as one of four or six legs: ``lf``, ``front_left``.

    If all legs have the same end or the same side, its word may be that of a robot or a controller:
    it is a leg's only beside the other one, as in ``front_left`` and ``front_right``.
    """
    halves = [at for at, word in enumerate(words) if word.text in ENDS or word.text in SIDES]
    slots = [at for at in differ if at in halves or words[at].text in LETTERS]
    texts = {words[at].text for at in slots}
    if not slots:
        return None
    # The name of a sensor of one of two feet, as in `left_foot_front`; but `left_foot_fl` is clear.
    is_before_leg = any(word.is_leg for word in words[slots[0] + 1 : slots[0] + 2])
    if words[slots[0]].text in SIDES and is_before_leg and texts.isdisjoint(LETTERS):
        return None
    segments = {(at + step, words[at].segment) for at in slots for step in (-1, 1)}
    beside = {at for at in halves if (at, words[at].segment) in segments}
    own = sorted(beside.union(slots))
    end, side = position = _end_and_side(words[at].text for at in own)
    if not (end and side):
        return None
    return _Leg("corners", f"{end}_{side}", tuple(own), position)


def _numbered(words: Words, differ: Sequence[int]) -> _Leg | None:
    """Read words as a numbered leg, or as what may be one: ``leg_1``, ``leg/1``.

    It may be of one of two rows: ``l1``, ``left_leg_1``, ``leg1_l``, ``bl``. Which end the numbers
    begin at is not known, so such a leg has no position.
    """
    numbers = [at for at in differ if words[at].slot == "number"]
    for at in differ:
        if words[at].text in ROWS:
            row, side = ROWS[words[at].text]
            return _Leg("rows", f"{side}_{row}", (at,))
    for at in numbers:
        # Beside `leg` the side stands before or behind, else the number may be of something else.
        beside = {at - 2, at + 1} if words[at - 1].part is Part.LEG else {at - 1}
        for near in beside.intersection(differ):
            side = SIDES.get(words[near].text, "")
            if side and words[near].segment == words[at].segment:
                return _Leg("rows", f"{side}_{words[at].text}", (min(at, near), max(at, near)))
    if not numbers or len(differ) != 1:
        return None
    word = words[numbers[0]]
    beside_it = [one for one in words if one.segment == word.segment and one is not word]
    beside_it = beside_it or [one for one in words if one.segment == word.segment - 1][-1:]
    part = next((one.text for one in reversed(beside_it) if one.is_leg), "foot")
    return _Leg("numbers", f"{part}_{word.text}", tuple(differ))


def _side(words: Words, differ: Sequence[int]) -> _Leg | None:
    """Read a word as the side of one of two legs."""
    for at in differ:
        if side := SIDES.get(words[at].text):
            return _Leg("sides", side, (at,))
    return None


def _end_and_side(texts: Iterable[str]) -> LegPosition:
    """Return the end and the side that words tell; each empty where they tell none, or several."""
    told = [LETTERS.get(text) or (ENDS.get(text, ""), SIDES.get(text, "")) for text in texts]
    ends, sides = {end for end, _ in told if end}, {side for _, side in told if side}
    return (ends.pop() if len(ends) == 1 else ""), (sides.pop() if len(sides) == 1 else "")


# --- single names, and labels --------------------------------------------------------------------


def leg_of(name: str) -> LegPosition:
    """Return the end and the side of the robot that a name tells; each empty where it does not."""
    return _end_and_side(word.text for word in words_of(name))


def leg_position(name: str) -> LegPosition | None:
    """Return where a leg sits whose name is given, such as ``hind_left`` or ``LF_FOOT``.

    None where the name does not tell, or tells several.
    """
    position = leg_of(name)
    return position if all(position) else None


def leg_order(name: str, position: LegPosition | None) -> tuple[int, int, int, str, str]:
    """Return what sorts legs front to back, left before right; others by number, then by name."""
    end, side = position or ("", "")
    last = name.rpartition("_")[2]
    number = int(last[:9]) if last.isdecimal() else 0
    return _ORDER.index(end), _ORDER.index(side), number, last, name


def foot_name(label: str) -> str:
    """Return a name for a foot that messages call by a label, such as ``LF_FOOT``."""
    end, side = leg_of(label)
    if side:
        return f"{end}_{side}" if end else side
    words = words_of(label)
    legs = (_numbered(words, [at]) for at in range(len(words)))
    numbered = {leg.name for leg in legs if leg and leg.kind == "numbers"}
    return numbered.pop() if len(numbered) == 1 else _sanitised(label)


def _sanitised(name: str) -> str:
    """Return a name of letters, digits and underscores."""
    return re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_") or "foot"


def label_names(labels: Sequence[str]) -> list[Foot]:
    """Return feet that messages call by labels, in their order; ``topic`` is the label.

    Labels that differ in the leg only are read together: ``BR_tip`` is a middle leg beside
    ``AR_tip``, and else a hind one.
    """
    chosen, others = name_feet(labels, contacts_only=True)
    for together in (chosen, *others):
        if together and together.topics == set(labels):
            by_label = {foot.topic: foot for foot in together.feet}
            return [by_label[label] for label in labels]
    return [Foot(foot_name(label), label, leg_position=leg_position(label)) for label in labels]
