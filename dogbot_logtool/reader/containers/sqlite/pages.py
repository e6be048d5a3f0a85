"""The pages of a SQLite file, with those that a journal beside it replaces.

No SQLite is used: it does what a journal tells it, to other files as well, and reads without end
what refers to itself. The format is described at https://www.sqlite.org/fileformat2.html.
"""

import struct
from collections.abc import Sequence
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Bytes, Flags, Ints
from dogbot_logtool.errors import LogError, LogtoolError
from dogbot_logtool.io.storage import name_of
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
