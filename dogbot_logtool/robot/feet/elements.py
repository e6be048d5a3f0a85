"""Fields that may be feet inside one message: elements of arrays, and bits of integers."""

from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np

from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.reader.containers.log import Log
from dogbot_logtool.reader.decode.definition import FieldType, Primitive
from dogbot_logtool.reader.foot import Foot, FootField
from dogbot_logtool.robot.feet.labels import labels_of_array
from dogbot_logtool.robot.feet.names import FootSet, leg_position, name_feet
from dogbot_logtool.robot.feet.words import Part, words_of

MOST_FEET: Final = 8
FEWEST_LEGS: Final = 2
_COMPONENTS: Final = (3, 6)
"""Numbers a foot of an array of forces, or of forces and torques; the third is along z."""
_JOINT: Final = frozenset(
    ["ankle", "drive", "hip", "joint", "knee", "motor", "pitch", "roll", "servo", "yaw"]
)
"""Words of names that are a joint's, whose effort is no foot's force."""


_MOST_CHANGES: Final = 0.2
"""Changes a sample from which a bit is no foot's: those of a number change with each message."""


@dataclass(frozen=True, slots=True)
class PossibleField:
    """A field of the messages of some topics."""

    path: str
    """With ``[]`` for an index."""
    field_type: FieldType
    length: int | None = None
    """Elements of its array, where the definition says."""

    @property
    def is_flag(self) -> bool:
        """Whether it is a boolean."""
        return isinstance(self.field_type, Primitive) and self.field_type.name == "bool"

    @property
    def has_bits(self) -> bool:
        """Whether it is an integer."""
        kind = self.field_type
        return isinstance(kind, Primitive) and kind.dtype[0] in "iu" and not self.is_flag


def array_feet(topic: str, field: PossibleField) -> Iterator[tuple[Foot, ...]]:
    """Yield the elements of an array; how many there are, its messages tell."""
    if field.path.count("[]") != 1:
        return
    most = MOST_FEET + 1
    count = most if field.length is None else field.length
    if FEWEST_LEGS <= count <= most:
        yield _elements(topic, field, range(count))
    if not isinstance(field.field_type, Primitive) or field.is_flag:
        return
    for step in _COMPONENTS:
        size = most * step if field.length is None else field.length
        if size % step == 0 and FEWEST_LEGS <= size // step <= most:
            yield _elements(topic, field, range(2, size, step))


def _elements(topic: str, field: PossibleField, indices: range) -> tuple[Foot, ...]:
    paths = (field.path.replace("[]", f"[{index}]") for index in indices)
    return tuple(
        Foot(f"foot_{number}", topic, field=FootField(path)) for number, path in enumerate(paths)
    )


def bit_feet(topic: str, field: PossibleField) -> tuple[Foot, ...]:
    """Return the bits of an integer; none of another field."""
    if not field.has_bits or "[]" in field.path:
        return ()
    return tuple(
        Foot(f"foot_{bit}", topic, field=FootField(f"{field.path}&{1 << bit}"))
        for bit in range(MOST_FEET)
    )


def named_elements(
    log: Log, topic: str, field: PossibleField
) -> tuple[tuple[Foot, ...], FootSet] | None:
    """Return the elements of an array whose strings beside them name feet, among others.

    None where there are none, or all of the elements are feet: those are `array_feet`.
    """
    if field.path.count("[]") != 1:
        return None
    labels = labels_of_array(log, topic, field.path.partition("[")[0])
    found = name_feet(labels, contacts_only=False)
    for one in (found.chosen, *found.offered):
        if one is None or one.kind == "alone" or one.part < Part.LEG:
            continue
        words = {word.text for foot in one.feet for word in words_of(foot.topic)}
        if len(one.feet) == len(labels) or not words.isdisjoint(_JOINT):
            continue
        feet = tuple(
            Foot(
                foot.name,
                topic,
                leg_position=foot.position or leg_position(foot.name),
                field=FootField(field.path.replace("[]", f"[{labels.index(foot.topic)}]")),
            )
            for foot in one.feet
        )
        return feet, one
    return None


def feet_there(feet: Sequence[Foot], samples: Samples) -> int:
    """Return how many feet all messages have, the first ones; 0: they are no feet of an array.

    Args:
        feet: elements of an array, or bits of an integer.
        samples: of the feet, as forces.
    """
    seen = [int((samples.foot == foot).sum()) for foot in range(len(feet))]
    if feet[0].field is not None and "&" in feet[0].field.path:
        count = _bits_used(samples)
    else:
        there = [index for index, number in enumerate(seen) if number]
        if there != [*range(len(there))] or len({seen[index] for index in there}) > 1:
            return 0
        count = len(there)
    return count if FEWEST_LEGS <= count <= MOST_FEET else 0


def _bits_used(samples: Samples) -> int:
    """Return how many bits there are up to the last that changes; 0 where they are a number's."""
    count = 0
    for bit in range(MOST_FEET):
        own = samples.force[samples.foot == bit, 2] != 0.0
        changes = np.count_nonzero(np.diff(own))
        if changes > _MOST_CHANGES * len(own):
            return 0
        count = bit + 1 if changes else count
    return count
