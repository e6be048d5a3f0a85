"""A write-ahead log (``-wal``): pages that were committed, but not yet written to the database."""

import struct
from collections.abc import Iterator
from functools import cache
from typing import Final

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.arrays import Bytes, Ints
from dogbot_logtool.reader.containers.sources.source import ByteSource
from dogbot_logtool.reader.containers.sqlite.pages import PIECE, JournalError

_HEADER: Final = struct.Struct(">8I")
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
        head = file.read(0, _HEADER.size).ljust(_HEADER.size, b"\0")
        magic, version, size, _, *rest = _HEADER.unpack(head)
        self._salts, self._sum = np.array(rest, np.uint32).reshape(2, 1, 2)
        self._order = _ORDERS.get(magic, "")
        if not self._order or version != _VERSION or not self._is_sound(head):
            raise JournalError("its header is damaged")
        if size != page_size:
            raise JournalError(f"its pages have {size} bytes, those of the database {page_size}")

    def _is_sound(self, head: bytes) -> bool:
        summed = np.frombuffer(head, np.uint8)[None, : _HEADER.size - self._sum.nbytes]
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
        offset, before = _HEADER.size, self._sum
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
