"""Which logs the words of the command line name: files, directories, globs, lists and URLs."""

import os
import re
from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path, PurePath, PurePosixPath
from typing import TYPE_CHECKING, Final, NamedTuple, TypeVar

from dogbot_logtool.errors import CallError, LogtoolError
from dogbot_logtool.io import storage
from dogbot_logtool.io.storage import Location
from dogbot_logtool.reader.containers.registry import (
    ANNOTATED,
    CONTAINERS,
    ROSBAG2_METADATA,
    ROSBAG2_SUFFIXES,
)

if TYPE_CHECKING:
    from upath import UPath

_SUFFIXES: Final = tuple(container.suffix for container in CONTAINERS)
_WILD: Final = re.compile(r"[*?\[]")
_LARGEST_LIST: Final = 256 << 20
AnyPath = TypeVar("AnyPath", bound=PurePath)
Unreadable = dict[str, str]
"""Names of directories that could not be searched, and a sentence that says why."""


class Found(NamedTuple):
    """A log that was named or found."""

    path: Location
    below: PurePath = PurePosixPath()
    """Its directory below the one that was searched; what is made of it lies likewise."""
    searched: bool = False
    """It was found in a directory, not named."""


class LogSet(NamedTuple):
    """All logs of a call, each once, in the order of the words, and by name within a word."""

    logs: tuple[Found, ...]
    left_out: int
    """Files of `convert` that were found in searched directories."""
    failures: tuple[tuple[str, str], ...] = ()
    """Name and sentence of each directory that could not be searched."""

    @property
    def paths(self) -> list[Location]:
        """Paths of the logs."""
        return [log.path for log in self.logs]

    @property
    def names(self) -> list[str]:
        """Names of the logs for messages."""
        return [storage.name_of(log.path) for log in self.logs]


def find_logs(words: Iterable[str], *, for_workers: bool = False) -> LogSet:
    """Find the logs that words name.

    A directory is searched, however deep, for files that end as logs do. Links are followed, but
    each directory and each file is there once. The directory of a ROS 2 bag is one log.
    ``@list.txt`` names a file of such words, one a line, ``#`` beginning a remark; relative names
    in it start from the current directory.

    Args:
        words: what was named.
        for_workers: name logs on a disk from its root, since workers may stand elsewhere.

    Raises:
        CallError: a word names nothing, or a list cannot be read.
        LogtoolError: there are no logs but perhaps in directories that cannot be searched.
        StoreError: a store fails.
    """
    found: dict[str, Found] = {}
    unreadable: Unreadable = {}
    left_out = 0
    for word in words:
        for one in _named(word, unreadable):
            if one.searched and one.path.name.endswith(ANNOTATED):
                left_out += 1
                continue
            path = one.path.absolute() if for_workers else one.path
            found.setdefault(storage.identity(path), one._replace(path=path))
    if not found and unreadable:
        why = next(iter(unreadable.values()))
        raise LogtoolError(f"{why}, and there are no logs elsewhere")
    if not found:
        raise CallError("there are no logs: the lists and directories that were named hold none")
    return LogSet(tuple(found.values()), left_out, tuple(unreadable.items()))


def _named(word: str, unreadable: Unreadable) -> Iterator[Found]:
    if word.startswith("@") and len(word) > 1:
        yield from _listed(storage.location(word[1:]), unreadable)
        return
    if not word:
        raise CallError("an empty name names no log; is a variable of the shell empty?")
    path = storage.location(word)
    yield from _on_disk(path, unreadable) if isinstance(path, Path) else _in_store(path)


# --- Lists ----------------------------------------------------------------------------------------


def _listed(path: Location, unreadable: Unreadable) -> Iterator[Found]:
    """Find the logs that a list names."""
    for number, line in enumerate(_lines(path), 1):
        word = line if os.path.lexists(line) else line.strip()
        if not word or word.startswith("#"):
            continue
        try:
            if word.startswith("@"):
                raise CallError(
                    f"{word}: a list cannot name another list; a file of that name is ./{word}"
                )
            yield from _named(word, unreadable)
        except CallError as error:
            raise CallError(f"@{storage.name_of(path)}, line {number}: {error}") from error


def _lines(path: Location) -> list[str]:
    """Return the lines of a list: names of files may be any bytes, so these need not be UTF-8."""
    data = storage.content(path, _LARGEST_LIST)
    if b"\0" in data:
        raise CallError(f"@{storage.name_of(path)}: is no list of logs, not even text in UTF-8")
    lines = data.decode("utf-8-sig", "surrogateescape").split("\n")
    return [line.removesuffix("\r") for line in lines]


# --- Disks ----------------------------------------------------------------------------------------


def _on_disk(path: Path, unreadable: Unreadable) -> Iterator[Found]:
    name = str(path)
    if os.path.isdir(name):  # noqa: PTH112 - false for a name that no disk takes
        logs = _searched(path, unreadable)
        if not logs and not unreadable:
            raise CallError(
                f"{storage.name_of(path)}: is a directory, not a log file, and holds no logs"
            )
        yield from logs
    elif os.path.lexists(name) or not _WILD.search(name):
        yield Found(path)
    else:
        paths = _matches(name)
        if not paths:
            raise CallError(f"{storage.name_of(path)}: no file has such a name")
        for each in paths:
            yield from _searched(each, unreadable) if each.is_dir() else [Found(each)]


def _searched(folder: Path, unreadable: Unreadable) -> list[Found]:
    """Find the logs below a directory of a disk, or that it is one; by name, links last."""
    logs = sorted(_logs_among([*_files_below(folder, unreadable)]), key=_links_last)
    return [_found(path, folder, path) for path in logs]


def _links_last(path: Path) -> tuple[bool, tuple[str, ...]]:
    """Return what to sort by, so that a link adds nothing to what is there without it."""
    return path.is_symlink(), path.parts


def _files_below(root: Path, unreadable: Unreadable) -> Iterator[Path]:
    """Yield the files below a directory, those of each directory once, but for hidden ones.

    A directory that is reached without a link comes under that name. Links to a directory above
    the root are not followed: they would search the whole disk.

    Args:
        root: where to begin.
        unreadable: receives the directories that cannot be read.
    """

    def note(error: OSError) -> None:
        name = storage.name_of(Path(error.filename))
        unreadable[name] = f"{name}: cannot be searched: {error.strerror}"

    seen = set(map(str, Path(storage.identity(root)).parents))
    roots = deque([root])
    while roots:
        for name, folders, files in os.walk(roots.popleft(), onerror=note):
            folder = Path(name)
            folders[:] = sorted(each for each in folders if not each.startswith("."))
            if storage.identity(folder) in seen:
                folders.clear()
                continue
            seen.add(storage.identity(folder))
            yield from (folder / each for each in files if not each.startswith("."))
            links = (folder / each for each in folders)
            roots.extend(each for each in links if os.path.islink(each))  # noqa: PTH114 - false for a name that no disk takes


def _matches(pattern: str) -> list[Path]:
    """Return the files and directories of a disk that fit a pattern, sorted.

    Patterns are those of `pathlib`, in which ``**`` follows no links: directories with links to
    themselves have endlessly many names. Hidden names fit patterns with hidden parts only, and
    links to a directory above them none.
    """
    pure = PurePath(pattern)
    # Python 3.12 and before know no ``**`` within a name.
    parts = [
        part if part == "**" else re.sub(r"\*+", "*", part)
        for part in pure.relative_to(pure.anchor).parts
    ]
    found = (path for path in Path(pure.anchor).glob("/".join(parts)) if not _leads_up(path))
    if not any(map(_is_hidden, parts)):
        found = (path for path in found if not any(map(_is_hidden, path.parts)))
    return sorted(found, key=_links_last)


def _is_hidden(name: str) -> bool:
    return name.startswith(".") and name != ".."


def _leads_up(path: Path) -> bool:
    real = os.path.realpath(path)
    return path.is_symlink() and Path(os.path.realpath(path.parent)).is_relative_to(real)


# --- Stores ---------------------------------------------------------------------------------------


def _in_store(path: "UPath") -> Iterator[Found]:
    names: list[str] = []
    if _WILD.search(path.path) and path.protocol not in {"http", "https"}:
        with storage.asking(path):
            names = sorted(path.fs.glob(path.path))
        if not names and not storage.exists(path):
            raise CallError(f"{storage.name_of(path)}: no object has such a name")
    for one in [_like(path, name) for name in names] or [path]:
        if _ends_like_a_log(one.name) or not storage.is_folder(one):
            yield Found(one)
        else:
            yield from _searched_in_store(one)


def _searched_in_store(folder: "UPath") -> Iterator[Found]:
    """Find the logs below a directory of a store: one listing, whatever its depth."""
    with storage.asking(folder):
        files = list(map(PurePosixPath, folder.fs.find(folder.path)))
    logs = sorted(_logs_among(files))
    if not logs:
        raise CallError(f"{storage.name_of(folder)}: there are no logs")
    for path in logs:
        yield _found(_like(folder, str(path)), PurePosixPath(folder.path), path)


def _like(path: "UPath", name: str) -> "UPath":
    """Return another object of the same store."""
    other: UPath = type(path)(path.fs.unstrip_protocol(name), **path.storage_options)
    return other


# --- Both -----------------------------------------------------------------------------------------


def _logs_among(files: Sequence[AnyPath]) -> list[AnyPath]:
    """Return which files, or directories of them, are logs."""
    folders: dict[AnyPath, list[str]] = {}
    for file in files:
        folders.setdefault(file.parent, []).append(file.name)
    bags = {folder for folder, names in folders.items() if _is_bag(names, folder)}
    logs = (
        folder / name for folder in folders for name in filter(_ends_like_a_log, folders[folder])
    )
    return [path for path in (*bags, *logs) if not bags.intersection(path.parents)]


def _ends_like_a_log(name: str) -> bool:
    return name.removesuffix(".zstd").endswith(_SUFFIXES)


def _is_bag(names: Sequence[str], folder: PurePath) -> bool:
    """Tell whether the files in a directory are a ROS 2 bag: one log.

    Without metadata, it is recognised by how recorders name files:
    ``<directory>_<number>.<suffix>``.
    """
    if ROSBAG2_METADATA in names:
        return True
    own = (folder.resolve() if isinstance(folder, Path) else folder).name
    suffixes = "|".join(map(re.escape, ROSBAG2_SUFFIXES))
    numbered = re.compile(rf"{re.escape(own)}_\d+({suffixes})(\.zstd)?")
    return any(numbered.fullmatch(name) for name in names)


def _found(log: Location, root: PurePath, path: PurePath) -> Found:
    """Return a log that was found at a path below a root."""
    below = PurePosixPath() if path == root else path.parent.relative_to(root)
    return Found(log, below, searched=path != root)
