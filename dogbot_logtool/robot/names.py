"""Which foot a topic tells of, judged by the names of all topics of its type together.

One name alone misleads: ``rl_controller`` is no left hind leg and the ``front`` of
``left_foot_front`` is no front leg. So topics are compared with their siblings:

1. Every name is read in all ways that name a leg: as one of four or six legs (`LETTERS`, or an end
   and a side), as one of two (a side), as one of several that are numbered. The words that name the
   leg are replaced by a slot; the rest of the name is the template.
2. Names with the same template are siblings: they differ in nothing but the leg. Words that all of
   them share, such as a robot's or a controller's name, thereby stay in the template. Names that
   differ in a place on the foot, too, are sensors of the feet, if each foot has the same ones.
3. A set of siblings is dropped if its template says that it is no foot (`PARTS`) or names one foot,
   whose sensors its topics are (``/left_foot/front_{side}``).
4. The rest are ranked: by the part of the leg that they name, then by what they tell of it
   (`MERITS`: a measured force before a planned one, one without offset before the raw one).
   A single best one that is clear is chosen. All others are offered to the user.
"""

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from dogbot_logtool.core.leg_position import LegPosition
from dogbot_logtool.reader.foot import Foot
from dogbot_logtool.robot.readings import position_of, readings_of
from dogbot_logtool.robot.siblings import FootSet, sibling_sets
from dogbot_logtool.robot.words import (
    ENDS,
    MERITS,
    NEUTRAL,
    SIDES,
    Part,
    Word,
    words_of,
)

_MOST_LEGS: Final = 16
_MOST_TOPICS: Final = 2000
"""Topics of a type whose names are compared; no robot has more."""


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
    for one in sorted(sibling_sets(names), key=lambda one: one.order):
        # Parts of another set say nothing; of several of the same topics, the first one stands.
        is_whole = one.is_clear(contacts_only=contacts_only) or not one.feet[0].sensor_of
        if is_whole and not any(one.topics <= other.topics for other in sets):
            sets.append(one)
    possible = [one for one in sets if _may_be_feet(one, contacts_only=contacts_only)]
    in_sets = {topic for one in sets for topic in one.topics}
    rest = {topic: words for topic, words in names.items() if topic not in in_sets}
    ranked = sorted(possible, key=_rank) + list(_alone(rest, contacts_only=contacts_only))
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


def _alone(names: Mapping[str, Sequence[Word]], *, contacts_only: bool) -> Iterator[FootSet]:
    """Yield topics without siblings that may be feet, as one set to offer."""
    topics = {
        topic: foot_name(topic)
        for topic, words in names.items()
        if _may_be_foot(words, contacts_only=contacts_only)
    }
    counts = Counter(topics.values())
    feet = [
        Foot(
            name if counts[name] == 1 else _sanitised(topic),
            topic,
            leg_position=leg_position(name),
        )
        for topic, name in topics.items()
    ]
    if unique := tuple({foot.name: foot for foot in feet}.values())[:_MOST_LEGS]:
        yield FootSet(unique, "alone")


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
    slots = [at for at, word in enumerate(words) if word.slot]
    read = (each for at in slots for each in readings_of(words, (at,)))
    names = sides if len(sides) == 1 else {each.leg for each in read if each.kind == "numbers"}
    return names.pop() if len(names) == 1 else _sanitised(label)


def _sanitised(topic: str) -> str:
    return re.sub(r"[^A-Za-z0-9]+", "_", topic).strip("_") or "foot"
