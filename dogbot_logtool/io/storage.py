"""Paths of logs and results: on a disk, or in any filesystem of fsspec (s3://, gs://, http://).

fsspec comes with the extra `fleet` and is imported only when a URL is met.
"""

import os
import re
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, Final, NamedTuple

from dogbot_logtool.errors import CallError, ExtraMissingError, LogtoolError, StoreError

if TYPE_CHECKING:
    from upath import UPath

    Location = Path | UPath
else:
    Location = Path

_URL: Final = re.compile(r"[A-Za-z][A-Za-z0-9+.-]+://")
"""One letter is a drive of Windows."""
_CREDENTIALS: Final = r"(?<=://)[^/?#]*@"
_ADDRESS_END: Final = r"[?#]"
_CREDENTIALS_WITHIN: Final = r"(\b[A-Za-z][A-Za-z0-9+.-]+:/{1,2})[^\s/?#]*@"
"""A URL that was treated as a path has one slash."""
_QUERY_WITHIN: Final = (
    r"(\b[A-Za-z][A-Za-z0-9+.-]+:/{1,2}[^\s?#]*)[?#]\S*?(?=[\]:;,.)'\"]*(?:\s|$))"
)
_WEB: Final = ("http", "https")
_ABSENT: Final = (404, 410)
"""HTTP's codes for what is not there."""


def location(word: str) -> Location:
    """Return the path that a word of the command line names.

    Raises:
        ExtraMissingError: it is a URL, and what reads URLs is not installed.
        CallError: it is a URL of a sort that nothing installed reads, or no valid one.
    """
    if not _URL.match(word):
        return Path(word)
    if word.startswith("file:"):
        from urllib.request import url2pathname  # noqa: PLC0415 - takes long

        return Path(url2pathname(word.removeprefix("file://")))
    try:
        from upath import UPath  # noqa: PLC0415 - only URLs need it
    except ImportError as error:
        raise ExtraMissingError(word, "fleet") from error
    try:
        path = UPath(word)
        path.fs  # noqa: B018 - finds out whether its filesystem is installed
    except (AttributeError, ImportError, OSError, ValueError) as error:
        raise CallError(f"{name_of(word)}: cannot be opened: {error}") from error
    return path


def identity(path: Location) -> str:
    """Return what is equal for all names of one log, and for no other.

    It is the real path, whatever the spelling and the links, or the whole URL but for user and
    password. A query may hold other secrets: print `shown`, never this.
    """
    if not isinstance(path, Path):
        return re.sub(_CREDENTIALS, "", str(path), count=1)
    return os.path.realpath(path)


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
    with asking(path):
        info = path.fs.info(path.path)
    tags = ("ETag", "etag", "md5Hash", "mtime", "LastModified", "last_modified", "created")
    tag = next((str(info[name]) for name in tags if info.get(name)), "")
    size = info.get("size")
    return Facts(info.get("type") == "directory", None if size is None else int(size), tag)


def exists(path: "UPath") -> bool:
    """Tell whether a store has an object.

    Raises:
        StoreError: the store fails.
    """
    with asking(path):
        return bool(path.fs.exists(path.path))


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
    with asking(folder):
        entries = folder.fs.ls(folder.path, detail=True)
    names = [entry["name"].rpartition("/")[2] for entry in entries if entry["type"] == "file"]
    return [folder / name for name in sorted(names) if name]


def open_file(path: Path) -> BinaryIO:
    """Open a regular file of a disk for reading.

    Pipes and devices are refused, because they may block or never end.

    Raises:
        CallError: it does not exist, may not be read, or is not a regular file.
    """
    try:
        refuse_special(path)  # A device may react to being opened.
        return path.open("rb")
    except FileNotFoundError as error:
        raise CallError(f"{path}: no such file") from error
    except OSError as error:
        raise CallError(f"{path}: cannot be opened: {error.strerror}") from error


def refuse_special(path: Path) -> None:
    """Refuse what is no regular file.

    Raises:
        CallError: it is none.
        OSError: there is nothing, or it cannot be seen.
    """
    mode = path.stat().st_mode
    if not stat.S_ISREG(mode):
        kind = "a directory" if stat.S_ISDIR(mode) else "a pipe, a socket or a device"
        raise CallError(f"{path}: is {kind}, not a regular file")


def content(path: Location, most: int) -> bytes:
    """Return all bytes of a file.

    Raises:
        CallError: there is no such file, it is not a regular one, or has more bytes than `most`.
        StoreError: the store or the disk fails.
    """
    with asking(path):
        opened = open_file(path) if isinstance(path, Path) else path.fs.open(path.path, "rb")
        with opened as file:
            data: bytes = file.read(most + 1)
    if len(data) > most:
        raise CallError(f"{name_of(path)}: is larger than {most >> 10} kB")
    return data


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


@contextmanager
def asking(path: "Location") -> Iterator[None]:
    """Say in a sentence what a store, or what asks it, raises in the block.

    Raises:
        CallError: there is no such object, or it may not be had.
        StoreError: the store fails.
    """
    try:
        yield
    except LogtoolError:
        raise
    except Exception as error:
        cause: Any = error
        if isinstance(error, FileNotFoundError) and getattr(path, "protocol", "") in _WEB:
            cause = error.__cause__ or error  # fsspec makes this of whatever a server answers
        status = getattr(cause, "status", 0)
        if isinstance(cause, FileNotFoundError) or status in _ABSENT:
            raise CallError(f"{name_of(path)}: no such file") from error
        # The text of an answer has the URL, and in that perhaps a signature.
        what = f"{status} {cause.message}" if status else without_secrets(str(cause))
        what = what.partition("\n")[0] or type(cause).__name__
        if isinstance(cause, PermissionError) or 400 <= status < 500:
            raise CallError(f"{name_of(path)}: the store refuses the request: {what}") from error
        raise StoreError(f"{name_of(path)}: the store fails: {what}") from error
