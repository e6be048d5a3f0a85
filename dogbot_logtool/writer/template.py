"""Templates: one message is serialised by its official library, the rest are copies of it.

No wire format is known here. To find the offsets of its numbers, a message is serialised several
times, with either of two values that differ in every byte: the bytes that change belong to a
number. The copies are a numpy structured array, and the numbers are written into its columns.
"""

import struct
from collections.abc import Callable, Mapping, Sequence
from enum import Enum
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.geometry.arrays import Ints
from dogbot_logtool.dataclass import dataclass

Number = float | int | bool | str
Serialise = Callable[[Mapping[str, Number]], bytes]
"""Builds a message from named numbers and serialises it."""

_VARINT_WIDTH: Final = 10
_VARINT_SHORT: Final = 5
"""Seven-bit groups that hold every number below 2^35."""


class Kind(Enum):
    """How a number is written, with two values that differ in every byte."""

    FLOAT64 = ("<f8", struct.unpack("<d", b"\x11" * 8)[0], struct.unpack("<d", b"\x22" * 8)[0])
    FLOAT32 = ("<f4", struct.unpack("<f", b"\x11" * 4)[0], struct.unpack("<f", b"\x22" * 4)[0])
    UINT32 = ("<u4", 0x11111111, 0x22222222)
    BOOL = ("u1", False, True)
    TEXT6 = ("S6", "aaaaaa", "bbbbbb")
    # Protobuf writes small numbers in fewer bytes, but negative ones always in ten. A number
    # padded to ten bytes with empty groups is valid, too.
    VARINT = (f"V{_VARINT_WIDTH}", -0x1111111, -0x2222222)

    def __init__(self, dtype: str, first: Number, second: Number) -> None:
        self.dtype = dtype
        self.first = first
        self.second = second


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


def learn(serialise: Serialise, fields: Mapping[str, Kind]) -> Template:
    """Return the template of a message.

    The numbers are counted from 1, and the message is serialised once for every binary digit of
    the count, with the second value for the numbers that have the digit: the digits for which a
    byte changed give the number that it belongs to.

    Args:
        serialise: builds and serialises the message.
        fields: the numbers that vary.
    """
    message = serialise({name: kind.first for name, kind in fields.items()})
    owner = np.zeros(len(message), np.int64)
    for digit in range(len(fields).bit_length()):
        changed = serialise(
            {
                name: kind.second if count >> digit & 1 else kind.first
                for count, (name, kind) in enumerate(fields.items(), 1)
            }
        )
        if len(changed) != len(message):
            asked = [name for count, name in enumerate(fields, 1) if count >> digit & 1]
            raise AssertionError(f"one of {', '.join(asked)} is not written in a fixed width")
        differs = np.frombuffer(changed, np.uint8) != np.frombuffer(message, np.uint8)
        owner += differs.astype(np.int64) << digit
    owners, first = np.unique(owner, return_index=True)
    first_of = dict(zip(owners.tolist(), first.tolist(), strict=True))
    owners, last = np.unique(owner[::-1], return_index=True)
    last_of = dict(zip(owners.tolist(), (len(message) - 1 - last).tolist(), strict=True))
    for count, (name, kind) in enumerate(fields.items(), 1):
        width = np.dtype(kind.dtype).itemsize
        if count not in first_of or last_of[count] - first_of[count] >= width:
            raise AssertionError(f"{name} is not written in one piece")
    offsets = [first_of[count] for count in range(1, len(fields) + 1)]
    dtype = np.dtype(
        {
            "names": list(fields),
            "formats": [kind.dtype for kind in fields.values()],
            "offsets": offsets,
            "itemsize": len(message),
        }
    )
    return Template(message, dtype, dict(fields))


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
