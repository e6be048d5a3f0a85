"""The rows of the table of messages, as columns."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Bytes, Flags, Ints
from dogbot_logtool.reader.containers.sqlite.pages import Pages
from dogbot_logtool.reader.containers.sqlite.tables import Table, columns
from dogbot_logtool.reader.containers.sqlite.tree import (
    Cells,
    Damage,
    cells_in,
    cells_of,
    leaves,
    with_overflow,
)

_COLUMNS: Final = ("topic_id", "timestamp", "data")


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class MessageRows:
    """Some rows, in the order of the table."""

    leaf: Ints
    """(n,) ascending; which leaf page of the table each stands in."""
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

    def __init__(self, pages: Pages, table: Table, damage: Damage) -> None:
        """Find the pages of the rows."""
        self.pages = pages
        self._wanted = [table.columns[name] for name in _COLUMNS]
        self._damage = damage
        self._leaves = leaves(pages, table.root, damage)

    def rows(self) -> Iterator[MessageRows]:
        """Yield all rows, by their first bytes, which tell all but the message."""
        first = 0
        for cells in cells_in(self.pages, self._leaves, self.pages.bytes, self._damage):
            yield self._decoded(first + cells.page, cells)
            first += len(cells.buffer) // self.pages.size - 1

    def between(self, *bounds: tuple[int, int]) -> MessageRows:
        """Return the whole rows of leaf pages, from the first to the last of some runs."""
        index = np.concatenate([np.arange(first, last + 1) for first, last in bounds])
        cells = cells_of(self.pages, self._leaves[index], Damage())
        return self._decoded(index[cells.page], with_overflow(self.pages, cells))

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
        rows = self.between((leaf, leaf))
        times: list[int] = rows.time[rows.sound].tolist()
        return times

    def _decoded(self, leaf: Ints, cells: Cells) -> MessageRows:
        (topic, time, data), _ = columns(cells, self._wanted)
        times = time.integers(cells.buffer)
        sound = topic.is_integer & time.is_integer & data.is_blob & (times >= 0)
        topics = topic.integers(cells.buffer)
        return MessageRows(leaf, sound, topics, times, data.start, data.size, cells.buffer)
