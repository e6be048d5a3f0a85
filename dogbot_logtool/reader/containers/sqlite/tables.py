"""The tables of a SQLite database: columns, values in many records, rows that are messages."""

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Final, NamedTuple

import numpy as np

from dogbot_logtool.core.arrays import Bytes, Flags, Ints, distinct
from dogbot_logtool.reader.containers.log import Messages
from dogbot_logtool.reader.containers.sqlite.pages import (
    LONGEST_VARINT,
    SHARED,
    SWOLLEN,
    Cells,
    Damage,
    Pages,
    Times,
    cells_in,
    cells_of,
    leaves,
    varints,
    with_overflow,
)
from dogbot_logtool.reader.decode.columns import gather_bytes

_MOST_ROWS: Final = 1 << 16
"""Of a small table: an MCAP has no more channels."""
_MOST_BYTES: Final = 64 << 20
"""Of all its rows."""
_SIZES: Final = np.array([0, 1, 2, 3, 4, 6, 8, 8, 0, 0])
"""Bytes of numbers by their type; larger types tell the sizes of texts and blobs."""
_ELSEWHERE: Final = -1
_NULL, _FLOAT, _ZERO, _ONE, _BLOB = 0, 7, 8, 9, 12

Value = int | str | bytes | None
_MASTER_ROOT: Final = 1
_MASTER_COLUMNS: Final = (0, 1, 3, 4)
"""Type, name, first page and SQL of all tables, views and indices."""
_MESSAGE_COLUMNS: Final = (1, 2, 3)
"""Topic, time and data."""


def find_tables(pages: Pages, names: Mapping[str, Sequence[str]], damage: Damage) -> dict[str, int]:
    """Find tables that begin with some columns; return the number of the first page of each.

    Args:
        pages: of the database.
        names: of the columns, by the table's name in lower case.
        damage: receives what is found.
    """
    found: dict[str, int] = {}
    for kind, name, root, sql in small_rows(pages, _MASTER_ROOT, _MASTER_COLUMNS, damage):
        key = str(name).lower()
        if kind == "table" and key in names and isinstance(root, int):
            pattern = r"\b[^,]*,\W*".join(names[key])
            if re.match(rf"[^(]*\(\W*{pattern}\b", str(sql), re.IGNORECASE):
                found.setdefault(key, root)
    roots = [_MASTER_ROOT, *found.values()]
    if len({*roots}) < len(roots):
        damage.reasons.add(SHARED)
    return found


def small_rows(
    pages: Pages, root: int | None, wanted: Sequence[int], damage: Damage
) -> Iterator[tuple[Value, ...]]:
    """Yield some columns of the rows of a small table; rows beyond some number are left out.

    Args:
        pages: of the database.
        root: number of the table's first page; a table that there is not has no rows.
        wanted: numbers of the columns; what a record has not is None. The first one may be the
            number of the row, which the record has not either.
        damage: receives what is found.
    """
    if root is None:
        return
    left = _MOST_ROWS
    numbers = leaves(pages, root, damage)
    for cells in cells_in(pages, numbers, min(_MOST_BYTES, pages.bytes), damage):
        few = with_overflow(pages, cells.pick(slice(left)))
        found, sound = columns(few, wanted)
        damage.rows += int((~sound).sum())
        every = [each.values(few.buffer, pages.encoding) for each in found]
        for row in np.flatnonzero(sound).tolist():
            yield tuple(
                int(few.rowid[row]) if column == 0 and own[row] is None else own[row]
                for column, own in zip(wanted, every, strict=True)
            )
        left -= len(few.size)
        if not left:
            damage.reasons.add(SWOLLEN)
            return


class Values(NamedTuple):
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

    def values(self, buffer: Bytes, encoding: str) -> list[Value]:
        """Return the values, None for numbers with a point as for NULL.

        Bytes that are no text of the encoding are replaced.
        """
        found: list[Value] = [*self.integers(buffer).tolist()]
        for row in np.flatnonzero(~self.is_integer).tolist():
            kind, start = int(self.kind[row]), int(self.start[row])
            data = buffer[start : start + int(self.size[row])].tobytes()
            found[row] = (
                None if kind < _BLOB else str(data, encoding, "replace") if kind % 2 else data
            )
        return found


def columns(cells: Cells, wanted: Sequence[int]) -> tuple[list[Values], Flags]:
    """Return columns of some records, and which records are sound as far as these.

    Args:
        cells: the records; the types of what is wanted must be in their buffer, and numbers that
            are not are of the type -1.
        wanted: numbers of the columns; what a record does not have is NULL.
    """
    buffer, start, size = cells.buffer, cells.start, cells.size
    header, used = varints(buffer, start)
    position, content = start + used, start + header
    sound = (header >= used) & (header <= cells.held) & (content <= len(buffer) - LONGEST_VARINT)
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
        kind[(kind <= _ONE) & (content + width > start + cells.held)] = _ELSEWHERE
        found[column] = Values(kind, content, width)
        position, content = position + used, content + width
    for values in found.values():
        values.kind[~sound] = _ELSEWHERE
    return [found[column] for column in wanted], sound


MessageRows = tuple[Ints, Messages, Bytes]
"""Of some rows, in the order of the table: which leaf page of the table each stands in, (n,)
ascending; the messages; and the buffer that they are in."""


class MessageTable:
    """The table of messages; safe to share among threads."""

    def __init__(self, pages: Pages, root: int, topics: Sequence[int], damage: Damage) -> None:
        """Find the pages of the rows.

        Args:
            pages: of the database.
            root: number of the table's first page.
            topics: ids of the topics that are described.
            damage: receives what is found.
        """
        self.pages = pages
        self._topics = topics
        self._damage = damage
        self._leaves = leaves(pages, root, damage)

    def rows(self) -> Iterator[MessageRows]:
        """Yield all rows, by their first bytes, which tell all but the message."""
        first = 0
        for cells in cells_in(self.pages, self._leaves, self.pages.bytes, self._damage):
            yield self._decoded(first + cells.page, cells, self._damage)
            first += len(cells.buffer) // self.pages.size - 1

    def between(self, *bounds: tuple[int, int]) -> MessageRows:
        """Return the whole rows of leaf pages, from the first to the last of some runs."""
        index = np.concatenate([np.arange(first, last + 1) for first, last in bounds])
        known = Damage()
        cells = cells_of(self.pages, self._leaves[index], known)
        return self._decoded(index[cells.page], with_overflow(self.pages, cells), known)

    def times_around(self, pages: Ints) -> Times:
        """Return the times, ns, of the last row before some pages and of the first behind them.

        None: no such row, or the pages are none of those that hold rows.
        """
        index = np.flatnonzero(np.isin(self._leaves, pages))
        if not len(index):
            return None, None
        before, behind = (self._times_in(int(leaf)) for leaf in (index[0] - 1, index[-1] + 1))
        return (before[-1] if before else None), (behind[0] if behind else None)

    def _times_in(self, leaf: int) -> list[int]:
        """Return the times of the rows of a leaf page; none if there is no such page."""
        if not 0 <= leaf < len(self._leaves):
            return []
        times: list[int] = self.between((leaf, leaf))[1].log_time.tolist()
        return times

    def _decoded(self, leaf: Ints, cells: Cells, damage: Damage) -> MessageRows:
        (topic, time, data), _ = columns(cells, _MESSAGE_COLUMNS)
        times, topics = time.integers(cells.buffer), topic.integers(cells.buffer)
        sound = topic.is_integer & time.is_integer & data.is_blob & (times >= 0)
        rows = np.flatnonzero(sound & np.isin(topics, self._topics))
        damage.unsound += int((~sound).sum())
        damage.undescribed += int(sound.sum()) - len(rows)
        start, at = data.start[rows], times[rows]
        messages = Messages(topics[rows], at, at, 0 * rows, start, start + data.size[rows])
        return leaf[rows], messages, cells.buffer
