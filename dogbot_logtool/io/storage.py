"""Paths of logs and results: on a disk, or in any filesystem of fsspec (s3://, gs://, http://).

fsspec comes with the extra `fleet` and is imported only when a URL is met.
"""

import errno
import os
import re
import stat
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO, Final, NamedTuple, TypeVar
from urllib.parse import urlsplit

from dogbot_logtool.errors import CallError, ExtraMissingError, LogtoolError, StoreError

if TYPE_CHECKING:
    from upath import UPath

    Location = Path | UPath
else:
    Location = Path

Result = TypeVar("Result")

TRIES: Final = 5
"""A request is made so often before the store is given up."""
FIRST_WAIT_S: Final = 0.2
"""Each wait is twice as long as the one before."""
ANSWER_WITHIN_S = 120.0
"""A request that takes longer has stalled."""
_URL: Final = re.compile(r"[A-Za-z][A-Za-z0-9+.-]+://")
"""One letter is a drive of Windows."""
_CREDENTIALS: Final = r"(?<=://)[^/?#]*@"
_ADDRESS_END: Final = r"[?#]"
_CREDENTIALS_WITHIN: Final = r"(\b[A-Za-z][A-Za-z0-9+.-]+:/{1,2})[^\s/?#]*@"
"""A URL that was treated as a path has one slash."""
_QUERY_WITHIN: Final = (
    r"(\b[A-Za-z][A-Za-z0-9+.-]+:/{1,2}[^\s?#]*)[?#]\S*?(?=[\]:;,.)'\"]*(?:\s|$))"
)
_KINDS: Final = {
    stat.S_IFDIR: "a directory",
    stat.S_IFIFO: "a named pipe",
    stat.S_IFSOCK: "a socket",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
}
_STORES: Final = ("aiohttp", "botocore", "aiobotocore", "gcsfs")
"""Packages that raise errors of their own where a store or the network fails."""
_ABSENT: Final = (404, 410)
"""HTTP's codes for what is not there."""
_DENIED: Final = (401, 403, 407)
_LATER: Final = (408, 425, 429)
"""HTTP's codes for what may be asked for again later."""


def location(word: str) -> Location:
    """Return the path that a word of the command line names.

    Raises:
        ExtraMissingError: it is a URL, and what reads URLs is not installed.
        CallError: it is a URL of a sort that nothing installed reads, or no valid one.
        StoreError: its store cannot be opened.
    """
    if not _URL.match(word):
        return Path(word)
    try:
        parts = urlsplit(word)
        if parts.scheme in {"http", "https"}:
            _ = parts.port  # is checked only when it is asked for
    except ValueError as error:
        raise CallError(f"{name_of(word)}: is no valid URL ({error})") from error
    if not (parts.netloc or parts.path):
        raise CallError(f"{parts.scheme}://: names no host, bucket or file")
    if parts.scheme == "file":
        from urllib.request import url2pathname  # noqa: PLC0415 - takes long

        return Path(url2pathname(parts.path))
    try:
        from upath import UPath  # noqa: PLC0415 - only URLs need it
    except ImportError as error:
        raise ExtraMissingError(word, "fleet") from error
    try:
        path = UPath(word)
        path.fs  # noqa: B018 - finds out whether its filesystem is installed
    except ImportError as error:
        raise CallError(f"{name_of(word)}: {error}") from error
    except ValueError as error:
        raise CallError(f"{name_of(word)}: is a URL of no known kind ({error})") from error
    except (AttributeError, OSError) as error:
        # upath cannot tell its parts, or it is a file within another one that cannot be had.
        raise StoreError(f"{name_of(word)}: cannot be opened: {error}") from error
    return path


def from_root(path: Location) -> Location:
    """Return an absolute path, the same for all processes."""
    return path.absolute() if isinstance(path, Path) else path


def identity(path: Location) -> str:
    """Return what is equal for all names of one log, and for no other.

    It is the real path, whatever the spelling and the links, or the whole URL but for user and
    password. A query may hold other secrets: print `shown`, never this.
    """
    if not isinstance(path, Path):
        return re.sub(_CREDENTIALS, "", str(path), count=1)
    try:
        return os.path.realpath(path)
    except (OSError, ValueError):
        # A name that no disk takes; opening it will say so.
        return str(path)


def name_of(path: Location | str) -> str:
    """Return a path as it may be printed: a URL without passwords and signatures."""
    text = str(path)
    if not _URL.match(text):
        return valid_unicode(text)
    return re.split(_ADDRESS_END, re.sub(_CREDENTIALS, "", text, count=1), maxsplit=1)[0]


def without_secrets(text: str) -> str:
    """Return a text whose URLs have no passwords and signatures."""
    return re.sub(_QUERY_WITHIN, r"\1", re.sub(_CREDENTIALS_WITHIN, r"\1", text))


def valid_unicode(text: str) -> str:
    r"""Return text with the bytes of a file's name that are not UTF-8 as ``\xff`` and so on."""
    return text.encode("utf-8", "surrogateescape").decode("utf-8", "backslashreplace")


def file_name(path: Location) -> str:
    """Return the last part of a path; a URL's query is no part of it."""
    return path.name if isinstance(path, Path) else path.name.partition("?")[0]


def file_stem(path: Location) -> str:
    """Return `file_name` without its last suffix."""
    return Path(file_name(path)).stem


class Facts(NamedTuple):
    """Size and version of a file, or of an object in a store."""

    is_folder: bool
    """It is a directory, or the common beginning of objects' names."""
    size: int | None
    """Bytes; None if the store does not tell."""
    version: str
    """Changes whenever the content does; empty if the store has no such thing."""


def facts(path: Location) -> Facts:
    """Ask a disk or a store about a file.

    Raises:
        CallError: it is a URL, and nothing is there.
        StoreError: the store fails.
        OSError: it cannot be seen on the disk.
    """
    if isinstance(path, Path):
        status = path.stat()
        return Facts(stat.S_ISDIR(status.st_mode), status.st_size, str(status.st_mtime_ns))
    info = asked(path, lambda: path.fs.info(path.path))
    tags = ("ETag", "etag", "md5Hash", "mtime", "LastModified", "last_modified", "created")
    tag = next((str(info[name]) for name in tags if info.get(name)), "")
    size = info.get("size")
    return Facts(info.get("type") == "directory", None if size is None else int(size), tag)


def exists(path: "UPath") -> bool:
    """Tell whether a store has an object.

    Raises:
        StoreError: the store fails.
    """
    return bool(asked(path, lambda: path.fs.exists(path.path)))


def is_folder(path: Location) -> bool:
    """Tell whether it is a directory, or the common beginning of objects' names.

    Raises:
        CallError: it is a URL, and nothing is there.
        StoreError: the store fails.
    """
    if isinstance(path, Path):
        return os.path.isdir(path)  # noqa: PTH112 - false for a name that no disk takes
    return facts(path).is_folder


def files_in(folder: Location) -> list[Location]:
    """Return the files in a directory, by name; not those in directories below it.

    Raises:
        StoreError: the store fails.
    """
    if isinstance(folder, Path):
        return sorted(file for file in folder.iterdir() if file.is_file())
    entries = asked(folder, lambda: folder.fs.ls(folder.path, detail=True))
    names = [entry["name"].rpartition("/")[2] for entry in entries if entry["type"] == "file"]
    return [folder / name for name in sorted(names) if name]


def open_file(path: Path) -> BinaryIO:
    """Open a regular file of a disk for reading.

    Pipes and devices are refused, because they may block or never end.

    Raises:
        CallError: it does not exist, may not be read, or is not a regular file.
    """
    try:
        # A device may react to being opened, so its kind is looked up before; and again after,
        # because the name may by then stand for something else.
        _refuse_special(path, path.stat().st_mode)
        flags = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
        file = os.fdopen(os.open(path, flags), "rb")
    except FileNotFoundError as error:
        raise CallError(f"{path}: no such file") from error
    except OSError as error:
        if error.errno == errno.ENXIO:
            raise CallError(f"{path}: is not a regular file") from error
        raise CallError(f"{path}: cannot be opened: {error.strerror}") from error
    except ValueError as error:
        raise CallError(f"{path}: cannot be opened: {error}") from error
    try:
        _refuse_special(path, os.fstat(file.fileno()).st_mode)
    except CallError:
        file.close()
        raise
    return file


def kind_of(mode: int) -> str:
    """Return what a file is that is no regular one: ``a named pipe``."""
    return _KINDS.get(stat.S_IFMT(mode), "of another kind")


def _refuse_special(path: Path, mode: int) -> None:
    if stat.S_ISREG(mode):
        return
    kind = kind_of(mode)
    remedy = "" if stat.S_ISDIR(mode) else "; save its content to a file first"
    raise CallError(f"{path}: is {kind}, not a regular file{remedy}")


def content(path: Location, most: int) -> bytes | None:
    """Return all bytes of a file; None if there are more than `most`.

    Raises:
        CallError: there is no such file, or it is not a regular one.
        StoreError: the store fails.
        OSError: the disk fails.
    """
    if isinstance(path, Path):
        with open_file(path) as file:
            size = os.fstat(file.fileno()).st_size
            return file.read(size) if size <= most else None
    if (facts(path).size or 0) > most:
        return None
    return bytes(asked(path, lambda: path.fs.cat_file(path.path)))


def version(path: Location) -> tuple[int, str]:
    """Return the size, bytes, of a file or of all in a directory, and what changes with them.

    The latter is the time of the last change or the store's own tag; empty if it has none.

    Raises:
        CallError: it is a URL, and nothing is there.
        StoreError: the store fails.
        OSError: it cannot be seen on the disk.
    """
    found = facts(path)
    if not found.is_folder:
        return found.size or 0, found.version
    parts = [version(file) for file in files_in(path)]
    return sum(part[0] for part in parts), " ".join(part[1] for part in parts)


def asked(path: Location, request: Callable[[], Result]) -> Result:
    """Return what a store answers; a request that fails or stalls is made again, a few times.

    Raises:
        CallError: there is no such object, or it may not be had.
        StoreError: the store has failed `TRIES` times.
    """
    for left in reversed(range(TRIES)):
        try:
            return request()
        except Exception as error:
            failure = _failure(path, error)
            if failure is None:
                raise
            if not left or not isinstance(failure, StoreError):
                raise failure from error
            time.sleep(FIRST_WAIT_S * 2.0 ** (TRIES - 1 - left))
    raise AssertionError("unreachable: the last try returns or raises")


def _failure(path: Location, error: BaseException) -> LogtoolError | None:
    """Return what to say of a store's error; None: it is none, but a fault of ours."""
    cause = error.__cause__
    # fsspec makes "no such file" of all that a server refuses.
    if isinstance(error, FileNotFoundError) and cause is not None:
        error = cause if isinstance(cause, TimeoutError) or _is_web(cause) else error
    status = getattr(error, "status", 0) if _is_web(error) else 0
    if isinstance(error, FileNotFoundError) or status in _ABSENT:
        return CallError(f"{name_of(path)}: no such file")
    what = _first_line(error)
    if isinstance(error, PermissionError) or status in _DENIED:
        return CallError(f"{name_of(path)}: access is denied ({what})")
    if 400 <= status < 500 and status not in _LATER:
        return CallError(f"{name_of(path)}: the server refuses the request ({what})")
    if isinstance(error, OSError) or _package_of(error) in _STORES:
        return StoreError(f"{name_of(path)}: the store fails: {what}")
    return None


def _is_web(error: BaseException) -> bool:
    """Tell whether an error comes from the client of web servers."""
    return _package_of(error) == "aiohttp"


def _package_of(error: BaseException) -> str:
    return type(error).__module__.partition(".")[0]


def _first_line(error: BaseException) -> str:
    status, message = getattr(error, "status", None), getattr(error, "message", None)
    # The text of an answer has the URL, and in that perhaps a signature.
    text = f"{status} {message}" if status and message else without_secrets(str(error))
    return (text.splitlines() or [""])[0] or type(error).__name__


@contextmanager
def scratch_folder() -> Iterator[Path]:
    """Make a directory for copies that are read once, which is gone when the block ends.

    A file that is still open then loses its name, and its bytes when it is closed; Windows, which
    does not remove open files, leaves it.
    """
    import tempfile  # noqa: PLC0415 - few logs need a copy

    with tempfile.TemporaryDirectory(
        prefix="dogbot-logtool.", ignore_cleanup_errors=True
    ) as folder:
        yield Path(folder)
