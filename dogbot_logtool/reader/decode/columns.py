"""Columns of decoded messages: tables of numbers, texts and nested tables.

Numbers that stand near each other in a message stay together, as rows of a structured array.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.arrays import Bytes, Flags, Floats, Ints, distinct


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


_ROUNDS: Final = 4
"""Different strings of one length from which all others are sorted."""


class Texts(NamedTuple):
    """Strings, as offsets into the batch's buffer."""

    buffer: Bytes
    start: Ints
    """(n,)."""
    length: Ints
    """(n,) bytes."""

    @property
    def end(self) -> Ints:
        """(n,) first byte after each."""
        return self.start + self.length

    def pick(self, rows: Flags | Ints) -> "Texts":
        """Return the chosen rows."""
        return Texts(self.buffer, self.start[rows], self.length[rows])

    def text(self, row: int) -> str:
        """Return one string; bytes that are not UTF-8 are replaced."""
        start = int(self.start[row])
        return str(self.buffer[start : start + int(self.length[row])].tobytes(), "utf-8", "replace")

    def encode(self) -> tuple[Ints, tuple[str, ...]]:
        """Replace the strings by numbers; they are compared as bytes.

        Returns:
            code (n,), and the different strings that the codes count, in the order of the rows.
        """
        code = np.zeros(len(self.start), np.int64)
        rows: list[int] = []
        for size in distinct(self.length).tolist():
            left = np.flatnonzero(self.length == size)
            texts = np.empty((len(left), 0), np.uint8)
            if size:
                texts = gather_bytes(self.buffer, self.start[left], size)
            # Most columns hold one string, or a few: to compare takes less time than to sort.
            for _ in range(_ROUNDS):
                if len(left):
                    alike = rows_like(texts, texts[0])
                    code[left[alike]] = len(rows)
                    rows.append(int(left[0]))
                    left, texts = left[~alike], texts[~alike]
            if len(left):
                whole = texts.view(f"V{size}")[:, 0]
                _, first, inverse = np.unique(whole, return_index=True, return_inverse=True)
                code[left] = len(rows) + inverse
                rows.extend(left[first].tolist())
        order = np.argsort(rows)
        return np.argsort(order)[code], tuple(self.text(rows[number]) for number in order.tolist())


def rows_like(rows: Bytes, row: Bytes) -> Flags:
    """(n,) which rows of a matrix, (n, k), equal a row, (k,)."""
    if rows.tobytes() == row.tobytes() * len(rows):
        # Much the fastest comparison there is, and mostly the answer.
        return np.ones(len(rows), np.bool_)
    # Row by row, as opaque values: numpy reduces short rows ten times slower.
    opaque = f"V{rows.shape[1]}"
    alike: Flags = rows.view(opaque)[:, 0] == row.view(opaque)
    return alike


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Nested:
    """The elements of an array field."""

    parent: Ints
    """(m,) row of the outer table, ascending; elements of one row stand in their order."""
    table: "Table"
    """m rows."""

    @property
    def index(self) -> Ints:
        """(m,) index of each element in the array of its row."""
        return np.arange(len(self.parent)) - np.searchsorted(self.parent, self.parent)

    def rows_at(self, parent: Ints, index: Ints) -> Ints:
        """(k,) rows of elements; -1 for those that do not exist.

        Args:
            parent: (k,) rows of the outer table.
            index: (k,) indexes in the arrays of these rows.
        """
        first = np.searchsorted(self.parent, parent)
        end = np.searchsorted(self.parent, parent, "right")
        return np.where((index >= 0) & (index < end - first), first + index, -1)


Rows = NDArray[np.void]
"""(n,) structured; the fields are named by their paths."""


class Table(NamedTuple):
    """Decoded fields of n messages, or n elements of an array."""

    rows: int
    runs: tuple[Rows, ...]
    """Fields that are numbers, or fixed arrays of numbers."""
    columns: Mapping[str, Texts | Nested]
    """All others, by path."""

    def numbers(self, path: str) -> NDArray[np.generic]:
        """Return a column of numbers, (n,) or (n, k)."""
        return next(run for run in self.runs if path in (run.dtype.names or ()))[path]

    def vectors(self, path: str, components: str) -> Floats:
        """Return (n, k) float64 from the fields ``path.x``, ``path.y`` ... of a struct."""
        prefix = f"{path}." if path else ""
        names = [prefix + component for component in components]
        return np.stack([self.numbers(name) for name in names], axis=1).astype(np.float64)

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
