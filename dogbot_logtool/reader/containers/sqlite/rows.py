"""The rows of the table of messages, as columns."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Bytes, Flags, Ints, distinct
from dogbot_logtool.reader.containers.sqlite.database import Database
from dogbot_logtool.reader.containers.sqlite.pages import PIECE, in_pieces
from dogbot_logtool.reader.containers.sqlite.records import columns
from dogbot_logtool.reader.containers.sqlite.tree import (
    SWOLLEN,
    Cells,
    Damage,
    cells_of,
    leaves,
    with_overflow,
)

CELL_BITS: Final = 16
"""Of the position of a row: in them the index in its leaf page, above them the index of that."""


@dataclass(frozen=True, slots=True)
class MessageRows:
    """Some rows."""

    position: Ints
    """(n,) ascending; where each stands in the table."""
    sound: Flags
    """(n,) which are messages: SQLite stores any type in any column."""
    topic: Ints
    """(n,) topic id."""
    time: Ints
    """(n,) ns."""
    start: Ints
    """(n,) where each message begins in the buffer, if its row is whole there."""
    size: Ints
    """(n,) bytes of it."""
    buffer: Bytes


class MessageTable:
    """The table of messages; safe to share among threads."""

    def __init__(self, database: Database) -> None:
        """Find the pages of the rows."""
        self.pages = database.pages
        self._table = database.tables["messages"]
        self._damage = database.damage
        self._leaves = leaves(self.pages, self._table.root, self._damage)

    def rows(self) -> Iterator[MessageRows]:
        """Yield all rows as they stand in the file, from a few megabytes at a time."""
        left = self.pages.bytes
        for index in in_pieces(np.arange(len(self._leaves)), self.pages.size):
            cells = cells_of(self.pages, self._leaves[index], self._damage)
            few = cells.pick(np.cumsum(cells.size) <= left)
            yield self._described(index, few)
            left -= int(few.size.sum())
            if len(few.size) < len(cells.size):
                self._damage.reasons.add(SWOLLEN)
                return

    def _described(self, index: Ints, cells: Cells) -> MessageRows:
        """Return rows by their first bytes, which mostly tell all but the message."""
        rows = self._decoded(index, cells)
        doubtful = np.flatnonzero((cells.overflow > 0) & ~rows.sound)
        parts = np.cumsum(cells.size[doubtful]) // PIECE
        for part in np.split(doubtful, np.flatnonzero(np.diff(parts)) + 1) if len(parts) else ():
            whole = self._decoded(index, with_overflow(self.pages, cells.pick(part)))
            for column in ("sound", "topic", "time", "size"):
                getattr(rows, column)[part] = getattr(whole, column)
        return rows

    def between(self, bounds: Sequence[tuple[int, int]]) -> MessageRows:
        """Return whole rows.

        Args:
            bounds: positions of the first and the last row of each run.
        """
        runs = [np.arange(first >> CELL_BITS, (last >> CELL_BITS) + 1) for first, last in bounds]
        index = distinct(np.concatenate(runs))
        cells = cells_of(self.pages, self._leaves[index], Damage())
        position = _position(index, cells)
        wanted = np.zeros(len(position), np.bool_)
        for first, last in bounds:
            wanted |= (position >= first) & (position <= last)
        return self._decoded(index, with_overflow(self.pages, cells.pick(wanted)))

    def times_around(self, pages: Ints) -> tuple[int | None, int | None]:
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
        first = leaf << CELL_BITS
        rows = self.between([(first, first | (1 << CELL_BITS) - 1)])
        times: list[int] = rows.time[rows.sound].tolist()
        return times

    def _decoded(self, index: Ints, cells: Cells) -> MessageRows:
        numbers = self._table.columns
        wanted = [numbers[name] for name in ("topic_id", "timestamp", "data")]
        (*found, data), _ = columns(cells.buffer, cells.start, cells.size, cells.held, wanted)
        sound = data.is_blob
        values: list[Ints] = []
        for number, column in zip(wanted, found, strict=False):
            is_key = (column.kind == 0) & (number == self._table.key)
            sound &= column.is_integer | is_key
            values.append(np.where(is_key, cells.rowid, column.integers(cells.buffer)))
        topic, time = values
        sound &= time >= 0
        position = _position(index, cells)
        return MessageRows(position, sound, topic, time, data.start, data.size, cells.buffer)


def _position(index: Ints, cells: Cells) -> Ints:
    return index[cells.page] << CELL_BITS | cells.index
