"""Templates: one message is serialised by its official library, the rest are copies of it.

No wire format is known here but that of single numbers. To find the offsets of the slots, a message
is serialised with numbers that occur nowhere else in it. The copies are a numpy structured
array of MCAP message records, and the numbers are written into its columns.
"""

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from functools import cache
from typing import Any, Final, NamedTuple

import numpy as np
from mcap.opcode import Opcode
from numpy.typing import NDArray

from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.mcap_layout import MESSAGE_HEAD, RECORD_HEAD

Number = float | int | str
Mark = tuple[Number, bytes]
"""A number to be found in a message, and its bytes."""
Columns = Mapping[str, NDArray[Any]]
"""(n, ...) values by the name of a slot."""
Records = NDArray[np.void]
"""(n,) message records of one channel and one size."""

_VARINT_WIDTH: Final = 10
VARINT: Final = f"V{_VARINT_WIDTH}"
"""How protobuf writes integers: small numbers in fewer bytes, but negative ones always in ten. A
number padded to ten bytes with empty groups is valid, too."""
TEXT: Final = "S6"
"""How texts are written."""


_FILLERS: Final = 0x20, 0x50
"""Bytes of marks; the second where a message has the bytes of the first by itself."""


class Of(Enum):
    """What a value that varies is; an encoding writes all of one sort as one dtype."""

    NUMBER = "number"
    COLOUR = "colour"
    TIME = "time"
    TEXT = "text"


@dataclass(frozen=True, slots=True)
class Slot:
    """Where a message has a value that varies."""

    name: str
    """Of the columns that have it."""
    index: tuple[int, ...] = ()
    """Of the value in a row of these columns."""
    of: Of = Of.NUMBER
    before: str = ""
    """What stands before a text."""
    share: float = 1.0
    """Of a number that is written."""

    def values(self, columns: Columns, rows: Ints) -> NDArray[Any]:
        """Return what is written for some rows, (m,)."""
        values: NDArray[Any] = columns[self.name][(rows, *self.index)]
        return values if self.share == 1.0 else self.share * values


Literal = Mapping[str, Any]
"""A message: values, lists and mappings by field; what is not named has its type's default."""


class Template(NamedTuple):
    """A serialised message, and where its numbers stand."""

    record: bytes
    """The message record, of channel 0."""
    dtype: "np.dtype[np.void]"
    """Fields of the record: those of its head, and one for each place of a number."""
    slots: Mapping[str, Slot]
    """By the field of each place."""

    def records(self, channel: int, log_time: Ints, columns: Columns, rows: Ints) -> Records:
        """Return a record of each of some rows.

        Args:
            channel: id of the channel.
            log_time: (n,) ns; the publish time is the same.
            columns: (n, ...) of at least the template's slots.
            rows: (m,) of the columns.
        """
        copies = np.empty(len(rows), f"V{len(self.record)}")
        copies[:] = np.void(self.record)
        records = copies.view(self.dtype)
        records["channel"] = channel
        records["log_time"] = records["publish_time"] = log_time[rows]
        for field, slot in self.slots.items():
            records[field] = slot.values(columns, rows)
        return records


def learn(
    serialise: Callable[[Literal], bytes], literal: Literal, kinds_of: Mapping[Of, str]
) -> Template:
    """Return the template of a message.

    Args:
        serialise: serialises a message without slots.
        literal: the message; one slot may stand in several places.
        kinds_of: how the encoding writes values.
    """
    for filler in _FILLERS:
        message, marks, counts = _with_marks(serialise, literal, kinds_of, filler)
        places = [
            (slot, kinds_of[slot.of], offset)
            for slot, (_, mark) in marks.items()
            for offset in _found(message, mark)
        ]
        # A text of the message may have the bytes of a mark.
        if Counter(slot for slot, _, _ in places) == counts:
            return _of_places(message, places)
    raise AssertionError(f"{', '.join(slot.name for slot in counts)}: not of a fixed width")


def _with_marks(
    serialise: Callable[[Literal], bytes],
    literal: Literal,
    kinds_of: Mapping[Of, str],
    filler: int,
) -> tuple[bytes, Mapping[Slot, Mark], Counter[Slot]]:
    """Return a message with marks for slots, these marks, and in how many places each stands."""
    marks: dict[Slot, Mark] = {}
    counts = Counter[Slot]()

    def value_of(slot: Slot) -> Number:
        counts[slot] += 1
        if slot not in marks:
            marks[slot] = _mark(kinds_of[slot.of], len(marks), filler)
        value, _ = marks[slot]
        return f"{slot.before}{value}" if slot.of is Of.TEXT else value

    return serialise(_filled(literal, value_of)), marks, counts


def _filled(value: Any, value_of: Callable[[Slot], Number]) -> Any:  # noqa: ANN401 - of a literal
    """Return a literal with values instead of slots."""
    if isinstance(value, Slot):
        return value_of(value)
    if isinstance(value, Mapping):
        return {name: _filled(each, value_of) for name, each in value.items()}
    return [_filled(each, value_of) for each in value] if isinstance(value, list) else value


def _of_places(message: bytes, places: Sequence[tuple[Slot, str, int]]) -> Template:
    """Return the template of a message with slots, written as some kinds at some offsets."""
    head = np.zeros((), MESSAGE_HEAD)
    head["opcode"] = Opcode.MESSAGE
    head["length"] = len(message) + (MESSAGE_HEAD.itemsize - RECORD_HEAD.size)
    of_head: Mapping[str, tuple[Any, ...]] = MESSAGE_HEAD.fields or {}
    fields = {name: of_head[name][:2] for name in ("channel", "log_time", "publish_time")}
    for _, kind, offset in places:
        fields[str(offset)] = np.dtype(kind), MESSAGE_HEAD.itemsize + offset
    record = head.tobytes() + message
    formats, offsets = zip(*fields.values(), strict=True)
    dtype = np.dtype(
        {"names": list(fields), "formats": formats, "offsets": offsets, "itemsize": len(record)}
    )
    return Template(record, dtype, {str(offset): slot for slot, _, offset in places})


@cache
def _mark(kind: str, number: int, filler: int) -> Mark:
    """Return a number to be found in a message, and its bytes.

    Those of different slots differ in one of three bytes.

    Args:
        kind: of the slot.
        number: its index among the slots of its message.
        filler: the byte before and behind those that differ: one of `_FILLERS`.
    """
    digits = number % 47, number // 47 % 47, number // 47**2
    head = bytes(filler + 1 + digit for digit in digits)
    if kind == VARINT:
        groups = enumerate((*head, filler))
        value = sum(group << (7 * index) for index, group in groups) - (1 << 28)
        return value, varints(np.array([value])).tobytes()
    dtype = np.dtype(kind)
    written = head.ljust(dtype.itemsize, bytes([filler]))
    if kind == TEXT:
        return written.decode(), written
    return np.frombuffer(written, dtype)[0].item(), written


def _found(message: bytes, mark: bytes) -> Iterator[int]:
    """Yield the offsets of a mark in a message."""
    offset = message.find(mark)
    while offset >= 0:
        yield offset
        offset = message.find(mark, offset + 1)


def varints(values: Ints) -> NDArray[np.void]:
    """Return base-128 numbers, least significant group first, padded to ten bytes.

    Args:
        values: (n,).

    Returns:
        (n,) of dtype ``V10``.
    """
    bits = values.view(np.uint64)
    # In every group but the last the highest bit is set, whatever is shifted into it.
    written = np.full((len(bits), _VARINT_WIDTH), 0x80, np.uint8)
    for group in range(_VARINT_WIDTH - 1):
        written[:, group] |= (bits >> np.uint64(7 * group)).astype(np.uint8)
    written[:, -1] = bits >> np.uint64(63)
    return written.view(f"V{_VARINT_WIDTH}")[:, 0]
