"""A SQLite database, read page by page: its tables, and the rows of small ones."""

from collections.abc import Collection, Iterator, Sequence
from typing import Any, Final

import numpy as np

from dogbot_logtool.reader.containers.sqlite.pages import Pages, in_pieces
from dogbot_logtool.reader.containers.sqlite.records import columns
from dogbot_logtool.reader.containers.sqlite.schema import SCHEMA, Table, parse_table
from dogbot_logtool.reader.containers.sqlite.tree import (
    SWOLLEN,
    Cells,
    Damage,
    cells_of,
    leaves,
    with_overflow,
)

_MOST_ROWS: Final = 1 << 16
"""Of a small table: an MCAP has no more channels."""
_SCHEMA: Final = "sqlite_schema"
_MOST_BYTES: Final = 64 << 20
"""Of all its rows."""


class Database:
    """The tables of a database.

    Views, virtual tables, tables with computed columns, and what calls itself otherwise in its own
    SQL are left out.
    """

    def __init__(self, pages: Pages, names: Collection[str]) -> None:
        """Find tables.

        Args:
            pages: of the database.
            names: of the tables, in lower case.
        """
        self.pages = pages
        self.damage = Damage()
        """What is found damaged, now and later."""
        self.tables: dict[str, Table] = {_SCHEMA: SCHEMA}
        left = set(names)
        for kind, name, root, sql in self.rows(_SCHEMA, tuple(SCHEMA.columns)):
            key = str(name).lower()
            if kind == "table" and key in left and isinstance(root, int):
                left.remove(key)
                if table := parse_table(str(sql), key, root):
                    self.tables[key] = table

    def rows(self, name: str, names: Sequence[str]) -> Iterator[tuple[Any, ...]]:
        """Yield some columns of the rows of a small table; rows beyond some number are left out.

        Args:
            name: of the table; one that there is not has no rows.
            names: of its columns; None stands for the values of those that it has not.
        """
        table = self.tables.get(name)
        if table is None or not table.has_rowids:
            return
        # No record has a value for a column behind the last.
        wanted = [table.columns.get(name, len(table.columns)) for name in names]
        rows, size = _MOST_ROWS, min(_MOST_BYTES, self.pages.bytes)
        for piece in in_pieces(leaves(self.pages, table.root, self.damage), self.pages.size):
            cells = cells_of(self.pages, piece, self.damage)
            few = cells.pick((np.cumsum(cells.size) <= size) & (np.arange(len(cells.size)) < rows))
            yield from self._values(with_overflow(self.pages, few), table.key, wanted)
            if len(few.size) < len(cells.size):
                self.damage.reasons.add(SWOLLEN)
                return
            rows, size = rows - len(few.size), size - int(few.size.sum())

    def _values(
        self, cells: Cells, key: int | None, wanted: Sequence[int]
    ) -> Iterator[tuple[Any, ...]]:
        """Yield some columns of whole rows."""
        found, sound = columns(cells.buffer, cells.start, cells.size, cells.held, wanted)
        self.damage.rows += int((~sound).sum())
        for row in np.flatnonzero(sound).tolist():
            yield tuple(
                int(cells.rowid[row])
                if number == key and values.kind[row] == 0
                else values.value(row, cells.buffer, self.pages.encoding)
                for number, values in zip(wanted, found, strict=True)
            )
