"""What journals beside a SQLite file hold: pages as they were, or as they were going to be.

With these a log is read from a temporary copy. Nothing is written anywhere else, and of the
journals only regular files are opened.
"""

import stat
import struct
from collections.abc import Iterator, Sequence
from functools import cache
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.errors import LogtoolError
from dogbot_logtool.reader.containers.loss import Loss
from dogbot_logtool.reader.containers.source import ByteSource, copied
from dogbot_logtool.reader.containers.sqlite.pages import PIECE, Pages

_ROLLBACK_MAGIC: Final = bytes.fromhex("d9d505f920a163d7")
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
_Saved = tuple[Sequence[tuple[int, int]], str]
"""Numbers of pages and where they stand in a journal, the last of each number counts; and what
there is to say of it."""


class JournalError(LogtoolError):
    """A journal cannot be used."""


def with_journals(source: ByteSource) -> tuple[ByteSource, list[Loss]]:
    """Return a database as its journals have it, and what there is to say of them.

    Args:
        source: the database; closed if another one is returned. A copy of an object in a store has
            no journals.
    """
    losses: list[Loss] = []
    if not isinstance(source.path, Path):
        return source, losses
    path = source.path.resolve()
    for suffix, saved_in in (("-journal", _before_writing), ("-wal", _written_ahead)):
        beside = path.with_name(path.name + suffix)
        file, what = None, ""
        try:
            if file := _opened(beside):
                pages, what = saved_in(file, Pages(source).size)
                source = _with_pages(source, file, pages) if pages else source
        except LogtoolError as error:
            why = str(error).replace(f"{beside}: ", "it ")
            what = f"cannot be used ({why}); the log was read without it"
        if file:
            file.close()
        if what:
            losses.append(Loss(0, f"{beside.name} beside it {what}", 0, None))
    return source, losses


def _opened(path: Path) -> ByteSource | None:
    """Open a journal; None: there is none, or it is empty."""
    try:
        status = path.lstat()
    except OSError:
        return None
    if stat.S_ISLNK(status.st_mode):
        raise JournalError("it is a link")
    return ByteSource(path) if status.st_size or not stat.S_ISREG(status.st_mode) else None


def _with_pages(
    source: ByteSource, file: ByteSource, pages: Sequence[tuple[int, int]]
) -> ByteSource:
    """Return a copy of a database with pages from a journal."""
    database = Pages(source)
    if database.bytes < source.size:
        raise JournalError("the database is hardly written")

    def pieces() -> Iterator[tuple[int, bytes]]:
        for start in range(0, source.size, PIECE):
            yield start, source.read(start, PIECE)
        for number, offset in pages:
            yield (number - 1) * database.size, file.read(offset, database.size)

    copy = copied(source.path, pieces())
    source.close()
    return copy


def _before_writing(file: ByteSource, page_size: int) -> _Saved:
    """Return the pages that a rollback journal saved, up to the first that is not sound."""
    head = file.read(0, _ROLLBACK_HEADER.size).ljust(_ROLLBACK_HEADER.size, b"\0")
    magic, _, _, most, sector, size = _ROLLBACK_HEADER.unpack(head)
    if magic != _ROLLBACK_MAGIC:
        # Its transaction was completed, and its header overwritten.
        return (), ""
    if sector not in _SECTOR_SIZES:
        raise JournalError("its header is damaged")
    _check_page_size(size, page_size)
    what = (
        "tells what rows were before they were written, since its recording broke off meanwhile; "
        "the log was read so"
    )
    return [each for each in _saved_pages(file, sector, page_size) if each[0] <= most], what


def _saved_pages(file: ByteSource, sector: int, page_size: int) -> Iterator[tuple[int, int]]:
    record = page_size + _AROUND_PAGE
    offset = 0
    while (head := file.read(offset, _ROLLBACK_HEADER.size)).startswith(_ROLLBACK_MAGIC):
        _, count, nonce, *_ = _ROLLBACK_HEADER.unpack(head.ljust(_ROLLBACK_HEADER.size, b"\0"))
        offset += sector
        # More than there are stands for as many as there are.
        for _ in range(min(count, (file.size - offset) // record)):
            saved = file.read(offset, record)
            number, page = int.from_bytes(saved[:4], "big"), saved[4:-4]
            total = nonce + sum(page[-_SUMMED_EVERY:0:-_SUMMED_EVERY])
            is_page = number > 0 and number != _LOCK_BYTE // page_size + 1
            if not is_page or total & 0xFFFFFFFF != int.from_bytes(saved[-4:], "big"):
                return
            yield number, offset + 4
            offset += record
        offset += -offset % sector


def _written_ahead(file: ByteSource, page_size: int) -> _Saved:
    """Return the pages of a write-ahead log.

    Its frames are pages with a head. The first one that is not sound ends it: what follows is of
    an earlier use of the file, or was being written when the recorder was killed.
    """
    head = file.read(0, _WAL_HEADER.size).ljust(_WAL_HEADER.size, b"\0")
    magic, version, size, _, *rest = _WAL_HEADER.unpack(head)
    order = _ORDERS.get(magic, "")
    salts, sums = tuple(rest[:2]), np.array(rest[2:], np.uint32)
    is_sound = order and version == _VERSION
    if not is_sound or (_sums(head[: -sums.nbytes], order, 0 * sums) != sums).any():
        raise JournalError("its header is damaged")
    _check_page_size(size, page_size)
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
                what = f"is damaged at byte {damaged_at}; what was recorded after that is lost"
                return frames[:committed], what
            continue
        sums = _sums(frame[:_SUMMED] + frame[_FRAME_HEAD.size :], order, sums)
        if not is_own or (sums != rest[2:]).any():
            damaged_at = offset
            continue
        frames.append((number, offset + _FRAME_HEAD.size))
        committed = len(frames) if commits else committed
    return frames[:committed], ""


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
