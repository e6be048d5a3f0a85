"""The bytes of a log file by offset: safe to share among threads, and small for any log."""

import errno
import os
import threading
from collections.abc import Iterable, Sequence
from pathlib import Path

from dogbot_logtool.errors import LogError
from dogbot_logtool.io import storage
from dogbot_logtool.io.storage import Location


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


def copied(path: Location, size: int, pieces: Iterable[tuple[int, bytes]]) -> ByteSource:
    """Return a copy of a file on the disk, without a name, which is gone when it is closed.

    Args:
        path: its name for users.
        size: of the copy.
        pieces: offsets and bytes; later ones replace earlier ones.

    Raises:
        LogError: there is no room.
    """
    import shutil  # noqa: PLC0415 - few logs need a copy
    import tempfile  # noqa: PLC0415

    room = shutil.disk_usage(tempfile.gettempdir()).free
    if size > room:
        raise LogError(
            f"{storage.name_of(path)}: is not read by parts, so that all its {size} "
            f"bytes are needed on a disk; {tempfile.gettempdir()} has room for {room} (TMPDIR "
            "names another)"
        )
    with storage.scratch_folder() as folder:
        with (folder / "copy").open("wb") as file:
            for offset, data in pieces:
                file.seek(offset)
                file.write(data)
        copy = ByteSource(folder / "copy")
    copy.path = path
    return copy
