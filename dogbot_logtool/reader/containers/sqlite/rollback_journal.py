"""A rollback journal (``-journal``): pages as they were before an unfinished transaction."""

import struct
from collections.abc import Iterator
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Bytes, Flags, Ints
from dogbot_logtool.reader.containers.sources.source import ByteSource
from dogbot_logtool.reader.containers.sqlite.pages import PIECE, JournalError

MAGIC: Final = bytes.fromhex("d9d505f920a163d7")
_HEADER: Final = struct.Struct(">8s5I")
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
    head = file.read(0, _HEADER.size).ljust(_HEADER.size, b"\0")
    _, _, _, pages, sector, size = _HEADER.unpack(head)
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
    while (head := file.read(offset, _HEADER.size)).startswith(MAGIC):
        _, count, nonce, *_ = _HEADER.unpack(head.ljust(_HEADER.size, b"\0"))
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
