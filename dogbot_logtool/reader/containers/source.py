"""The bytes of a log by offset: safe to share among threads, and small for any log.

Of one that lies in a store only what is asked for is fetched, by range.
"""

import errno
import os
import threading
from collections.abc import Iterable, Sequence
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from dogbot_logtool.errors import LogError
from dogbot_logtool.io import storage
from dogbot_logtool.io.storage import Location

if TYPE_CHECKING:
    from upath import UPath

_BLOCK: Final = 64 << 10
"""Smaller reads fetch blocks of this size and keep them, since their neighbours follow."""
_BLOCKS: Final = 64
_AT_ONCE: Final = 16
"""Requests to a web server; a bucket's store takes more."""
_PIECE: Final = 8 << 20

_Run = tuple[int, int]
"""First byte and the first behind."""


class ByteSource:
    """A file opened for reading at any offset."""

    path: Location
    """Its name for users."""
    can_fork: bool = True
    """Whether copies of this process may read it, too."""
    has_cheap_seeks: bool = True
    """Whether many small reads all over the file take hardly any time."""
    cheap_size: int = 64 << 20
    """Bytes that are read without a second thought; a disk takes some 20 ms for them."""

    def __init__(self, path: Path) -> None:
        """Open a file.

        Raises:
            CallError: it does not exist, may not be read, or is not a regular file.
        """
        self.path = path
        self._file = storage.open_file(path)
        self._descriptor = self._file.fileno()
        self._seeking = threading.Lock()
        self.size = os.fstat(self._descriptor).st_size

    def read(self, offset: int, size: int) -> bytes:
        """Return up to `size` bytes from `offset`; fewer at the end of the file, never more.

        Raises:
            LogError: the disk fails.
        """
        size = min(size, self.size - offset)
        if offset < 0 or size <= 0:
            return b""
        try:
            data = self._pread(size, offset)
            while len(data) < size and (more := self._pread(size - len(data), offset + len(data))):
                data += more
        except OSError as error:
            raise LogError(
                f"{self.path}: byte {offset} cannot be read: {error.strerror}"
            ) from error
        return data

    def _pread(self, size: int, offset: int) -> bytes:
        """Read at an offset, which threads may do at once."""
        if hasattr(os, "pread"):
            return os.pread(self._descriptor, size, offset)
        with self._seeking:  # Windows
            os.lseek(self._descriptor, offset, os.SEEK_SET)
            return os.read(self._descriptor, size)

    def read_many(self, ranges: Sequence[tuple[int, int]]) -> list[bytes]:
        """Return what `read` gives for each of several (offset, size)."""
        return [self.read(offset, size) for offset, size in ranges]

    def written_size(self) -> int:
        """Return how many bytes were ever written; the others are holes, and read as zeros."""
        written = end = 0
        try:
            while end < self.size:
                start = os.lseek(self._descriptor, end, os.SEEK_DATA)
                end = os.lseek(self._descriptor, start, os.SEEK_HOLE)
                written += end - start
        except AttributeError:  # Windows
            return self.size
        except OSError as error:
            return written if error.errno == errno.ENXIO else self.size
        return written

    def nearby(self) -> "ByteSource":
        """Return the same bytes from the nearest disk, for reading all of them, and often.

        The path stays the same. If another source is returned, this one is closed.
        """
        return self

    def close(self) -> None:
        """Close the file."""
        self._file.close()


def copied(path: Location, pieces: Iterable[tuple[int, bytes]]) -> ByteSource:
    """Return a copy of a file on the disk, without a name, which is gone when it is closed.

    Args:
        path: its name for users.
        pieces: offsets and bytes; later ones replace earlier ones.

    Raises:
        LogError: there is no room.
    """
    import tempfile  # noqa: PLC0415 - few logs need a copy

    try:
        # A file that is open loses its name here, and its bytes when it is closed; Windows does
        # not remove open files.
        with tempfile.TemporaryDirectory(
            prefix="dogbot-logtool.", ignore_cleanup_errors=True
        ) as folder:
            with Path(folder, "copy").open("wb") as file:
                for offset, data in pieces:
                    file.seek(offset)
                    file.write(data)
            copy = ByteSource(Path(folder, "copy"))
    except OSError as error:
        raise LogError(
            f"{storage.name_of(path)}: is not read by parts, and all of it cannot be kept in "
            f"{tempfile.gettempdir()}: {error.strerror} (TMPDIR names another folder)"
        ) from error
    copy.path = path
    return copy


class RemoteSource(ByteSource):
    """An object read by ranges; safe to share among threads."""

    can_fork = False
    """Stores are asked by threads of their own, which copies of this process have not."""
    has_cheap_seeks = False
    cheap_size = 1 << 20

    def __init__(self, url: "UPath", facts: storage.Facts) -> None:
        """Take an object.

        Args:
            url: the object.
            facts: what the store says about it.

        Raises:
            LogError: the store does not give its size.
        """
        self.path = url
        self._url = url
        if facts.size is None:
            raise LogError(
                f"{storage.name_of(url)}: its server does not tell its size, so that it cannot be "
                "read by parts; download it first"
            )
        self.size = facts.size
        # A small object is fetched as a whole: each request takes longer than its bytes.
        self._block_size = self.size if self.size <= self.cheap_size else _BLOCK
        self._block = lru_cache(_BLOCKS)(self._fetch_block)

    def read(self, offset: int, size: int) -> bytes:
        """See `ByteSource.read`.

        Raises:
            StoreError: the store fails.
        """
        size = min(size, self.size - offset)
        if offset < 0 or size <= 0:
            return b""
        block = self._block_size
        if size > block:
            return self._fetch([(offset, offset + size)])[0]
        first, last = offset // block, (offset + size - 1) // block
        data = b"".join(map(self._block, range(first, last + 1)))
        return data[offset - first * block :][:size]

    def read_many(self, ranges: Sequence[tuple[int, int]]) -> list[bytes]:
        """See `ByteSource.read_many`; all are fetched at once."""
        if self.size <= self._block_size:
            return [self.read(offset, size) for offset, size in ranges]
        ends = [min(start + size, self.size) for start, size in ranges]
        runs = [(start, max(start, end)) for (start, _), end in zip(ranges, ends, strict=True)]
        fetched = iter(self._fetch([run for run in runs if run[0] < run[1]]))
        return [next(fetched) if start < end else b"" for start, end in runs]

    def nearby(self) -> ByteSource:
        """See `ByteSource.nearby`: a copy on the disk without a name, gone when it is closed.

        Raises:
            LogError: there is no room.
        """
        runs = [(start, min(start + _PIECE, self.size)) for start in range(0, self.size, _PIECE)]
        return copied(self.path, ((run[0], self._fetch([run])[0]) for run in runs))

    def close(self) -> None:
        """Forget what was read."""
        self._block.cache_clear()

    def _fetch_block(self, number: int) -> bytes:
        start = number * self._block_size
        return self._fetch([(start, min(start + self._block_size, self.size))])[0]

    def _fetch(self, runs: Sequence[_Run]) -> list[bytes]:
        url = self._url
        starts, ends = [run[0] for run in runs], [run[1] for run in runs]
        # A small server has no room for a hundred connections at once, and leaves some waiting.
        options = {"batch_size": _AT_ONCE} if url.protocol in {"http", "https"} else {}
        with storage.asking(url):
            names = [url.path] * len(runs)
            found: list[Any] = url.fs.cat_ranges(names, starts, ends, **options)
            for (start, end), answer in zip(runs, found, strict=True):
                if isinstance(answer, BaseException):
                    raise answer
                if len(answer) != end - start:
                    raise OSError("it sends other parts than are asked for; download the log first")
        return found
