"""A SQLite database, read page by page: its tables, and the rows of small ones."""

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.reader.containers.sqlite.pages import Pages, in_pieces
from dogbot_logtool.reader.containers.sqlite.records import columns
from dogbot_logtool.reader.containers.sqlite.tree import (
    SWOLLEN,
    Cells,
    Damage,
    cells_of,
    leaves,
    with_overflow,
)

_TABLE: Final = re.compile(
    r'CREATE TABLE\s+("[^"]+"|[\w$]+)\s*\((.*?)(?:\)([\w\s,]*))?', re.IGNORECASE | re.DOTALL
)
_TEXT: Final = re.compile(r"'(?:[^']|'')*'")
_COMMA: Final = re.compile(r",(?![^(]*\))")
"""One that stands in no parentheses."""
_WORD: Final = re.compile(r'"[^"]*"|[\w$]+')
_UNUSUAL: Final = re.compile(r"--|/\*")
_LONGEST_SQL: Final = 1 << 12
_MOST_COLUMNS: Final = 256
_CONSTRAINTS: Final = {"CONSTRAINT", "PRIMARY", "UNIQUE", "CHECK", "FOREIGN"}
_COMPUTED: Final = {"AS", "GENERATED"}


@dataclass(frozen=True, slots=True)
class Table:
    """A plain table: nothing in it is computed."""

    root: int
    """Number of its first page."""
    columns: Mapping[str, int]
    """Numbers of its columns in its records, by name in lower case."""
    key: int | None = None
    """Number of the column that is the number of the row, and NULL in the records."""
    has_rowids: bool = True


SCHEMA: Final = Table(1, {"type": 0, "name": 1, "rootpage": 3, "sql": 4})
"""The table of all tables, views and indices."""


def parse_table(sql: str, name: str, root: int) -> Table | None:
    """Parse the SQL of a table as SQLite stores it; None: it is no plain table of that name.

    Args:
        sql: ``CREATE TABLE name (...)``.
        name: in lower case.
        root: number of its first page.
    """
    match = _TABLE.fullmatch(sql) if len(sql) <= _LONGEST_SQL else None
    if match is None or _UNUSUAL.search(sql) or match[1].strip('"').lower() != name:
        return None
    columns: dict[str, int] = {}
    integers: set[str] = set()
    key = ""
    for part in _COMMA.split(_TEXT.sub("", match[2])):
        words = [word.strip('"').lower() for word in _WORD.findall(part)]
        kinds = {word.upper() for word in words[1:]}
        is_whole = part.count("(") == part.count(")") and part.count('"') % 2 == 0
        if not words or not is_whole or kinds & _COMPUTED or len(columns) == _MOST_COLUMNS:
            return None
        is_column = words[0].upper() not in _CONSTRAINTS
        column = words[0] if is_column else words[-1]
        if is_column:
            columns[column] = len(columns)
        if words[1:2] == ["integer"]:
            integers.add(column)
        if "PRIMARY" in kinds or words[0] == "primary":
            key = column
    has_rowids = "WITHOUT" not in (match[3] or "").upper().split()
    return Table(root, columns, columns.get(key) if key in integers else None, has_rowids)


_MOST_ROWS: Final = 1 << 16
"""Of a small table: an MCAP has no more channels."""
_SCHEMA_NAME: Final = "sqlite_schema"
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
        self.tables: dict[str, Table] = {_SCHEMA_NAME: SCHEMA}
        left = set(names)
        for kind, name, root, sql in self.rows(_SCHEMA_NAME, tuple(SCHEMA.columns)):
            key = str(name).lower()
            if kind == "table" and key in left and isinstance(root, int):
                left.remove(key)
                if table := parse_table(str(sql), key, root):
                    self.tables[key] = table

    def cells(self, table: Table, most: int, numbers: Ints | None = None) -> Iterator[Cells]:
        """Yield the rows of a table as they stand in its leaf pages, some pages at a time.

        Args:
            table: the table.
            most: bytes after which no more rows are taken.
            numbers: of its leaf pages, if known.
        """
        numbers = leaves(self.pages, table.root, self.damage) if numbers is None else numbers
        for piece in in_pieces(numbers, self.pages.size):
            cells = cells_of(self.pages, piece, self.damage)
            fits = np.cumsum(cells.size) <= most
            yield cells if fits.all() else cells.pick(fits)
            if not fits.all():
                self.damage.reasons.add(SWOLLEN)
                return
            most -= int(cells.size.sum())

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
        left = _MOST_ROWS
        for cells in self.cells(table, min(_MOST_BYTES, self.pages.bytes)):
            few = cells.pick(slice(left))
            yield from self._values(with_overflow(self.pages, few), table.key, wanted)
            left -= len(few.size)
            if len(few.size) < len(cells.size):
                self.damage.reasons.add(SWOLLEN)
                return

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
