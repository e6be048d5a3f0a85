"""The journals that a killed recorder leaves beside a database.

A rollback journal (``-journal``) holds pages as they were before an unfinished transaction, a
write-ahead log (``-wal``) pages that were committed, but not yet written to the database.
"""

import stat
import struct
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.arrays import Bytes, Flags, Ints
from dogbot_logtool.errors import LogtoolError
from dogbot_logtool.io.storage import Location
from dogbot_logtool.reader.containers.loss import Loss
from dogbot_logtool.reader.containers.sources.source import ByteSource
from dogbot_logtool.reader.containers.sqlite.pages import PIECE, JournalError, Pages

ROLLBACK_MAGIC: Final = bytes.fromhex("d9d505f920a163d7")
_ROLLBACK_HEADER: Final = struct.Struct(">8s5I")
_SECTOR_SIZES: Final = frozenset(1 << bits for bits in range(5, 17))
_NUMBER_SIZE = _SUM_SIZE = 4
_SUMMED_EVERY: Final = 200
"""Bytes between those that a checksum adds up."""
_LOCK_BYTE: Final = 1 << 30
"""The page that holds it holds nothing else. In a journal its number stands before the name of
another journal, of several databases, which SQLite would open and delete, and we do not."""


def saved_pages(file: ByteSource, page_size: int) -> Ints:
    """Return the numbers and offsets, (n, 2), of the pages that a rollback journal saved.

    Args:
        file: with the magic of one.
        page_size: of the database, bytes.

    Raises:
        JournalError: it is no journal of this database.
    """
    head = file.read(0, _ROLLBACK_HEADER.size).ljust(_ROLLBACK_HEADER.size, b"\0")
    _, _, _, pages, sector, size = _ROLLBACK_HEADER.unpack(head)
    if sector not in _SECTOR_SIZES:
        raise JournalError("its header is damaged")
    if size != page_size:
        raise JournalError(f"its pages have {size} bytes, those of the database {page_size}")
    found = np.concatenate([np.empty((0, 2), np.int64), *_sections(file, page_size, sector)])
    saved: Ints = found[found[:, 0] <= pages]
    return saved


def _sections(file: ByteSource, page_size: int, sector: int) -> Iterator[Ints]:
    """Yield (n, 2) number and offset of saved pages, up to the first that is not sound."""
    record = page_size + _NUMBER_SIZE + _SUM_SIZE
    offset = 0
    while (head := file.read(offset, _ROLLBACK_HEADER.size)).startswith(ROLLBACK_MAGIC):
        _, count, nonce, *_ = _ROLLBACK_HEADER.unpack(head.ljust(_ROLLBACK_HEADER.size, b"\0"))
        offset += sector
        # More than there are stands for as many as there are.
        left = min(count, (file.size - offset) // record)
        if left <= 0:
            return
        while left > 0:
            most = min(left, PIECE // record)
            records = np.frombuffer(file.read(offset, most * record), np.uint8).reshape(-1, record)
            number, sound = _checked(records, nonce)
            good = int(np.append(sound, [False]).argmin())
            yield np.column_stack([number, offset + _NUMBER_SIZE + record * np.arange(most)])[:good]
            if good < most:
                return
            left, offset = left - most, offset + most * record
        offset += -offset % sector


def _checked(records: Bytes, nonce: int) -> tuple[Ints, Flags]:
    """Return the numbers of saved pages, and which are sound, (n,)."""
    number = records[:, :_NUMBER_SIZE].copy().view(">u4")[:, 0].astype(np.int64)
    expected = records[:, -_SUM_SIZE:].copy().view(">u4")[:, 0]
    page = records[:, _NUMBER_SIZE:-_SUM_SIZE]
    sums = nonce + page[:, -_SUMMED_EVERY:0:-_SUMMED_EVERY].sum(axis=1, dtype=np.int64)
    is_page = (number > 0) & (number != _LOCK_BYTE // page.shape[1] + 1)
    return number, is_page & (sums & 0xFFFFFFFF == expected)


_WAL_HEADER: Final = struct.Struct(">8I")
_ORDERS: Final = {0x377F0682: "<u4", 0x377F0683: ">u4"}
"""Byte order of the numbers that checksums add up, by the magic."""
_VERSION: Final = 3007000
_FRAME_HEAD: Final = 24
_SUMMED: Final = 8
"""Bytes of it that its checksum covers."""

_Words = NDArray[np.uint32]


class WriteAheadLog:
    """A file of frames, each a page with a head; the first one that is not sound ends it.

    What follows that one is of an earlier use of the file, or was being written when the recorder
    was killed.
    """

    problem = ""
    """What is wrong with it, known when it has been read."""

    def __init__(self, file: ByteSource, page_size: int) -> None:
        """Read the header.

        Args:
            file: not empty.
            page_size: of the database, bytes.

        Raises:
            JournalError: it is no log for this database.
        """
        self._file = file
        self._page_size = page_size
        head = file.read(0, _WAL_HEADER.size).ljust(_WAL_HEADER.size, b"\0")
        magic, version, size, _, *rest = _WAL_HEADER.unpack(head)
        self._salts, self._sum = np.array(rest, np.uint32).reshape(2, 1, 2)
        self._order = _ORDERS.get(magic, "")
        if not self._order or version != _VERSION or not self._is_sound(head):
            raise JournalError("its header is damaged")
        if size != page_size:
            raise JournalError(f"its pages have {size} bytes, those of the database {page_size}")

    def _is_sound(self, head: bytes) -> bool:
        summed = np.frombuffer(head, np.uint8)[None, : _WAL_HEADER.size - self._sum.nbytes]
        return bool((_sums(summed, self._order, 0 * self._sum) == self._sum).all())

    def committed(self) -> Ints:
        """Return the numbers and offsets, (n, 2), of pages that completed transactions wrote."""
        frames = np.concatenate([np.empty((0, 3), np.int64), *self._frames()])
        commits = np.flatnonzero(frames[:, 1])
        return frames[: commits[-1] + 1 if len(commits) else 0, ::2]

    def _frames(self) -> Iterator[Ints]:
        """Yield (n, 3) page, whether it completes a transaction, and its offset."""
        frame_size = _FRAME_HEAD + self._page_size
        most = PIECE // frame_size * frame_size
        offset, before = _WAL_HEADER.size, self._sum
        while True:
            data = np.frombuffer(self._file.read(offset, most), np.uint8)
            frames = data[: len(data) // frame_size * frame_size].reshape(-1, frame_size)
            if not len(frames):
                return
            words = frames[:, :_FRAME_HEAD].copy().view(">u4").astype(np.uint32)
            own = (words[:, 0] > 0) & (words[:, 2:4] == self._salts).all(axis=1)
            summed = np.concatenate([frames[:, :_SUMMED], frames[:, _FRAME_HEAD:]], axis=1)
            sums = _sums(summed, self._order, np.concatenate([before, words[:-1, 4:]]))
            sound = np.append(own & (sums == words[:, 4:]).all(axis=1), [False])
            count = int(sound.argmin())
            offsets = offset + _FRAME_HEAD + frame_size * np.arange(count)
            yield np.column_stack([words[:count, :2].astype(np.int64), offsets])
            offset, before = offset + count * frame_size, words[-1:, 4:]
            # Frames of a transaction that was not completed may well be wrong.
            if (own & (words[:, 1] > 0))[count + 1 :].any():
                self.problem = f"damaged at byte {offset}"
            if count < len(frames):
                return


def _sums(data: Bytes, order: str, before: _Words) -> _Words:
    """Return checksums: s += x + t, t += y + s for each two numbers x, y, all modulo 2**32.

    Each number is so added up a Fibonacci number of times.

    Args:
        data: (n, k), k a multiple of 8.
        order: dtype of the numbers in it.
        before: (n, 2) s and t before.

    Returns:
        (n, 2).
    """
    words = data.view(order).astype(np.uint32)
    count = words.shape[1]
    weights = _fibonacci(count + 2)
    both = np.column_stack([weights[count - 1 :: -1], weights[count:0:-1]])
    of_before = weights[[[count - 1, count], [count, count + 1]]]
    return words @ both + before @ of_before


@cache
def _fibonacci(count: int) -> _Words:
    numbers = [0, 1]
    while len(numbers) < count:
        numbers.append((numbers[-1] + numbers[-2]) & 0xFFFFFFFF)
    return np.array(numbers, np.uint32)


def take_journals(pages: Pages, path: Location) -> list[Loss]:
    """Take what the journals beside a database hold; return what there is to say of them.

    Nothing is written anywhere, and of the journals only regular files are opened.

    Args:
        pages: of the database; receives those of the journals.
        path: of the database. A copy of an object in a store has no journals.
    """
    if not isinstance(path, Path):
        return []
    path = path.resolve()
    losses = [
        _take(pages, path.with_name(path.name + suffix), use)
        for suffix, use in (("-journal", _roll_back), ("-wal", _go_on))
    ]
    return [loss for loss in losses if loss is not None]


def _take(pages: Pages, path: Path, use: Callable[[Pages, ByteSource], str | None]) -> Loss | None:
    try:
        file = _opened(path)
        if file is None:
            return None
        try:
            what = use(pages, file)
        except BaseException:
            file.close()
            raise
    except JournalError as error:
        what = f"cannot be used ({error}); the log was read without it"
    except LogtoolError as error:
        why = str(error).removeprefix(f"{path}: ")
        what = f"cannot be used (it {why}); the log was read without it"
    return None if what is None else Loss(0, f"{path.name} beside it {what}", 0, None)


def _opened(path: Path) -> ByteSource | None:
    """Open a journal; None: there is none, or it is empty."""
    try:
        status = path.lstat()
    except OSError:
        return None
    if stat.S_ISLNK(status.st_mode):
        raise JournalError("it is a link")
    return ByteSource(path) if status.st_size or not stat.S_ISREG(status.st_mode) else None


def _roll_back(pages: Pages, file: ByteSource) -> str | None:
    if file.read(0, len(ROLLBACK_MAGIC)) != ROLLBACK_MAGIC:
        # Its transaction was completed, and its header overwritten.
        file.close()
        return None
    pages.replace(file, saved_pages(file, pages.size))
    return (
        "tells what rows were before they were written, since its recording broke off meanwhile; "
        "the log was read so"
    )


def _go_on(pages: Pages, file: ByteSource) -> str | None:
    log = WriteAheadLog(file, pages.size)
    pages.replace(file, log.committed())
    return f"is {log.problem}; what was recorded after that is lost" if log.problem else None
