"""Stamping out messages: one is serialised by its official library, the rest are copies of it.

Nothing here knows a wire format. To find where numbers lie, a message is serialised several times
with either of two values that differ in every byte, and the bytes that changed are their places.
Copies are then made as a numpy structured array, and the numbers written into its columns.
"""

import struct
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.geometry.arrays import Ints

Number = float | int | bool
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
    # Protobuf writes small numbers in fewer bytes, but negative ones always in ten. A number that
    # is padded to ten bytes with empty groups is as valid.
    VARINT = (f"V{_VARINT_WIDTH}", -0x1111111, -0x2222222)

    def __init__(self, dtype: str, first: Number, second: Number) -> None:
        self.dtype = dtype
        self.first = first
        self.second = second


@dataclass(frozen=True, slots=True)
class Stamps:
    """Times as messages write them."""

    seconds: NDArray[np.generic]
    """(n,) in the form of the field."""
    nanoseconds: NDArray[np.generic]

    def pick(self, rows: Ints) -> "Stamps":
        """Return the chosen rows."""
        return Stamps(self.seconds[rows], self.nanoseconds[rows])


@dataclass(frozen=True, slots=True)
class Stretch:
    """Points of a message that stand at equal distances, so that all are written at once."""

    shape: tuple[int, int]
    """Number of points, and of numbers in each."""
    start: int
    """First byte of the first."""
    strides: tuple[int, int]
    """Bytes from one point to the next, and from one number to the next."""

    def of(self, records: NDArray[np.void]) -> NDArray[np.float64]:
        """Return the points of messages, (messages, points, numbers), to be written into."""
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
    """A serialised message and the places of the numbers that vary."""

    message: bytes
    dtype: "np.dtype[np.void]"
    """A field for every number; its size is the message's."""
    kinds: Mapping[str, Kind]

    @property
    def size(self) -> int:
        """Bytes of every message."""
        return len(self.message)

    def copies(self, count: int) -> NDArray[np.void]:
        """Return (count,) copies of the message, to be written into."""
        records = np.empty(count, f"V{self.size}")
        records[:] = np.void(self.message)
        return records.view(self.dtype)

    def stretch(self, points: Sequence[str]) -> Stretch:
        """Find out where some points lie.

        Args:
            points: names; the numbers of each are those whose names begin with its and a dot.
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
            raise AssertionError(f"{', '.join(points)} do not stand at equal distances")
        return Stretch((len(points), 3), start, (between, within))

    def stamps(self, name: str, time: Ints) -> Stamps:
        """Return times, ns, as the numbers ``name.sec`` and ``name.nanosec`` write them."""
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
    """Find out where the numbers of a message lie.

    The numbers are counted from 1, and the message is serialised once for every binary digit of
    the count, with the second value for the numbers that have the digit: the times at which a byte
    changed spell out the number that it belongs to.

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
            raise AssertionError(f"{name} is not written in one place")
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
