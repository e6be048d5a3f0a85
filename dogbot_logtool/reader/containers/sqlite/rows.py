"""The rows of the table of messages, as messages."""

from collections.abc import Iterator, Sequence
from typing import Final, NamedTuple

import numpy as np

from dogbot_logtool.core.arrays import Bytes, Ints
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
from dogbot_logtool.reader.decode.message_table import Messages

_COLUMNS: Final = ("topic_id", "timestamp", "data")


class MessageRows(NamedTuple):
    """Some rows, in the order of the table."""

    leaf: Ints
    """(n,) ascending; which leaf page of the table each message stands in."""
    messages: Messages
    buffer: Bytes
    undescribed: int
    """Messages of other topics, left out."""
    unsound: int
    """Rows that are no messages, left out: SQLite stores any type in any column."""


class MessageTable:
    """The table of messages; safe to share among threads."""

    def __init__(self, pages: Pages, table: Table, topics: Sequence[int], damage: Damage) -> None:
        """Find the pages of the rows.

        Args:
            pages: of the database.
            table: the table.
            topics: ids of the topics that are described.
            damage: receives what is found.
        """
        self.pages = pages
        self._topics = topics
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
        times: list[int] = self.between((leaf, leaf)).messages.log_time.tolist()
        return times

    def _decoded(self, leaf: Ints, cells: Cells) -> MessageRows:
        (topic, time, data), _ = columns(cells, self._wanted)
        times, topics = time.integers(cells.buffer), topic.integers(cells.buffer)
        sound = topic.is_integer & time.is_integer & data.is_blob & (times >= 0)
        known = sound & np.isin(topics, self._topics)
        rows = np.flatnonzero(known)
        start, at = data.start[rows], times[rows]
        messages = Messages(topics[rows], at, at, 0 * rows, start, start + data.size[rows])
        unsound = len(sound) - int(sound.sum())
        undescribed = len(sound) - unsound - len(rows)
        return MessageRows(leaf[rows], messages, cells.buffer, undescribed, unsound)
