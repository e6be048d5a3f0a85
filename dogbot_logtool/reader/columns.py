"""Columns of decoded messages: tables of numbers, texts and nested tables."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.arrays import Flags, Floats, Ints

Bytes = NDArray[np.uint8]
_ROUNDS: Final = 64
"""Different strings from which sorting all is faster than taking out one after another."""


def gather(buffer: Bytes, start: Ints, size: int) -> NDArray[np.void]:
    """Copy `size` bytes from each start in one call, through an overlapping view.

    Args:
        buffer: (b,) contiguous.
        start: (n,), each in [0, b - size].
        size: at least 1, at most b.

    Returns:
        (n,) of dtype ``V<size>``.
    """
    windows: NDArray[np.void] = np.ndarray(
        (len(buffer) - size + 1,), f"V{size}", buffer.data, 0, (1,)
    )
    return windows[start]


def gather_bytes(buffer: Bytes, start: Ints, size: int) -> Bytes:
    """Like `gather`, as an (n, size) matrix of bytes."""
    return gather(buffer, start, size).view(np.uint8).reshape(len(start), size)


@dataclass(frozen=True, slots=True)
class Texts:
    """Strings, as places in the batch's buffer."""

    buffer: Bytes
    start: Ints
    """(n,)."""
    length: Ints
    """(n,) bytes."""

    @property
    def end(self) -> Ints:
        """(n,) first byte after each."""
        return self.start + self.length

    def text(self, row: int) -> str:
        """Return one string; bytes that are not UTF-8 are replaced."""
        start = int(self.start[row])
        return str(self.buffer[start : start + int(self.length[row])].tobytes(), "utf-8", "replace")

    def encode(self) -> tuple[Ints, tuple[str, ...]]:
        """Replace the strings by numbers.

        Returns:
            code (n,), and the different strings that the codes count.
        """
        code, rows = self.alike()
        return code, tuple(self.text(row) for row in rows)

    def alike(self) -> tuple[Ints, list[int]]:
        """Number the different strings, as bytes.

        Strings on the path are nearly always constant, or take few values, so each round
        settles all rows that equal the first unsettled one. After some rounds the rest is sorted,
        since a log may also name every row differently.

        Returns:
            code (n,), and for each code a row that has it.
        """
        code = np.full(len(self.start), -1, np.int64)
        rows: list[int] = []
        left = np.arange(len(self.start))
        while len(left) and len(rows) < _ROUNDS:
            first = left[0]
            alike = left[self.length[left] == self.length[first]]
            if size := int(self.length[first]):
                texts = gather_bytes(self.buffer, self.start[alike], size)
                alike = alike[rows_like(texts, texts[0])]
            code[alike] = len(rows)
            rows.append(int(first))
            left = left[code[left] < 0] if len(alike) < len(left) else left[:0]
        for size in np.unique(self.length[left]).tolist():
            alike = left[self.length[left] == size]
            # Texts without a byte are all alike.
            whole = gather(self.buffer, self.start[alike], size) if size else alike * 0
            _, first_rows, inverse = np.unique(whole, return_index=True, return_inverse=True)
            code[alike] = len(rows) + inverse
            rows.extend(alike[first_rows].tolist())
        return code, rows


def rows_like(rows: Bytes, row: Bytes) -> Flags:
    """(n,) which rows of a matrix, (n, k), equal a row, (k,)."""
    if rows.tobytes() == row.tobytes() * len(rows):
        # Much the fastest comparison there is, and mostly the answer.
        return np.ones(len(rows), np.bool_)
    alike: Flags = (rows == row).all(axis=1)
    return alike


@dataclass(frozen=True, slots=True)
class Nested:
    """The elements of an array field."""

    parent: Ints
    """(m,) row of the outer table. Elements of one row stand in their order; rows may mix."""
    table: "Table"
    """m rows."""


Column = NDArray[np.generic] | Texts | Nested


@dataclass(frozen=True, slots=True)
class Table:
    """Decoded fields of n messages, or n elements of an array."""

    rows: int
    columns: Mapping[str, Column]

    def numbers(self, path: str) -> NDArray[np.generic]:
        """Return a column of numbers, (n,) or (n, k)."""
        column = self.columns[path]
        assert isinstance(column, np.ndarray)  # noqa: S101 - a wrong path is a fault of ours
        return column

    def vectors(self, path: str, components: str) -> Floats:
        """Return (n, k) float64 from the fields ``path.x``, ``path.y`` ... of a struct."""
        prefix = f"{path}." if path else ""
        parts = [self.numbers(prefix + component) for component in components]
        return np.stack(parts, axis=1).astype(np.float64, copy=False)

    def nanoseconds(self, path: str) -> Ints:
        """Return (n,) ns from a time field's ``sec`` and ``nanosec``."""
        seconds = self.numbers(f"{path}.sec").astype(np.int64)
        return seconds * 1_000_000_000 + self.numbers(f"{path}.nanosec").astype(np.int64)

    def texts(self, path: str) -> Texts:
        """Return a column of strings."""
        column = self.columns[path]
        assert isinstance(column, Texts)  # noqa: S101 - a wrong path is a fault of ours
        return column

    def nested(self, path: str) -> Nested:
        """Return an array field."""
        column = self.columns[path]
        assert isinstance(column, Nested)  # noqa: S101 - a wrong path is a fault of ours
        return column


def concatenate(tables: Sequence[Table]) -> Table:
    """Stack tables of the same columns."""
    if len(tables) == 1:
        return tables[0]
    columns = {
        path: _concatenate_columns([table.columns[path] for table in tables], tables)
        for path in tables[0].columns
    }
    return Table(sum(table.rows for table in tables), columns)


def _concatenate_columns(parts: Sequence[Column], tables: Iterable[Table]) -> Column:
    first = parts[0]
    if isinstance(first, Texts):
        texts = [part for part in parts if isinstance(part, Texts)]
        start = np.concatenate([part.start for part in texts])
        return Texts(first.buffer, start, np.concatenate([part.length for part in texts]))
    if isinstance(first, Nested):
        nested = [part for part in parts if isinstance(part, Nested)]
        offsets = np.cumsum([0, *(table.rows for table in tables)])
        parents = [part.parent + offset for part, offset in zip(nested, offsets, strict=False)]
        return Nested(np.concatenate(parents), concatenate([part.table for part in nested]))
    return np.concatenate([part for part in parts if isinstance(part, np.ndarray)])
