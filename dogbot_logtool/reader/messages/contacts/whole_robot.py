"""Messages that tell of all feet at once: contact flags, forces and positions, foot by foot."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.frames.wrench_frame import WrenchFrame
from dogbot_logtool.core.geometry.arrays import Flags, Floats, Ints, all_finite
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.reader.decode.columns import Nested, Texts
from dogbot_logtool.reader.decode.message_layout import ELEMENT
from dogbot_logtool.reader.messages.contacts.source import (
    ContactSamples,
    ContactSource,
    FootChannels,
    FootValues,
    MessageFoot,
    foot_samples,
    of_all_feet,
)
from dogbot_logtool.reader.messages.messages import DecodedMessages
from dogbot_logtool.robot import Foot

QUADRUPED: Final = ("front_left", "front_right", "back_left", "back_right")
"""Feet in the order that most messages have."""
MOST_FEET: Final = 16
"""Elements of a message's arrays that are read as feet."""
_LOAD_SHARE: Final = 0.2
"""Share of all feet's load from which a foot cannot be in the air."""


def read_messages(
    source: ContactSource, messages: DecodedMessages, feet: FootChannels
) -> ContactSamples:
    """Reduce messages of a type to samples, by its `read` or its `values`."""
    if source.read is not None:
        return source.read(messages, feet)
    if source.values is None:
        raise ValueError(f"{source.type_name}: neither `read` nor `values`")
    found = source.values(messages, feet.feet)
    parts = []
    for index, foot in enumerate(feet.feet):
        if foot.element is None:
            continue
        of_foot = _of_foot(found, foot.element, use_flags=not feet.ignores_flags)
        if of_foot is None:
            continue
        rows = feet.sent(index, messages.channel, of_foot.known)
        samples = foot_samples(messages, rows, index, found.stamp, of_foot.force[rows])
        parts.append(_with_positions(samples, of_foot, rows, source))
    return of_all_feet(parts)


@dataclass(frozen=True, slots=True)
class _OneFoot:
    """Values of one foot in n messages."""

    known: Flags
    """(n,)."""
    touches: Flags
    """(n,)."""
    force: Floats
    """(n, 3) N; 0 without contact."""
    position: Floats
    """(n, 3) m; NaN: none."""
    normal: Floats
    """(n, 3)."""


def _of_foot(values: FootValues, element: int, *, use_flags: bool) -> _OneFoot | None:
    """Return the values of one foot; None where messages are too short to have it."""
    contact = values.contact if use_flags or values.force is None else None
    first = contact if contact is not None else values.force
    if first is None or element >= first.shape[1]:
        return None
    nothing = np.full((len(first), 3), np.nan)
    recorded = nothing if values.force is None else values.force[:, element]
    if contact is None:
        known: Flags = ~np.asarray(np.isnan(recorded).all(axis=1))
        touches: Flags = (recorded != 0.0).any(axis=1)
    else:
        known = ~np.isnan(contact[:, element])
        touches = contact[:, element] > 0.0
    return _OneFoot(
        known=known,
        touches=touches,
        force=np.where(touches[:, None], recorded, 0.0),
        position=nothing if values.position is None else values.position[:, element],
        normal=nothing if values.normal is None else values.normal[:, element],
    )


def _with_positions(samples: Samples, foot: _OneFoot, rows: Ints, source: ContactSource) -> Samples:
    touches, position = foot.touches[rows], foot.position[rows]
    placed = touches & all_finite(position)
    return replace(
        samples,
        in_contact=touches,
        in_world=np.full(len(rows), source.frame is WrenchFrame.WORLD),
        # A position in the base's frame is no contact point in the world yet.
        points=(placed & (not source.in_base)).astype(np.int64),
        position=np.where(placed[:, None], position, np.nan),
        normal=np.where(touches[:, None], foot.normal[rows], np.nan),
    )


def matrix(nested: Nested, values: Floats, rows: int) -> Floats:
    """Return the elements of every message's array, side by side.

    Args:
        nested: the array field.
        values: (m,) or (m, 3) of each element.
        rows: n, the number of messages.

    Returns:
        (n, k) or (n, k, 3), k the length of the longest array, `MOST_FEET` at most; NaN where a
        message has fewer elements.
    """
    return scattered(nested.parent, nested.index, values, rows)


def scattered(parent: Ints, element: Ints, values: Floats, rows: int) -> Floats:
    """Return values in a matrix of messages and elements; see `matrix`.

    Args:
        parent: (m,) message of each value.
        element: (m,) which foot's it is; negative: none's.
        values: (m,) or (m, 3).
        rows: n, the number of messages.
    """
    kept = (element >= 0) & (element < MOST_FEET)
    count = int(element[kept].max(initial=-1)) + 1
    table = np.full((rows, count, *values.shape[1:]), np.nan)
    table[parent[kept], element[kept]] = values[kept]
    return table


def arrays_of_length(messages: DecodedMessages, path: str, length: int) -> Floats:
    """(n, length) an array of numbers of every message; NaN where it has another length."""
    rows = len(messages.channel)
    nested = messages.table.nested(path)
    parent = nested.parent
    kept = np.bincount(parent, minlength=rows)[parent] == length
    values = np.full((rows, length), np.nan)
    values[parent[kept], nested.index[kept]] = nested.table.numbers(ELEMENT)[kept]
    return values


def named_contacts(
    messages: DecodedMessages,
    feet: Sequence[Foot],
    *,
    state: str,
    flags: Mapping[int, float],
    position: str,
    normal: str,
) -> FootValues:
    """Return the values of feet from an array `contacts` of named contacts with wrenches.

    Args:
        messages: their table has the array.
        feet: those that are read.
        state: field of a contact that tells whether it is closed, an integer.
        flags: 1 in contact, 0 not, by its values; others are not known.
        position: field of a contact, m; also `normal`.
        normal: of the ground.
    """
    rows = len(messages.channel)
    contacts = messages.table.nested("contacts")
    parent, inside = contacts.parent, contacts.table
    element = labelled_elements(inside.texts("name"), feet)
    recorded = inside.numbers(state)
    flag = np.full(len(parent), np.nan)
    for value, touches in flags.items():
        flag[recorded == value] = touches
    return FootValues(
        stamp=messages.table.nanoseconds("header.stamp"),
        contact=scattered(parent, element, flag, rows),
        force=scattered(parent, element, inside.vectors("wrench.force", "xyz"), rows),
        position=scattered(parent, element, inside.vectors(position, "xyz"), rows),
        normal=scattered(parent, element, inside.vectors(normal, "xyz"), rows),
    )


def labelled_elements(labels: Texts, feet: Sequence[Foot]) -> Ints:
    """(m,) element of the foot that each label names, -1 for labels of no foot."""
    code, names = labels.encode()
    elements = {foot.label: foot.element for foot in feet if foot.label}
    found = [elements.get(name) for name in names]
    of_code = np.array([-1 if each is None else each for each in found], np.int64)
    return of_code[code] if len(of_code) else code


def labels_in(labels: Texts) -> tuple[MessageFoot, ...]:
    """Return the feet of all labels in messages, sorted."""
    _, names = labels.encode()
    return tuple(MessageFoot(label=name) for name in sorted(names)[:MOST_FEET] if name)


def contact_names(messages: DecodedMessages) -> tuple[MessageFoot, ...]:
    """Return the feet that an array `contacts` of named contacts names."""
    return labels_in(messages.table.nested("contacts").table.texts("name"))


@dataclass(frozen=True, slots=True)
class FlagCheck:
    """How contact flags agree with the forces beside them."""

    samples: int = 0
    """Feet in messages that have both."""
    touching: int = 0
    """Flagged as in contact."""
    contradicted: int = 0
    """Flagged as in contact without any force, or not although they carry a share of the load."""

    def __add__(self, other: "FlagCheck") -> "FlagCheck":
        return FlagCheck(
            self.samples + other.samples,
            self.touching + other.touching,
            self.contradicted + other.contradicted,
        )

    @property
    def constant(self) -> bool:
        """Whether all flags are the same."""
        return self.touching in {0, self.samples}


def check_flags(values: FootValues) -> FlagCheck:
    """Compare contact flags with forces."""
    if values.contact is None or values.force is None or not values.force.size:
        return FlagCheck()
    feet = min(values.contact.shape[1], values.force.shape[1])
    flag, force = values.contact[:, :feet], np.linalg.norm(values.force[:, :feet], axis=2)
    known = np.isfinite(flag) & np.isfinite(force)
    total = np.where(known, force, 0.0).sum(axis=1, keepdims=True)
    touching = flag > 0.0
    wrong = np.where(touching, force == 0.0, force > _LOAD_SHARE * total)
    # Without any load, as before a simulation begins, forces tell nothing.
    wrong = wrong & (total > 0.0)
    return FlagCheck(int(known.sum()), int((touching & known).sum()), int((wrong & known).sum()))


def by_type(sources: Sequence[ContactSource]) -> Mapping[str, ContactSource]:
    """Return sources by type name; of several of a type, the later are variants of the first."""
    found: dict[str, ContactSource] = {}
    for one in sources:
        first = found.get(one.type_name)
        found[one.type_name] = (
            one if first is None else replace(first, variants=(*first.variants, one))
        )
    return found
