"""The pages of a SQLite file, and the cells of a table: a tree whose leaves hold the records.

No SQLite is used: it does what a journal tells it, to other files as well, and reads without end
what refers to itself. The format is described at https://www.sqlite.org/fileformat2.html.
"""

import struct
from collections.abc import Callable, Iterator, Sequence
from typing import Final, NamedTuple

import numpy as np

from dogbot_logtool.core.arrays import Bytes, Flags, Ints, distinct, rows_of_runs
from dogbot_logtool.errors import LogError
from dogbot_logtool.io.storage import name_of
from dogbot_logtool.reader.containers.loss import Loss
from dogbot_logtool.reader.containers.source import ByteSource
from dogbot_logtool.reader.decode.columns import gather

PIECE: Final = 1 << 19
"""Bytes of pages that are read and looked at at once."""
_HEADER: Final = struct.Struct(">16xH2xB3xII24xI32xI4x")
_PAGE_SIZES: Final = frozenset(1 << bits for bits in range(9, 17))
_LEAST_USABLE: Final = 480
_ENCODINGS: Final = {2: "utf-16-le", 3: "utf-16-be"}
_NEAR: Final = 8
"""Pages that are no further apart are read in one go."""
_MOST_PER_WRITTEN: Final = 16
"""A file with holes counts as no longer than this times the bytes that were ever written: of each
page in use, of 64 kB at most, a block of 4 kB at least is no hole."""

LONGEST_VARINT: Final = 9
_INTERIOR, _LEAF = 5, 13
_HEAD: Final = {_INTERIOR: 12, _LEAF: 8}
"""Bytes of a page before its table of cells."""
_BEFORE_FIRST_PAGE: Final = 100
_SMALLEST_CELL: Final = 4
_MOST_LEVELS: Final = 20
SHARED: Final = "its pages are used more than once"
Times = tuple[int | None, int | None]
UNFINISHED: Final = "its recording broke off while rows were written"
SWOLLEN: Final = "its rows claim to hold more than the file"


class Pages:
    """The pages of a database by number, from 1 on; safe to share among threads."""

    def __init__(self, source: ByteSource) -> None:
        """Read the header.

        Raises:
            LogError: it cannot be one.
        """
        self._source = source
        head = source.read(0, _HEADER.size).ljust(_HEADER.size, b"\0")
        size, reserved, change, count, encoding, of_change = _HEADER.unpack(head)
        self.size = size if size != 1 else 1 << 16
        """Bytes of each page."""
        self.usable = self.size - reserved
        """Bytes of each page that hold something."""
        self.bytes = min(source.size, _MOST_PER_WRITTEN * source.written_size())
        """Bytes that all rows together can take; holes in the file hardly count."""
        self.encoding = _ENCODINGS.get(encoding, "utf-8")
        """Of all texts."""
        self.promised = count if change == of_change else None
        """Number of pages as the header has it; None: old writers leave that as it was."""
        if self.size not in _PAGE_SIZES or self.usable < _LEAST_USABLE:
            raise LogError(
                f"{name_of(source.path)}: its database cannot be read: its header is damaged "
                f"(pages of {self.size} bytes, of which {self.usable} may be used)"
            )

    def exist(self, number: Ints) -> Flags:
        """Tell which pages there are, whole."""
        there: Flags = (number > 0) & (number <= self._source.size // self.size)
        return there

    def read(self, number: Ints) -> Bytes:
        """Return pages one behind the other, and one of zeros behind them.

        Args:
            number: (n,); zeros stand for pages that there are not.

        Returns:
            ((n + 1) * size,).
        """
        pages = np.zeros((len(number) + 1, self.size), np.uint8)
        rows = np.flatnonzero(self.exist(number))
        rows = rows[np.argsort(number[rows], kind="stable")]
        breaks = np.flatnonzero(np.diff(number[rows]) > _NEAR) + 1
        for run in np.split(rows, breaks) if len(rows) else ():
            first, last = int(number[run[0]]), int(number[run[-1]])
            size = (last + 1 - first) * self.size
            data = np.frombuffer(self._source.read((first - 1) * self.size, size), np.uint8)
            if len(data) == size:
                pages[run] = data.reshape(-1, self.size)[number[run] - first]
        return pages.reshape(-1)

    def cut_off(self) -> Loss | None:
        """Return what is missing of the pages that the header promises."""
        size, promised = self._source.size, self.promised or 0
        if size // self.size >= promised:
            return None
        what = f"the file is cut off: it promises {promised * self.size} bytes, but has {size}"
        return Loss(size, f"{what}; copy it again", 0, None)


def in_pieces(number: Ints, size: int) -> Sequence[Ints]:
    """Cut numbers of pages of some size into arrays for which `PIECE` bytes are read."""
    most = max(PIECE // size, 1)
    return [number[start : start + most] for start in range(0, len(number), most)]


def unsigned(buffer: Bytes, start: Ints, width: int) -> Ints:
    """Return numbers of 2 or 4 bytes.

    Args:
        buffer: (b,).
        start: (n,), each in [0, b - width].
        width: of each, bytes.
    """
    return gather(buffer, start, width).view(f">u{width}").astype(np.int64)


class Damage:
    """Damage that was met in the pages of a database."""

    def __init__(self) -> None:
        """Begin with none."""
        self.pages: list[Ints] = []
        """Numbers of pages that are no pages of a table, or that hold damaged rows."""
        self.missing = 0
        """Pages that are referred to, but not there."""
        self.rows = 0
        """Damaged rows in sound pages."""
        self.unsound = 0
        """Rows that are no messages: SQLite stores any type in any column."""
        self.undescribed = 0
        """Messages of topics that are nowhere described."""
        self.reasons: set[str] = set()
        """What else is wrong."""

    def look_for_unknown(self, pages: Pages, number: Ints) -> None:
        """Look for pages that the header does not know: they were written, and it was not yet."""
        if pages.promised is not None and (number > pages.promised).any():
            self.reasons.add(UNFINISHED)

    def loss(self, page_size: int, times: Callable[[Ints], Times] | None = None) -> Loss | None:
        """Return what to say of damage to the database.

        Args:
            page_size: bytes.
            times: returns the log times, ns, between which rows of some pages may be missing.
        """
        pages = np.unique(np.concatenate([*self.pages, np.empty(0, np.int64)]))
        reasons = sorted(self.reasons)
        for count, what in ((self.rows, "rows"), (len(pages) + self.missing, "pages")):
            reasons += [f"{count} of its {what} cannot be read"] if count else []
        if not reasons:
            return None
        what = f"the database is damaged ({'; '.join(reasons)}): rows may be missing"
        offset = int(pages[0] - 1) * page_size if len(pages) else 0
        around = times(pages) if times else (None, None)
        return Loss(offset, what, len(pages) * page_size, None, *around)


class Cells(NamedTuple):
    """Rows of a table as they stand in some of its leaf pages."""

    buffer: Bytes
    """The pages."""
    page: Ints
    """(n,) index of each row's page."""
    rowid: Ints
    """(n,)."""
    start: Ints
    """(n,) where the record begins in the buffer."""
    size: Ints
    """(n,) bytes of the record."""
    held: Ints
    """(n,) how many of them stand here; the others in overflow pages."""
    overflow: Ints
    """(n,) number of the first of these; 0: none."""

    def pick(self, rows: Flags | Ints | slice) -> "Cells":
        """Return the chosen rows."""
        columns = (self.page, self.rowid, self.start, self.size, self.held, self.overflow)
        return Cells(self.buffer, *(column[rows] for column in columns))


def leaves(pages: Pages, root: int, damage: Damage) -> Ints:
    """Return the leaf pages of a table in their order, each once.

    All are as far from the root, so the first page of a level that can be read tells which it is.

    Args:
        pages: of the database.
        root: number of the table's first page.
        damage: receives what is found.
    """
    level = np.array([root])
    looked_at = 0
    for _ in range(_MOST_LEVELS):
        kind = _kind(pages, level)
        if kind == _LEAF:
            return level
        if kind != _INTERIOR:
            damage.pages.append(level[pages.exist(level)])
            return level[:0]
        looked_at += len(level)
        level = _children(pages, level, pages.bytes // pages.size - looked_at, damage)
    damage.reasons.add(SHARED)
    return level[:0]


def _kind(pages: Pages, level: Ints) -> int:
    """Return the type of the first page of a table among some; 0 if there is none."""
    for piece in in_pieces(level, pages.size):
        at = np.arange(len(piece)) * pages.size
        kinds = pages.read(piece)[at + _header(piece)]
        known = kinds[(kinds == _INTERIOR) | (kinds == _LEAF)]
        if len(known):
            return int(known[0])
    return 0


def _children(pages: Pages, level: Ints, most: int, damage: Damage) -> Ints:
    """Return the pages that those of a level refer to, at most so many."""
    found: list[Ints] = [level[:0]]
    for piece in in_pieces(level, pages.size):
        buffer = pages.read(piece)
        page, offset, sound = _cell_offsets(buffer, piece, pages, _INTERIOR)
        last = np.flatnonzero(sound)
        # The last child stands in the page's header.
        place = np.concatenate([offset, last * pages.size + _header(piece)[last] + 8])
        order = np.argsort(np.concatenate([page, last]), kind="stable")
        children = unsigned(buffer, place[order[: most + 1]], 4)
        there = pages.exist(children)
        damage.pages.append(piece[~sound])
        damage.missing += int((~there).sum())
        found.append(children[there])
        damage.look_for_unknown(pages, children)
        most -= len(children)
        if most < 0:
            damage.reasons.add(SHARED)
            break
    level = np.concatenate(found)
    _, first = np.unique(level, return_index=True)
    if len(first) < len(level):
        damage.reasons.add(SHARED)
    return level[np.sort(first)]


def cells_in(pages: Pages, number: Ints, most: int, damage: Damage) -> Iterator[Cells]:
    """Yield the rows in some leaf pages, some pages at a time, as they stand there.

    Args:
        pages: of the database.
        number: (p,) of the leaf pages.
        most: bytes after which no more rows are taken.
        damage: receives what is found.
    """
    for piece in in_pieces(number, pages.size):
        cells = cells_of(pages, piece, damage)
        fits = np.cumsum(cells.size) <= most
        yield cells if fits.all() else cells.pick(fits)
        if not fits.all():
            damage.reasons.add(SWOLLEN)
            return
        most -= int(cells.size.sum())


def cells_of(pages: Pages, number: Ints, damage: Damage) -> Cells:
    """Return the rows in some leaf pages.

    Args:
        pages: of the database.
        number: (p,) of the leaf pages.
        damage: receives what is found: pages that are none, and damaged rows, which are left out.
    """
    buffer = pages.read(number)
    page, offset, good = _cell_offsets(buffer, number, pages, _LEAF)
    size, used = varints(buffer, offset)
    rowid, more = varints(buffer, offset + used)
    start = offset + used + more
    held = _held(size, pages.usable)
    is_whole = held == size
    end = start + held + np.where(is_whole, 0, 4)
    sound = (size >= 0) & (size <= pages.bytes) & (end <= page * pages.size + pages.usable)
    overflow = np.zeros(len(page), np.int64)
    spilt = np.flatnonzero(sound & ~is_whole)
    overflow[spilt] = unsigned(buffer, end[spilt] - 4, 4)
    sound[spilt] &= pages.exist(overflow[spilt])
    damage.look_for_unknown(pages, overflow)
    # Cells that lie over each other would be read without end.
    occupied = np.bincount(page[sound], (end - offset)[sound], minlength=len(number))
    overfull = occupied > pages.usable
    sound &= ~overfull[page]
    good &= ~overfull
    good[page[~sound]] = False
    damage.pages.append(number[~good])
    return Cells(buffer, page, rowid, start, size, held, overflow).pick(sound)


def _held(size: Ints, usable: int) -> Ints:
    """Return how many bytes of records of some sizes stand in the leaf page itself."""
    most, least = usable - 35, (usable - 12) * 32 // 255 - 23
    spilt = least + (size - least) % (usable - 4)
    return np.where(size <= most, size, np.where(spilt <= most, spilt, least))


def _header(number: Ints) -> Ints:
    """Return where the header of each page begins in it."""
    return np.where(number == 1, _BEFORE_FIRST_PAGE, 0)


def _cell_offsets(buffer: Bytes, number: Ints, pages: Pages, kind: int) -> tuple[Ints, Ints, Flags]:
    """Return where the cells of some pages are.

    Args:
        buffer: the pages.
        number: (p,) of each.
        pages: of the database.
        kind: type that the pages must have.

    Returns:
        Index of each cell's page and its offset in the buffer, (n,); and which pages are sound,
        (p,).
    """
    begin = np.arange(len(number)) * pages.size
    head = begin + _header(number)
    table = head + _HEAD[kind]
    count = unsigned(buffer, head + 3, 2)
    sound = (buffer[head] == kind) & (table + 2 * count <= begin + pages.usable)
    # The content of a page without cells begins at its end.
    sound &= (count > 0) | (unsigned(buffer, head + 5, 2) == pages.usable % (1 << 16))
    count[~sound] = 0
    index, page, _ = rows_of_runs(0 * count, count)
    offset = unsigned(buffer, table[page] + 2 * index, 2)
    good = (offset + begin[page] >= (table + 2 * count)[page]) & (
        offset <= pages.usable - _SMALLEST_CELL
    )
    sound[page[~good]] = False
    return page[good], (begin[page] + offset)[good], sound


def with_overflow(pages: Pages, cells: Cells) -> Cells:
    """Return rows whose records stand whole in their buffer; of those that cannot, nothing does."""
    spilt = np.flatnonzero(cells.overflow)
    if not len(spilt):
        return cells
    each, most = pages.usable - 4, pages.usable - 35
    needed = -(-(cells.size - cells.held)[spilt] // each)
    chain, complete = _chains(pages, cells.overflow[spilt], needed)
    chain = chain[np.repeat(complete, needed)]
    needed[~complete] = 0
    index, row, _ = rows_of_runs(0 * needed, needed)
    held, local = cells.held[spilt], cells.start[spilt]
    room = np.where(complete, held + needed * each, 0)
    begin = len(cells.buffer) + np.cumsum(room) - room
    buffer = np.concatenate([cells.buffer, np.zeros(int(room.sum()) + most, np.uint8)])
    # The bytes in the leaf differ in number: as many as may be are copied, before the others.
    _scatter(buffer, begin[complete], cells.buffer, local[complete], most)
    target = begin[row] + held[row] + index * each
    for piece in in_pieces(np.arange(len(chain)), pages.size):
        content = pages.read(chain[piece])
        _scatter(buffer, target[piece], content, np.arange(len(piece)) * pages.size + 4, each)
    start, whole = cells.start.copy(), cells.held.copy()
    start[spilt], whole[spilt] = begin, np.where(complete, cells.size[spilt], 0)
    return cells._replace(buffer=buffer, start=start, held=whole)


def _scatter(target: Bytes, to: Ints, source: Bytes, start: Ints, size: int) -> None:
    """Copy runs of some bytes through overlapping views."""
    windows, content = (
        np.ndarray((len(buffer) - size + 1,), f"V{size}", buffer.data, 0, (1,))
        for buffer in (target, source)
    )
    windows[to] = content[start]


def _chains(pages: Pages, first: Ints, needed: Ints) -> tuple[Ints, Flags]:
    """Follow chains of overflow pages, which mostly stand one behind the other in the file.

    Args:
        pages: of the database.
        first: (n,) page that each chain begins with.
        needed: (n,) number of pages in each.

    Returns:
        Numbers of all pages, chain by chain (the sum of `needed`,), and which chains are complete
        and share no page, (n,).
    """
    index, owner, _ = rows_of_runs(0 * needed, needed)
    chain = first[owner] + index
    goes_on = index < needed[owner] - 1
    broken = distinct(owner[goes_on & (_links(pages, chain) != chain + 1)])
    end = np.cumsum(needed)
    for row in broken.tolist():
        part = chain[end[row] - needed[row] : end[row]]
        for place in range(1, len(part)):
            part[place] = _links(pages, part[place - 1 : place])[0]
    _, once = np.unique(chain, return_index=True)
    is_bad = ~pages.exist(chain)
    again = np.ones(len(chain), np.bool_)
    again[once] = False
    return chain, np.bincount(owner, is_bad | again, len(first)) == 0


def _links(pages: Pages, number: Ints) -> Ints:
    """Return the page that follows each of some overflow pages; 0: none."""
    found = [
        unsigned(pages.read(piece), np.arange(len(piece)) * pages.size, 4)
        for piece in in_pieces(number, pages.size)
    ]
    return np.concatenate(found)


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
