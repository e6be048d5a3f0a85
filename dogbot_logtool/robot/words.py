"""Words for legs in names of topics: the table of words, and how names are split.

A name is split into segments at ``/`` and those into words at ``_``, ``-``, ``.``, other signs,
digits and camelCase: ``/robot/leftFootSixAxis_2`` has the words robot | left foot six axis 2.
Words that are written together are taken apart only if every piece is in the table
(``lfoot``, ``frontleft``, ``rrcontact``), so that ``feedback`` is no ``back``.
"""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from enum import IntEnum
from functools import lru_cache
from typing import Final

from dogbot_logtool.core.leg_position import LegPosition

ENDS: Final[Mapping[str, str]] = {
    **dict.fromkeys(("front", "fore", "anterior"), "front"),
    **dict.fromkeys(("middle", "mid", "center", "centre"), "middle"),
    **dict.fromkeys(("back", "hind", "rear", "aft", "posterior"), "back"),
}
SIDES: Final[Mapping[str, str]] = {"left": "left", "l": "left", "right": "right", "r": "right"}
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


class Part(IntEnum):
    """How far down a leg a word points; the best evidence for a foot is the greatest."""

    NOT_A_FOOT = 0
    """An arm, a wheel, a tool."""
    UPPER_LEG = 1
    """A part of a leg that usually touches nothing."""
    UNKNOWN = 2
    LEG = 3
    FOOT = 4


_FOOT: Final = (
    "ankle ankles feet foot footpad footsole forefoot heel heels hindfoot hoof insole insoles "
    "midfoot paw paws shoe shoes sole soles toe toes"
)
SOLES: Final = frozenset({"sole", "soles", "footsole"})
"""Words of what touches the ground, and not of an ankle or a knee."""
_LEG: Final = "leg legs"
_UPPER_LEG: Final = (
    "abad calf coxa femur haunch hip hips knee knees lowerleg shank shin thigh tibia upperleg"
)
_NOT_A_FOOT: Final = (
    "arm arms axle brake cable cables caster casters claw drill elbow endeffector engine finger "
    "fingers flange flipper flippers forearm gripper grippers hand handle hands head jack jaw "
    "manipulator motor motors neck outrigger outriggers palm peg propeller rope rotor seat "
    "shoulder shoulders spindle stabilizer stabilizers steering suspension tail tcp thruster thumb "
    "tire tires tool torso track tracks trunk tyre tyres waist wheel wheels winch wing wrist wrists"
)
_NEUTRAL: Final = (
    "axis bumper bumpers contact contacts contactsensor data force forces ft grf load raw sensor "
    "sensors six state states status tip tips torque wrench wrenches"
)
_BETTER: Final = (
    "act actual calibrated comp compensated corrected filtered meas measured off real scaled "
    "tared unbiased zeroed"
)
_WORSE: Final = "raw uncalibrated unfiltered"
_NOT_MEASURED: Final = (
    "bias cmd command commanded commands des desired err error errors goal limit limits noise "
    "nominal plan planned predicted ref reference setpoint target threshold thresholds"
)
PARTS: Final[Mapping[str, Part]] = {
    **dict.fromkeys(_FOOT.split(), Part.FOOT),
    **dict.fromkeys(_LEG.split(), Part.LEG),
    **dict.fromkeys(_UPPER_LEG.split(), Part.UPPER_LEG),
    **dict.fromkeys(_NOT_A_FOOT.split(), Part.NOT_A_FOOT),
}
_PLACES: Final = frozenset(
    ["ball", "heel", "in", "inner", "inside", "lateral", "medial", "out", "outer", "outside", "toe"]
)
ON_A_FOOT: Final = frozenset(
    {*map(str, range(1, 17)), *"abcdefgh", *_PLACES, *ENDS, *SIDES, *LETTERS}
)
"""Words that tell the sensors of one foot apart."""
NEUTRAL: Final = frozenset(_NEUTRAL.split())
"""Words of a sensor or its message; they say nothing about where it is."""
WHOLE: Final[Mapping[str, tuple[str, ...]]] = {
    # hrpsys robots are humanoids: f is foot, h is hand, a is arm.
    **{f"{s}fsensor": (side, "foot", "sensor") for s, side in (("l", "left"), ("r", "right"))},
    **{f"{s}hsensor": (side, "hand", "sensor") for s, side in (("l", "left"), ("r", "right"))},
    **{f"{s}asensor": (side, "arm", "sensor") for s, side in (("l", "left"), ("r", "right"))},
}
"""Words that mean something else than their pieces."""
MERITS: Final[Mapping[str, int]] = {
    **dict.fromkeys(_BETTER.split(), 1),
    **dict.fromkeys(_WORSE.split(), -1),
    **dict.fromkeys(_NOT_MEASURED.split(), -4),
}
"""How good what a word announces is for telling a foot's contact; other words count 0."""
VOCABULARY: Final = frozenset({*ENDS, *SIDES, *LETTERS, *PARTS, *NEUTRAL, *MERITS})
"""All words of these tables; none is the name of a robot."""
USABLE: Final = -2
"""Merit below which a topic tells no measured force: it is planned, or an error."""

_LONGEST: Final = 300
"""Characters of names that are looked at; nothing that a person named is longer."""
_LONGEST_WORD: Final = 40
_MOST_WORDS: Final = 32
_PIECES: Final = frozenset({*ENDS, "left", "right", *LETTERS, *PARTS, *NEUTRAL})
_LEADING: Final = frozenset({"l", "r"})
"""Pieces that can only begin a word."""
_SLOTS: Final[Mapping[str, str]] = {
    **dict.fromkeys("abcdefgh", "row"),
    **dict.fromkeys(_PLACES, "place"),
    **dict.fromkeys(ENDS, "end"),
    **{word: "side" if len(word) > 1 else "l or r" for word in SIDES},
    **dict.fromkeys((*LETTERS, *ROWS), "letters"),
}
"""What kind of a word of a leg, or of a place on a foot, a word may be; numbers are some, too."""
_CAMEL_CASE: Final = re.compile(r"(?<=[a-z])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])")


@dataclass(frozen=True, slots=True)
class Word:
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
    def is_position(self) -> bool:
        """Whether it tells at least which side a leg is on."""
        return self.text in LETTERS or self.text in SIDES

    @property
    def slot(self) -> str:
        """What kind of a word of a leg, or of a place on a foot, it may be; empty: none."""
        return "number" if self.text.isdecimal() else _SLOTS.get(self.text, "")


def words_of(name: str) -> tuple[Word, ...]:
    """Split a name into words."""
    return tuple(_words_of(name[-_LONGEST:]))[-_MOST_WORDS:]


def texts_of(name: str) -> set[str]:
    """Return the words of a name, in small letters."""
    return {word.text for word in words_of(name)}


def _words_of(name: str) -> Iterator[Word]:
    segment = 0
    for piece in re.findall(r"[A-Za-z]+|[0-9]+|[^A-Za-z0-9]+", name):
        if not piece[0].isascii() or not piece[0].isalnum():
            segment += piece.count("/")
            continue
        for text in _split_letters(piece) if piece[0].isalpha() else (piece,):
            yield Word(text, segment)


@lru_cache(maxsize=4096)
def _split_letters(letters: str) -> tuple[str, ...]:
    """Split letters at camelCase, then words written together; ``FLfoot`` is no ``Lfoot``."""
    words = [word.lower() for word in _CAMEL_CASE.split(letters)]
    pieces = [_known(word) for word in words]
    if not all(pieces) and (whole := _known(letters.lower())):
        return whole
    return tuple(
        text for known, word in zip(pieces, words, strict=True) for text in known or (word,)
    )


def _known(word: str) -> tuple[str, ...]:
    """Take a word apart if all its pieces are known, the longest first; else there are none."""
    if len(word) > _LONGEST_WORD:
        return ()
    return WHOLE.get(word) or _pieces(word, _PIECES | _LEADING)


@lru_cache(maxsize=4096)
def _pieces(word: str, known: frozenset[str]) -> tuple[str, ...]:
    """Return the known pieces that a word is made of; none if it is not."""
    if word in _PIECES:
        return (word,)
    for size in range(len(word) - 1, 0, -1):
        if word[:size] in known and (rest := _pieces(word[size:], _PIECES)):
            return (word[:size], *rest)
    return ()
