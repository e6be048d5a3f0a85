"""Records of a SQLite table: the types and positions of their columns, many records at once."""

import struct
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Bytes, Flags, Ints, distinct
from dogbot_logtool.reader.decode.columns import gather_bytes

LONGEST_VARINT: Final = 9
_SIZES: Final = np.array([0, 1, 2, 3, 4, 6, 8, 8, 0, 0])
"""Bytes of numbers by their type; larger types tell the sizes of texts and blobs."""
_ELSEWHERE: Final = -1
_NULL, _FLOAT, _ZERO, _ONE, _BLOB = 0, 7, 8, 9, 12


@dataclass(frozen=True, slots=True)
class Values:
    """One column of n records."""

    kind: Ints
    """(n,) type: 0 NULL, to 6 and 8, 9 integers, 7 a float, even from 12 on blobs, odd ones texts;
    -1 where the record is damaged."""
    start: Ints
    """(n,) where each begins in the buffer."""
    size: Ints
    """(n,) bytes."""

    @property
    def is_integer(self) -> Flags:
        """(n,)."""
        found: Flags = (self.kind > _NULL) & (self.kind <= _ONE) & (self.kind != _FLOAT)
        return found

    @property
    def is_blob(self) -> Flags:
        """(n,)."""
        found: Flags = (self.kind >= _BLOB) & (self.kind % 2 == 0)
        return found

    def integers(self, buffer: Bytes) -> Ints:
        """Return the values, (n,); 0 where they are no integers."""
        values: Ints = (self.kind == _ONE).astype(np.int64)
        for kind in distinct(self.kind[self.is_integer & (self.kind < _ZERO)]).tolist():
            rows = np.flatnonzero(self.kind == kind)
            width = int(_SIZES[kind])
            wide = np.empty((len(rows), 8), np.uint8)
            wide[:, 8 - width :] = gather_bytes(buffer, self.start[rows], width)
            wide[:, : 8 - width] = np.where(wide[:, 8 - width] >= 0x80, 0xFF, 0)[:, None]
            values[rows] = wide.view(">i8")[:, 0]
        return values

    def value(self, row: int, buffer: Bytes, encoding: str) -> int | float | str | bytes | None:
        """Return one value; bytes that are no text of the encoding are replaced."""
        kind, start = int(self.kind[row]), int(self.start[row])
        data = buffer[start : start + int(self.size[row])].tobytes()
        if kind >= _BLOB:
            return str(data, encoding, "replace") if kind % 2 else data
        if kind == _FLOAT:
            return float(struct.unpack(">d", data)[0])
        if kind in {_ZERO, _ONE}:
            return kind - _ZERO
        return int.from_bytes(data, "big", signed=True) if kind > _NULL else None


def columns(
    buffer: Bytes, start: Ints, size: Ints, held: Ints, wanted: Sequence[int]
) -> tuple[list[Values], Flags]:
    """Return columns of some records, and which records are sound as far as these.

    Args:
        buffer: (b,), with `LONGEST_VARINT` bytes at least behind the last record.
        start: (n,) where the records begin.
        size: (n,) bytes of them.
        held: (n,) how many of these stand in the buffer: the types must; numbers that do not are
            of the type -1, too.
        wanted: numbers of the columns; what a record does not have is NULL.
    """
    header, used = varints(buffer, start)
    position, content = start + used, start + header
    sound = (header >= used) & (header <= held) & (content <= len(buffer) - LONGEST_VARINT)
    found: dict[int, Values] = {}
    for column in range(max(wanted) + 1):
        there = sound & (position < start + header)
        kind, used = varints(buffer, np.where(there, position, 0))
        kind[~there], used[~there] = _NULL, 0
        width = np.where(kind >= _BLOB, (kind - _BLOB) >> 1, _SIZES[np.clip(kind, 0, _ONE)])
        sound &= (
            (kind >= 0) & ((kind <= _ONE) | (kind >= _BLOB)) & (width <= start + size - content)
        )
        width[~sound] = 0
        kind[(kind <= _ONE) & (content + width > start + held)] = _ELSEWHERE
        found[column] = Values(kind, content, width)
        position, content = position + used, content + width
    for values in found.values():
        values.kind[~sound] = _ELSEWHERE
    return [found[column] for column in wanted], sound


def varints(buffer: Bytes, start: Ints) -> tuple[Ints, Ints]:
    """Read numbers of variable length.

    Args:
        buffer: (b,).
        start: (n,), each in [0, b - `LONGEST_VARINT`].

    Returns:
        Values (n,), and the bytes that each takes (n,).
    """
    value = buffer[start].astype(np.int64)
    length = np.ones(len(start), np.int64)
    more = np.flatnonzero(value >= 0x80)
    value[more] &= 0x7F
    for index in range(1, LONGEST_VARINT):
        if not len(more):
            break
        byte = buffer[start[more] + index].astype(np.int64)
        length[more] += 1
        if index == LONGEST_VARINT - 1:
            value[more] = value[more] << 8 | byte
        else:
            value[more] = value[more] << 7 | byte & 0x7F
            more = more[byte >= 0x80]
    return value, length
