"""Templates: one message is serialised by its official library, the rest are copies of it.

No wire format is known here but that of single numbers. To find the offsets of the slots, a message
is serialised twice with numbers that occur nowhere else in it. The copies are a numpy structured
array, and the numbers are written into its columns.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from functools import cache
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.arrays import Ints

Number = float | int | bool | str

TEMPLATES_KEPT: Final = 1024
"""Templates that are kept for later messages and for other logs of a run."""
_VARINT_WIDTH: Final = 10
_VARINT_SHORT: Final = 5
"""Seven-bit groups that hold every number below 2^35."""


class Kind(Enum):
    """How a number is written: its dtype."""

    FLOAT64 = "<f8"
    FLOAT32 = "<f4"
    UINT32 = "<u4"
    BOOL = "u1"
    TEXT6 = "S6"
    # Protobuf writes small numbers in fewer bytes, but negative ones always in ten. A number
    # padded to ten bytes with empty groups is valid, too.
    VARINT = f"V{_VARINT_WIDTH}"


@dataclass(frozen=True, slots=True)
class Slot:
    """Where a message has a number that varies, or a text."""

    name: str
    before: str = ""
    """What stands before the text."""


Fill = Callable[[Slot, Kind], Number]
"""Returns the value of a slot."""


def unfilled(slot: Slot, _kind: Kind) -> Number:
    """Refuse slots, for messages that have none."""
    raise AssertionError(f"{slot.name} has no value")


@dataclass(frozen=True, slots=True)
class Stamps:
    """Times in the form in which a message has them."""

    seconds: NDArray[np.generic]
    """(n,) of the field's dtype."""
    nanoseconds: NDArray[np.generic]

    def pick(self, rows: Ints) -> "Stamps":
        """Return the chosen rows."""
        return Stamps(self.seconds[rows], self.nanoseconds[rows])


@dataclass(frozen=True, slots=True)
class PointArray:
    """Points of a message at equal distances, which are written all at once."""

    shape: tuple[int, int]
    """Number of points, and of numbers in each."""
    start: int
    """First byte of the first."""
    strides: tuple[int, int]
    """Bytes from one point to the next, and from one number to the next."""

    def view(self, records: NDArray[np.void]) -> NDArray[np.float64]:
        """Return a view of the points of messages, (messages, points, numbers), to write into."""
        if not len(records):
            return np.empty((0, *self.shape))
        return np.ndarray(
            (len(records), *self.shape),
            "<f8",
            records.view(np.uint8).data,
            self.start,
            (records.dtype.itemsize, *self.strides),
        )


@dataclass(frozen=True, slots=True)
class Template:
    """A serialised message and the offsets of the numbers that vary."""

    message: bytes
    dtype: "np.dtype[np.void]"
    """A field for every number; its size is the message's."""
    kinds: Mapping[str, Kind]

    @property
    def size(self) -> int:
        """Bytes of every message."""
        return len(self.message)

    def copies(self, count: int) -> NDArray[np.void]:
        """Return (count,) copies of the message, to write into."""
        records = np.empty(count, f"V{self.size}")
        records[:] = np.void(self.message)
        return records.view(self.dtype)

    def point_array(self, points: Sequence[str]) -> PointArray:
        """Return where some points are in the message.

        Args:
            points: their names; a point ``p`` has the numbers ``p.x``, ``p.y`` and ``p.z``.
        """
        fields: Mapping[str, tuple[Any, ...]] = self.dtype.fields or {}
        offsets = np.array([[fields[f"{name}.{axis}"][1] for axis in "xyz"] for name in points])
        start = int(offsets[0, 0])
        between = int(offsets[1, 0]) - start if len(points) > 1 else 0
        within = int(offsets[0, 1]) - start
        steps = between * np.arange(len(points))[:, None] + within * np.arange(3)
        if (offsets != start + steps).any() or any(
            self.kinds[f"{name}.{axis}"] is not Kind.FLOAT64 for name in points for axis in "xyz"
        ):
            raise AssertionError(f"{', '.join(points)} are not at equal distances")
        return PointArray((len(points), 3), start, (between, within))

    def stamps(self, name: str, time: Ints) -> Stamps:
        """Return times, ns, in the form of the numbers ``name.sec`` and ``name.nanosec``."""
        # numpy divides by a constant several times faster than it takes the remainder.
        seconds = time // 1_000_000_000
        nanoseconds = time - seconds * 1_000_000_000
        if self.kinds[f"{name}.sec"] is Kind.VARINT:
            return Stamps(varints(seconds), varints(nanoseconds))
        return Stamps(seconds, nanoseconds)

    def write_stamps(self, records: NDArray[np.void], name: str, stamps: Stamps) -> None:
        """Write times into the pair of numbers ``name.sec`` and ``name.nanosec``."""
        records[f"{name}.sec"] = stamps.seconds
        records[f"{name}.nanosec"] = stamps.nanoseconds

    def write_time(self, records: NDArray[np.void], name: str, time: Ints) -> None:
        """Write times, ns; see `write_stamps`."""
        self.write_stamps(records, name, self.stamps(name, time))


def learn(serialise: Callable[[Fill], bytes]) -> Template:
    """Return the template of a message.

    Args:
        serialise: serialises the message with its slots filled.
    """
    kinds: dict[str, Kind] = {}
    numbers: dict[str, int] = {}

    def fill(slot: Slot, kind: Kind, other: bool = False) -> Number:  # noqa: FBT001, FBT002 - of two
        kinds[slot.name] = kind
        value = _mark(kind, numbers.setdefault(slot.name, len(numbers)), other).value
        return f"{slot.before}{value}" if kind is Kind.TEXT6 else value

    message = serialise(fill)
    changed = serialise(lambda slot, kind: fill(slot, kind, other=True))
    expected = bytearray(message)
    offsets = []
    for number, (name, kind) in enumerate(kinds.items()):
        first, second = (_mark(kind, number, other).written for other in (False, True))
        if kind is Kind.BOOL:
            flipped = serialise(lambda slot, kind: fill(slot, kind, other=slot.name == name))  # noqa: B023 - called at once
            found = [i for i, (a, b) in enumerate(zip(message, flipped, strict=True)) if a != b]
        else:
            found = _found(message, first, changed, second)
        if len(found) != 1:
            raise AssertionError(f"{name} is not written once, in a fixed width")
        offsets += found
        expected[found[0] : found[0] + len(second)] = second
    if expected != changed:
        raise AssertionError(f"more changes than {', '.join(kinds)}")
    dtype = np.dtype(
        {
            "names": list(kinds),
            "formats": [kind.value for kind in kinds.values()],
            "offsets": offsets,
            "itemsize": len(message),
        }
    )
    return Template(message, dtype, kinds)


@dataclass(frozen=True, slots=True)
class _Mark:
    """A number to be found in a message."""

    value: Number
    written: bytes


@cache
def _mark(kind: Kind, number: int, other: bool) -> _Mark:  # noqa: FBT001 - of two
    """Return one of the two marks of a field, which differ in every byte of four at least.

    Args:
        kind: of the field.
        number: its index among the fields of its message.
        other: the second of the two.
    """
    filler = 0x50 if other else 0x20
    digits = number % 47, number // 47 % 47, number // 47**2
    head = bytes(filler + 1 + digit for digit in digits)
    if kind is Kind.BOOL:
        return _Mark(other, bytes([other]))
    if kind is Kind.VARINT:
        groups = enumerate((*head, filler))
        value = sum(group << (7 * index) for index, group in groups) - (1 << 28)
        return _Mark(value, varints(np.array([value])).tobytes())
    dtype = np.dtype(kind.value)
    written = head.ljust(dtype.itemsize, bytes([filler]))
    if kind is Kind.TEXT6:
        return _Mark(written.decode(), written)
    return _Mark(np.frombuffer(written, dtype)[0].item(), written)


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
