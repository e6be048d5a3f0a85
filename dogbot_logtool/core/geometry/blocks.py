"""Streams of columns, cut anew into blocks of a fixed size, and columns that grow.

The reader's batches end where the log's chunks end. Whatever is summed over a batch would
depend on that in its last digits. So each stream is cut into blocks of a fixed number of rows,
counted from its own start: the figures are the same to the bit however the log is packed.
"""

from collections.abc import Callable, Iterator, Sequence
from copy import copy
from dataclasses import fields
from typing import Any, ClassVar, Final, Generic, Protocol, Self, TypeVar

import numpy as np

from dogbot_logtool.core.geometry.arrays import Flags, Floats, Ints

BLOCK_ROWS: Final = 16384
"""Large enough to make the cost of a numpy call vanish; 2 MB of contact samples."""


class Record(Protocol):
    """A dataclass, all of whose fields are columns."""

    __dataclass_fields__: ClassVar[dict[str, Any]]


class ColumnTable(Record, Protocol):
    """Columns with one row a message."""

    @property
    def log_time(self) -> Ints:
        """(n,) ns."""

    def pick(self, rows: Ints) -> Self:
        """Return copies of some rows."""


AnyColumns = TypeVar("AnyColumns", bound=Record)
Columns = TypeVar("Columns", bound=ColumnTable)
_LARGE_BYTES: Final = 33 << 20
"""glibc never keeps more than 32 MiB that was freed in one piece."""


def picked(columns: AnyColumns, rows: Flags | Ints | slice) -> AnyColumns:
    """Return the chosen rows: copies, or views of a slice."""
    values: list[Any] = [getattr(columns, field.name) for field in fields(columns)]
    if isinstance(rows, slice):
        return type(columns)(*(column[rows] for column in values))
    if rows.dtype == np.bool_:
        rows = np.flatnonzero(rows)
    # Of vectors, `take` picks rows four times as fast as an index does.
    return type(columns)(*(column.take(rows, axis=0) for column in values))


def concatenated(parts: Sequence[AnyColumns]) -> AnyColumns:
    """Stack column tables of one type, at least one."""
    if len(parts) == 1:
        return parts[0]
    names = [field.name for field in fields(parts[0])]
    stacked: list[Any] = [np.concatenate([getattr(part, name) for part in parts]) for name in names]
    return type(parts[0])(*stacked)


class Blocks(Generic[Columns]):
    """Cuts a stream of column tables into blocks of a fixed number of rows."""

    def __init__(self, rows: int = BLOCK_ROWS) -> None:
        self._size = rows
        self._parts: list[Columns] = []
        self._rows = 0

    def add(self, columns: Columns) -> Iterator[Columns]:
        """Take rows in; give the blocks that have become full."""
        if len(columns.log_time) == 0:
            return
        self._parts.append(columns)
        self._rows += len(columns.log_time)
        if self._rows < self._size:
            return
        whole = concatenated(self._parts)
        full = self._rows - self._rows % self._size
        self._parts, self._rows = [], self._rows - full
        if self._rows:
            # A copy, so that the rest does not keep the whole batch alive.
            self._parts = [whole.pick(np.arange(full, full + self._rows))]
        for start in range(0, full, self._size):
            yield picked(whole, slice(start, start + self._size))

    def rest(self) -> Iterator[Columns]:
        """Give the last block, at the end of the log."""
        if self._parts:
            yield concatenated(self._parts)
        self._parts, self._rows = [], 0

    def changed(self, change: Callable[[Columns], Columns]) -> Self:
        """Return a copy whose rows that wait are changed."""
        other = copy(self)
        other._parts = [change(each) for each in self._parts]  # noqa: SLF001 - its own
        return other


class GrowingTable:
    """Rows of float64 that are appended block by block and stacked once.

    Small parts are joined into parts so large that the system takes each back when it is freed,
    one by one while the table is stacked: so a long table is never in memory twice.
    """

    def __init__(self, columns: int) -> None:
        self._columns = columns
        self._large: list[Floats] = []
        self._small: list[Floats] = []
        self._small_rows = 0

    def append(self, rows: Floats) -> None:
        """Append (n, columns) rows; they are copied."""
        if len(rows) == 0:
            return
        self._small.append(np.array(rows, np.float64))
        self._small_rows += len(rows)
        if self._small_rows * self._columns * 8 > _LARGE_BYTES:
            self._join()

    def stacked(self) -> Floats:
        """Return all (n, columns) rows."""
        self._join()
        if len(self._large) == 1:
            return self._large[0]
        table = np.empty((sum(len(part) for part in self._large), self._columns))
        row = 0
        for part in _taken(self._large):
            table[row : row + len(part)] = part
            row += len(part)
        self._large = [table]
        return table

    def _join(self) -> None:
        if self._small:
            self._large.append(np.concatenate(self._small))
        self._small, self._small_rows = [], 0


def _taken(parts: list[Floats]) -> Iterator[Floats]:
    """Take parts out of a list, first to last, so that each is freed after use."""
    parts.reverse()
    while parts:
        yield parts.pop()
