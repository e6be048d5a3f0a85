"""Words in names of topics, frames and joints: one table, and how names are split.

A name is split into segments at ``/`` and those into words at ``_``, ``-``, ``.``, other signs,
digits and camelCase: ``/robot/leftFootSixAxis_2`` has the words robot | left foot six axis 2.
Words that are written together are taken apart only if every piece is in the table
(``lfoot``, ``frontleft``, ``rrcontact``), so that ``feedback`` is no ``back``.
"""

import re
from collections.abc import Iterable, Iterator, Mapping
from enum import IntEnum
from functools import lru_cache
from typing import Final, NamedTuple, TypeVar

from dogbot_logtool.core.settings import LegPosition

Meaning = TypeVar("Meaning")


def word_set(words: str) -> frozenset[str]:
    """Return some words, written side by side."""
    return frozenset(words.split())


def _by_word(rows: Mapping[Meaning, str]) -> dict[str, Meaning]:
    """Return what each word means, by the words that mean the same."""
    return {word: meaning for meaning, words in rows.items() for word in words.split()}


class Part(IntEnum):
    """How far down a leg a word points; the best evidence for a foot is the greatest."""

    NOT_A_FOOT = 0
    """An arm, a wheel, a tool."""
    UPPER_LEG = 1
    """A part of a leg that usually touches nothing."""
    UNKNOWN = 2
    LEG = 3
    FOOT = 4


ENDS: Final[Mapping[str, str]] = _by_word(
    {
        "front": "front fore anterior",
        "middle": "middle mid center centre",
        "back": "back hind rear aft posterior",
    }
)
SIDES: Final[Mapping[str, str]] = _by_word({"left": "left l", "right": "right r"})
LETTERS: Final[Mapping[str, LegPosition]] = {
    letters: (ENDS[word], SIDES[side])
    for side in "lr"
    for end, word in {"f": "front", "m": "middle", "h": "hind", "b": "back", "r": "rear"}.items()
    # ANYmal, HyQ and towr say LF, RF, LH, RH; Unitree, Spot and quad-sdk FL, FR, RL, RR.
    for letters in (side + end, end + side)
}
"""Both ways name the same leg; ``rr`` is the right rear in both."""
ROWS: Final[Mapping[str, tuple[str, str]]] = {
    row + side: (row, SIDES[side]) for row in "abcd" for side in "lr"
}
"""Syropod's hexapods: AL, AR, BL, BR, CL, CR; their rows are lettered, as others number them."""
PARTS: Final[Mapping[str, Part]] = _by_word(
    {
        Part.FOOT: "ankle ankles feet foot footpad footsole forefoot heel heels hindfoot hoof "
        "insole insoles midfoot paw paws shoe shoes sole soles toe toes",
        Part.LEG: "leg legs",
        Part.UPPER_LEG: "abad calf coxa femur haunch hip hips knee knees lowerleg shank shin thigh "
        "tibia upperleg",
        Part.NOT_A_FOOT: "arm arms axle brake cable cables caster casters claw drill elbow "
        "endeffector engine finger fingers flange flipper flippers forearm gripper grippers hand "
        "handle hands head jack jaw manipulator motor motors neck outrigger outriggers palm peg "
        "propeller rope rotor seat shoulder shoulders spindle stabilizer stabilizers steering "
        "suspension tail tcp thruster thumb tire tires tool torso track tracks trunk tyre tyres "
        "waist wheel wheels winch wing wrist wrists",
    }
)
SOLES: Final = word_set("sole soles footsole")
"""Words of what touches the ground, and not of an ankle or a knee."""
NEUTRAL: Final = word_set(
    "axis bumper bumpers contact contacts contactsensor data force forces ft grf load raw sensor "
    "sensors six state states status tip tips torque wrench wrenches"
)
"""Words of a sensor or its message; they say nothing about where it is."""
_PLANNED: Final = (
    "cmd cmds command commanded commands des desired goal plan planned planner ref reference "
    "setpoint target traj trajectory"
)
PLANNED: Final = word_set(_PLANNED)
"""Words of what shall be, and was not measured."""
MERITS: Final[Mapping[str, int]] = _by_word(
    {
        1: "act actual calibrated comp compensated corrected filtered meas measured off real "
        "scaled tared unbiased zeroed",
        -1: "raw uncalibrated unfiltered",
        -4: f"{_PLANNED} bias err error errors limit limits noise nominal predicted threshold "
        "thresholds",
    }
)
"""How good what a word announces is for telling a foot's contact; other words count 0."""
VOCABULARY: Final = frozenset({*ENDS, *SIDES, *LETTERS, *PARTS, *NEUTRAL, *MERITS})
"""All words of these tables; none is the name of a robot."""
_WHOLE: Final = {
    f"{side}{limb[0]}sensor": (SIDES[side], limb, "sensor")
    for side in "lr"
    for limb in ("foot", "hand", "arm")
}
"""Words of hrpsys's humanoids, which mean something else than their pieces."""
_SLOTS: Final = frozenset({*ENDS, *SIDES, *LETTERS, *ROWS}) | word_set(
    "ball heel in inner inside lateral medial out outer outside toe"
)
"""Words of a leg, or of a place on a foot."""
_LONGEST: Final = 300
"""Characters of names that are looked at; nothing that a person named is longer."""
_LONGEST_WORD: Final = 40
_MOST_WORDS: Final = 32
_PIECES: Final = frozenset({*ENDS, "left", "right", *LETTERS, *PARTS, *NEUTRAL})
_CAMEL_CASE: Final = re.compile(r"(?<=[a-z])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])")


class Word(NamedTuple):
    """A word of a name."""

    text: str
    """In lower case."""
    segment: int
    """Which of the parts between slashes it is in."""

    @property
    def part(self) -> Part | None:
        """The part of a body that it names; None: none."""
        return PARTS.get(self.text)

    @property
    def is_leg(self) -> bool:
        """Whether it names a leg or a foot."""
        return self.part in {Part.FOOT, Part.LEG}

    @property
    def slot(self) -> str:
        """What kind of a word of a leg, or of a place on a foot, it may be; empty: none."""
        return "number" if self.text.isdecimal() else "leg" if self.text in _SLOTS else ""


@lru_cache(maxsize=4096)
def words_of(name: str) -> tuple[Word, ...]:
    """Split a name into words."""
    return tuple(_words_of(name[-_LONGEST:]))[-_MOST_WORDS:]


def texts_of(*names: str) -> frozenset[str]:
    """Return the words of some names, in small letters."""
    return frozenset(word.text for name in names for word in words_of(name))


def parts_of(names: Iterable[str]) -> frozenset[Part]:
    """Return the parts of a body that some names speak of."""
    return frozenset(PARTS[text] for text in texts_of(*names) if text in PARTS)


def _words_of(name: str) -> Iterator[Word]:
    segment = 0
    for piece in re.findall(r"[A-Za-z]+|[0-9]+|/", name):
        if piece == "/":
            segment += 1
            continue
        for text in _split_letters(piece) if piece.isalpha() else [piece]:
            yield Word(text, segment)


@lru_cache(maxsize=4096)
def _split_letters(letters: str) -> tuple[str, ...]:
    """Split letters at camelCase, then words written together; ``FLfoot`` is no ``Lfoot``."""
    words = [word.lower() for word in _CAMEL_CASE.split(letters)]
    pieces = [_WHOLE.get(word) or _pieces(word) for word in words]
    whole = _WHOLE.get(letters.lower()) or _pieces(letters.lower())
    if whole and not all(pieces):
        return whole
    return tuple(
        text for known, word in zip(pieces, words, strict=True) for text in known or (word,)
    )


@lru_cache(maxsize=4096)
def _pieces(word: str, first: frozenset[str] = _PIECES | {"l", "r"}) -> tuple[str, ...]:
    """Return the known pieces that a word is made of, the longest first; none if it is not."""
    if word in _PIECES or len(word) > _LONGEST_WORD:
        return (word,) if word in _PIECES else ()
    for size in range(len(word) - 1, 0, -1):
        if word[:size] in first and (rest := _pieces(word[size:], _PIECES)):
            return (word[:size], *rest)
    return ()
