"""The pages of a SQLite file.

No SQLite is used: it does what a journal tells it, to other files as well, and reads without end
what refers to itself. The format is described at https://www.sqlite.org/fileformat2.html.
"""

import struct
from collections.abc import Sequence
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Bytes, Flags, Ints
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
