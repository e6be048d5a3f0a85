"""A file on a disk that appears under its name only when it is whole.

Until then it has no name at all where the system allows that, so that not even a killed process
leaves anything; elsewhere it has a temporary name, and is removed on any error.
"""

import contextlib
import errno
import os
import stat
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import BinaryIO, Final

from dogbot_logtool.errors import CallError, LogtoolError

_OPEN_FILES: Final = Path("/proc/self/fd")
"""The directory in which Linux names open files of a process, also those without another name."""
_KINDS: Final = {
    stat.S_IFDIR: "a directory",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
    stat.S_IFIFO: "a FIFO",
    stat.S_IFSOCK: "a socket",
}


def status_of(target: Path) -> os.stat_result | None:
    """Return the status of the file that a name leads to; None if there is none.

    Raises:
        CallError: there is something that is no regular file, or a link to nothing.
        OSError: this cannot be found out.
    """
    try:
        status = target.stat()
    except (FileNotFoundError, NotADirectoryError):
        if target.is_symlink():
            raise CallError(
                f"{target}: is a link to nothing; remove it, or name another output"
            ) from None
        return None
    if not stat.S_ISREG(status.st_mode):
        kind = _KINDS.get(stat.S_IFMT(status.st_mode), "something else")
        raise CallError(f"{target}: is {kind}, not a file; name another output")
    return status


def exists_already(target: Path) -> CallError:
    """Return the error of a target that may not be replaced."""
    return CallError(f"{target}: exists already; --overwrite replaces it, or name another")


@contextlib.contextmanager
def local_file(
    target: Path, *, overwrite: bool, makes_folder: bool, is_wanted: Callable[[], bool]
) -> Iterator[BinaryIO]:
    """Open a file that gets its name when the block ends without an error; else nothing stays.

    A file that is replaced hands on its permissions and, where that is allowed, its owner. A link
    stays one: what it leads to is replaced.

    Args:
        target: the name.
        overwrite: replace what has that name.
        makes_folder: make its directory if it is missing.
        is_wanted: called when the block has ended; where it returns false, nothing stays.

    Raises:
        LogtoolError: the file cannot be written, a full disk for instance.
        CallError: something has that name that may not be replaced.
    """
    try:
        replaced = status_of(target) if overwrite else None
        path = target.resolve() if overwrite and target.is_symlink() else target
        with _opened(_existing(path.parent) if makes_folder else path.parent) as part:
            if replaced is not None:
                part.resemble(replaced)
            yield part.file
            if not is_wanted():
                return
            part.file.flush()
            # A power failure leaves a whole file, the one before, or none.
            os.fsync(part.file.fileno())
            if makes_folder:
                path.parent.mkdir(parents=True, exist_ok=True)
            if overwrite:
                part.replace(path)
            elif not part.take(path):
                raise exists_already(target)
    except OSError as error:
        raise LogtoolError(f"{target}: cannot be written: {error.strerror or error}") from error


@contextlib.contextmanager
def _opened(folder: Path) -> Iterator["_Part"]:
    """Open a file in a directory; a temporary name that it has is gone when the block ends."""
    part = _Part()
    try:
        with part.open(folder):
            yield part
    finally:
        if part.temporary is not None:
            part.temporary.unlink(missing_ok=True)


class _Part:
    """A file that is being written."""

    file: BinaryIO
    temporary: Path | None = None
    """The name that it has until it is whole; None: it has no name."""

    def open(self, folder: Path) -> BinaryIO:
        """Open it in a directory, without a name where the system allows that."""
        unnamed = _open_unnamed(folder)
        if unnamed is None:
            # Known before it is there, so that an interruption in between leaves nothing.
            self.temporary = _temporary_name(folder)
            self.file = self.temporary.open("xb")
        else:
            self.file = unnamed
        return self.file

    def resemble(self, replaced: os.stat_result) -> None:
        """Take over the owner, where that is allowed, and the permissions of another file."""
        if not hasattr(os, "fchown"):
            return  # Windows
        for owner in ((-1, replaced.st_gid), (replaced.st_uid, -1)):
            with contextlib.suppress(PermissionError):
                os.fchown(self.file.fileno(), *owner)
        os.fchmod(self.file.fileno(), stat.S_IMODE(replaced.st_mode))

    def take(self, path: Path) -> bool:
        """Take a name; tell whether it was free."""
        if self.temporary is None:
            return _link(_OPEN_FILES / str(self.file.fileno()), path)
        self.file.close()  # Windows gives no open file another name
        try:
            return _link(self.temporary, path)
        except OSError:
            # A filesystem without hard links.
            if os.path.lexists(path):
                return False
            self.temporary.replace(path)
            return True

    def replace(self, path: Path) -> None:
        """Take a name, from another file if there is one: only one that has a name can do that."""
        if self.temporary is None:
            unnamed = _OPEN_FILES / str(self.file.fileno())
            self.temporary = _temporary_name(path.parent)
            _link(unnamed, self.temporary)
        else:
            self.file.close()
        self.temporary.replace(path)


def _link(source: Path, path: Path) -> bool:
    """Give a file one more name; tell whether that was free.

    Raises:
        OSError: the system or the filesystem gives none.
    """
    if os.link not in os.supports_dir_fd:
        raise OSError(errno.ENOTSUP, os.strerror(errno.ENOTSUP))  # Windows
    folder = os.open(path.parent, getattr(os, "O_PATH", os.O_RDONLY))
    try:
        # Only with a directory given does Python follow the link that stands for an open file.
        os.link(source, path.name, dst_dir_fd=folder, follow_symlinks=True)
    except FileExistsError:
        return False
    finally:
        os.close(folder)
    return True


def _open_unnamed(folder: Path) -> BinaryIO | None:
    """Open a file that has no name; None where the system has no such thing."""
    flag = getattr(os, "O_TMPFILE", None)
    if flag is None or not _OPEN_FILES.is_dir():
        return None
    try:
        return os.fdopen(os.open(folder, flag | os.O_WRONLY, 0o666), "wb")
    except OSError:
        # The filesystem has none; any other fault shows again when a named file is opened.
        return None


def _temporary_name(folder: Path) -> Path:
    return folder / f".dogbot-logtool.{os.urandom(8).hex()}.part"


def _existing(folder: Path) -> Path:
    """Return the directory itself, or the next above that is there."""
    return next((one for one in (folder, *folder.parents) if one.is_dir()), folder)
