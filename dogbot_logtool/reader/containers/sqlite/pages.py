"""The pages of a SQLite file, with those that a journal beside it replaces.

No SQLite is used: it does what a journal tells it, to other files as well, and reads without end
what refers to itself. The format is described at https://www.sqlite.org/fileformat2.html.
"""

import stat
import struct
from collections.abc import Iterator, Sequence
from functools import cache
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.arrays import Bytes, Flags, Ints
from dogbot_logtool.errors import LogError, LogtoolError
from dogbot_logtool.io.storage import Location, name_of
from dogbot_logtool.reader.containers.loss import Loss
from dogbot_logtool.reader.containers.source import ByteSource
from dogbot_logtool.reader.decode.columns import gather, gather_bytes

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
ROLLBACK_MAGIC: Final = bytes.fromhex("d9d505f920a163d7")
_ROLLBACK_HEADER: Final = struct.Struct(">8s5I")
_SECTOR_SIZES: Final = frozenset(1 << bits for bits in range(5, 17))
_AROUND_PAGE: Final = 8
"""Bytes of the number before a saved page and of the checksum behind it."""
_SUMMED_EVERY: Final = 200
"""Bytes between those that a checksum adds up."""
_LOCK_BYTE: Final = 1 << 30
"""The page that holds it holds nothing else. In a journal its number stands before the name of
another journal, of several databases, which SQLite would open and delete, and we do not."""
_WAL_HEADER: Final = struct.Struct(">8I")
_ORDERS: Final = {0x377F0682: "<u4", 0x377F0683: ">u4"}
"""Byte order of the numbers that checksums add up, by the magic."""
_VERSION: Final = 3007000
_FRAME_HEAD: Final = struct.Struct(">6I")
_SUMMED: Final = 8
"""Bytes of it that its checksum covers."""

_Words = NDArray[np.uint32]


class JournalError(LogtoolError):
    """A journal cannot be used."""


class Pages:
    """The pages of a database by number, from 1 on; safe to share among threads."""

    encoding: str
    """Of all texts."""
    promised: int | None
    """Number of pages as the header has it; None: old writers leave that as it was."""

    def __init__(self, source: ByteSource) -> None:
        """Read the header.

        Raises:
            LogError: it cannot be one.
        """
        self._files = [source]
        # Numbers, files and offsets of the pages that are taken from elsewhere.
        self._elsewhere = np.empty((0, 3), np.int64)
        head = source.read(0, _HEADER.size).ljust(_HEADER.size, b"\0")
        size, reserved, *_ = _HEADER.unpack(head)
        self.size = size if size != 1 else 1 << 16
        """Bytes of each page."""
        self.usable = self.size - reserved
        """Bytes of each page that hold something."""
        self.bytes = min(source.size, _MOST_PER_WRITTEN * source.written_size())
        """Bytes that all rows together can take; holes in the file hardly count."""
        if self.size not in _PAGE_SIZES or self.usable < _LEAST_USABLE:
            raise LogError(
                f"{name_of(source.path)}: its database cannot be read: its header is damaged "
                f"(pages of {self.size} bytes, of which {self.usable} may be used)"
            )
        self._read_header(head)

    def keep(self, file: ByteSource) -> None:
        """Close a journal with the database."""
        self._files.append(file)

    def replace(self, file: ByteSource, pages: Sequence[tuple[int, int]]) -> None:
        """Take pages from a journal that is kept.

        Args:
            file: the journal.
            pages: numbers and offsets in it; the last of each number counts.
        """
        frames = np.array(pages, np.int64).reshape(-1, 2)
        frames = np.insert(frames, 1, self._files.index(file), axis=1)
        every = np.concatenate([self._elsewhere, frames])[::-1]
        self._elsewhere = every[np.unique(every[:, 0], return_index=True)[1]]
        self.bytes += len(pages) * self.size
        self._read_header(self.read(np.array([1])).tobytes())

    def _read_header(self, page: bytes) -> None:
        _, _, change, count, encoding, of_change = _HEADER.unpack_from(page)
        self.encoding = _ENCODINGS.get(encoding, "utf-8")
        self.promised = count if change == of_change else None

    def exist(self, number: Ints) -> Flags:
        """Tell which pages there are, whole."""
        return self._find(number)[0] >= 0

    def read(self, number: Ints) -> Bytes:
        """Return pages one behind the other, and one of zeros behind them.

        Args:
            number: (n,); zeros stand for pages that there are not.

        Returns:
            ((n + 1) * size,).
        """
        pages = np.zeros((len(number) + 1, self.size), np.uint8)
        found, offset = self._find(number)
        for index, file in enumerate(self._files):
            rows = np.flatnonzero(found == index)
            rows = rows[np.argsort(offset[rows], kind="stable")]
            breaks = np.flatnonzero(np.diff(offset[rows]) > _NEAR * self.size) + 1
            for run in np.split(rows, breaks) if len(rows) else ():
                start, end = int(offset[run[0]]), int(offset[run[-1]]) + self.size
                data = np.frombuffer(file.read(start, end - start), np.uint8)
                if len(data) == end - start:
                    pages[run] = gather_bytes(data, offset[run] - start, self.size)
        return pages.reshape(-1)

    def _find(self, number: Ints) -> tuple[Ints, Ints]:
        """Return the file that each page stands in, -1 for none, and where it begins there."""
        offset = (number - 1) * self.size
        there = (number > 0) & (offset <= self._files[0].size - self.size)
        file = np.where(there, 0, -1)
        row = np.searchsorted(self._elsewhere[:, 0], number)
        here = np.flatnonzero(row < len(self._elsewhere))
        here = here[self._elsewhere[row[here], 0] == number[here]]
        _, file[here], offset[here] = self._elsewhere[row[here]].T
        return file, offset

    def cut_off(self) -> Loss | None:
        """Return what is missing of the pages that the header promises."""
        size, promised = self._files[0].size, self.promised or 0
        there = size // self.size
        if there + int((self._elsewhere[:, 0] > there).sum()) >= promised:
            return None
        what = f"the file is cut off: it promises {promised * self.size} bytes, but has {size}"
        return Loss(size, f"{what}; copy it again", 0, None)

    def close(self) -> None:
        """Close the file, and those that pages are taken from."""
        for file in self._files:
            file.close()


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


def take_journals(pages: Pages, path: Location) -> Iterator[Loss]:
    """Take what the journals beside a database hold; yield what there is to say of them.

    Nothing is written anywhere, and of the journals only regular files are opened.

    Args:
        pages: of the database; receives those of the journals.
        path: of the database. A copy of an object in a store has no journals.
    """
    if not isinstance(path, Path):
        return
    path = path.resolve()
    for suffix, use in (("-journal", _roll_back), ("-wal", _go_on)):
        beside = path.with_name(path.name + suffix)
        try:
            file = _opened(beside)
            what = use(pages, file) if file else ""
        except LogtoolError as error:
            why = str(error).replace(f"{beside}: ", "it ")
            what = f"cannot be used ({why}); the log was read without it"
        if what:
            yield Loss(0, f"{beside.name} beside it {what}", 0, None)


def _opened(path: Path) -> ByteSource | None:
    """Open a journal; None: there is none, or it is empty."""
    try:
        status = path.lstat()
    except OSError:
        return None
    if stat.S_ISLNK(status.st_mode):
        raise JournalError("it is a link")
    return ByteSource(path) if status.st_size or not stat.S_ISREG(status.st_mode) else None


def _roll_back(pages: Pages, file: ByteSource) -> str:
    """Put back the pages that a rollback journal saved; return what to say."""
    pages.keep(file)
    if file.read(0, len(ROLLBACK_MAGIC)) != ROLLBACK_MAGIC:
        # Its transaction was completed, and its header overwritten.
        return ""
    pages.replace(file, [*_saved_pages(file, pages.size)])
    return (
        "tells what rows were before they were written, since its recording broke off meanwhile; "
        "the log was read so"
    )


def _saved_pages(file: ByteSource, page_size: int) -> Iterator[tuple[int, int]]:
    """Yield number and offset of saved pages, up to the first that is not sound."""
    head = file.read(0, _ROLLBACK_HEADER.size).ljust(_ROLLBACK_HEADER.size, b"\0")
    _, _, _, pages, sector, size = _ROLLBACK_HEADER.unpack(head)
    if sector not in _SECTOR_SIZES:
        raise JournalError("its header is damaged")
    _check_page_size(size, page_size)
    record = page_size + _AROUND_PAGE
    offset = 0
    while head.startswith(ROLLBACK_MAGIC):
        _, count, nonce, *_ = _ROLLBACK_HEADER.unpack(head)
        offset += sector
        # More than there are stands for as many as there are.
        for _ in range(min(count, (file.size - offset) // record)):
            saved = file.read(offset, record)
            number, page = int.from_bytes(saved[:4], "big"), saved[4:-4]
            total = nonce + sum(page[-_SUMMED_EVERY:0:-_SUMMED_EVERY])
            is_page = number > 0 and number != _LOCK_BYTE // page_size + 1
            if not is_page or total & 0xFFFFFFFF != int.from_bytes(saved[-4:], "big"):
                return
            if number <= pages:
                yield number, offset + 4
            offset += record
        offset += -offset % sector
        head = file.read(offset, _ROLLBACK_HEADER.size).ljust(_ROLLBACK_HEADER.size, b"\0")


def _go_on(pages: Pages, file: ByteSource) -> str:
    """Put in the pages of a write-ahead log; return what to say.

    Its frames are pages with a head. The first one that is not sound ends it: what follows is of
    an earlier use of the file, or was being written when the recorder was killed.
    """
    pages.keep(file)
    head = file.read(0, _WAL_HEADER.size).ljust(_WAL_HEADER.size, b"\0")
    magic, version, size, _, *rest = _WAL_HEADER.unpack(head)
    order = _ORDERS.get(magic, "")
    salts, sums = tuple(rest[:2]), np.array(rest[2:], np.uint32)
    is_sound = order and version == _VERSION
    if not is_sound or (_sums(head[: -sums.nbytes], order, 0 * sums) != sums).any():
        raise JournalError("its header is damaged")
    _check_page_size(size, pages.size)
    frame_size = _FRAME_HEAD.size + size
    frames: list[tuple[int, int]] = []
    committed = damaged_at = 0
    for offset in range(_WAL_HEADER.size, file.size - frame_size + 1, frame_size):
        frame = file.read(offset, frame_size)
        number, commits, *rest = _FRAME_HEAD.unpack_from(frame)
        is_own = number > 0 and tuple(rest[:2]) == salts
        if damaged_at and offset > damaged_at + PIECE:
            break
        if damaged_at:
            # Frames of a transaction that was not completed may well be wrong.
            if is_own and commits:
                pages.replace(file, frames[:committed])
                return f"is damaged at byte {damaged_at}; what was recorded after that is lost"
            continue
        sums = _sums(frame[:_SUMMED] + frame[_FRAME_HEAD.size :], order, sums)
        if not is_own or (sums != rest[2:]).any():
            damaged_at = offset
            continue
        frames.append((number, offset + _FRAME_HEAD.size))
        committed = len(frames) if commits else committed
    pages.replace(file, frames[:committed])
    return ""


def _check_page_size(size: int, expected: int) -> None:
    if size != expected:
        raise JournalError(f"its pages have {size} bytes, those of the database {expected}")


def _sums(data: bytes, order: str, before: _Words) -> _Words:
    """Return checksums: s += x + t, t += y + s for each two numbers x, y, all modulo 2**32.

    Each number is so added up a Fibonacci number of times.

    Args:
        data: some multiple of 8 bytes.
        order: dtype of the numbers in it.
        before: (2,) s and t before.

    Returns:
        (2,).
    """
    words = np.frombuffer(data, order).astype(np.uint32)
    weights = _fibonacci(len(words) + 2)
    of_words = np.column_stack([weights[-3::-1], weights[-2:0:-1]])
    of_before = np.stack([weights[-3:-1], weights[-2:]])
    return words @ of_words + of_before @ before


@cache
def _fibonacci(count: int) -> _Words:
    numbers = [0, 1]
    while len(numbers) < count:
        numbers.append((numbers[-1] + numbers[-2]) & 0xFFFFFFFF)
    return np.array(numbers, np.uint32)
