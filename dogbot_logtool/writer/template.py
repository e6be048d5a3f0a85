"""Templates: one message is serialised by its official library, the rest are copies of it.

No wire format is known here but that of single numbers. To find the offsets of the slots, a message
is serialised twice with numbers that occur nowhere else in it. The copies are a numpy structured
array of MCAP message records, and the numbers are written into its columns.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from functools import cache
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.arrays import Ints

Number = float | int | str
Columns = Mapping[str, NDArray[Any]]
"""(n, ...) values by the name of a slot."""
Records = NDArray[np.void]
"""(n,) message records of one channel and one size."""

MESSAGE_OPCODE: Final = 0x05
MESSAGE_HEAD: Final = np.dtype(
    [
        ("opcode", "u1"),
        ("length", "<u8"),
        ("channel", "<u2"),
        ("sequence", "<u4"),
        ("log_time", "<i8"),
        ("publish_time", "<i8"),
    ]
)
"""An MCAP message record up to its payload."""
RECORD_HEAD_SIZE: Final = 9
"""Bytes of any record's opcode and length."""
_VARINT_WIDTH: Final = 10
VARINT: Final = f"V{_VARINT_WIDTH}"
"""How protobuf writes integers: small numbers in fewer bytes, but negative ones always in ten. A
number padded to ten bytes with empty groups is valid, too."""
TEXT: Final = "S6"
"""How texts are written."""
_VARINT_SHORT: Final = 5
"""Seven-bit groups that hold every number below 2^35."""


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


@dataclass(frozen=True, slots=True)
class Template:
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
    numbers: dict[Slot, int] = {}

    def filled(*, other: bool) -> bytes:
        def value_of(slot: Slot) -> Number:
            number = numbers.setdefault(slot, len(numbers))
            value, _ = _mark(kinds_of[slot.of], number, other)
            return f"{slot.before}{value}" if slot.of is Of.TEXT else value

        return serialise(_filled(literal, value_of))

    message, changed = filled(other=False), filled(other=True)
    expected = bytearray(message)
    places: list[tuple[Slot, str, int]] = []
    for slot, number in numbers.items():
        kind = kinds_of[slot.of]
        first, second = (_mark(kind, number, other)[1] for other in (False, True))
        found = _found(message, first, changed, second)
        if not found:
            raise AssertionError(f"{slot.name} is not written in a fixed width")
        for offset in found:
            expected[offset : offset + len(second)] = second
            places.append((slot, kind, offset))
    if expected != changed:
        raise AssertionError(f"more changes than {', '.join(slot.name for slot in numbers)}")
    return _of_places(message, places)


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
    head["opcode"] = MESSAGE_OPCODE
    head["length"] = len(message) + (MESSAGE_HEAD.itemsize - RECORD_HEAD_SIZE)
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
def _mark(kind: str, number: int, other: bool) -> tuple[Number, bytes]:  # noqa: FBT001 - of two
    """Return a number to be found in a message, and its bytes: one of two for a field.

    The two differ in every byte, and of different fields in one of three.

    Args:
        kind: of the field.
        number: its index among the fields of its message.
        other: the second of the two.
    """
    filler = 0x50 if other else 0x20
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


def _found(message: bytes, first: bytes, changed: bytes, second: bytes) -> list[int]:
    """Return the offsets where a message has the first bytes and the changed one the second."""
    found, offset = [], message.find(first)
    while offset >= 0:
        if changed.startswith(second, offset):
            found.append(offset)
        offset = message.find(first, offset + 1)
    return found


def varints(values: Ints) -> NDArray[np.void]:
    """Return base-128 numbers, least significant group first, padded to ten bytes.

    Args:
        values: (n,).

    Returns:
        (n,) of dtype ``V10``.
    """
    bits = values.view(np.uint64)
    short = not len(bits) or int(bits.max()) < 1 << (7 * _VARINT_SHORT)
    # In every group but the last the highest bit is set, whatever is shifted into it.
    written = np.full((len(bits), _VARINT_WIDTH), 0x80, np.uint8)
    for group in range(_VARINT_SHORT if short else _VARINT_WIDTH - 1):
        written[:, group] |= (bits >> np.uint64(7 * group)).astype(np.uint8)
    written[:, -1] = bits >> np.uint64(63)
    return written.view(f"V{_VARINT_WIDTH}")[:, 0]
