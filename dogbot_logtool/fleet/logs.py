"""Which logs the words of the command line name: files, directories, globs, lists and URLs."""

import glob
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path, PurePath, PurePosixPath
from typing import TYPE_CHECKING, Final

from dogbot_logtool import storage
from dogbot_logtool.errors import CallError
from dogbot_logtool.reader.signatures import (
    ANNOTATED,
    BAG_MAGIC,
    MCAP_MAGIC,
    ROSBAG2_METADATA,
    SQLITE_MAGIC,
)
from dogbot_logtool.storage import Location

if TYPE_CHECKING:
    from upath import UPath

_SUFFIXES: Final = (".bag", ".mcap", ".db3")
_MAGIC: Final = (BAG_MAGIC, MCAP_MAGIC, SQLITE_MAGIC)
_WILD: Final = re.compile(r"[*?\[]")
_LARGEST_LIST: Final = 256 << 20


@dataclass(frozen=True, slots=True)
class Found:
    """A log that was named or found."""

    place: Location
    below: PurePath = field(default_factory=PurePosixPath)
    """Its directory below the one that was searched; what is made of it lies likewise."""
    searched: bool = False
    """Nobody named it: it was met in a directory."""


@dataclass(frozen=True, slots=True)
class Fleet:
    """All logs of a call, each once, in the order of the words, and by name within a word."""

    logs: tuple[Found, ...]
    left_out: int
    """Files of `convert` that were met in searched directories."""

    @property
    def places(self) -> list[Location]:
        """Where the logs are."""
        return [log.place for log in self.logs]

    @property
    def names(self) -> list[str]:
        """What they are called when they are told of."""
        return [storage.shown(log.place) for log in self.logs]

    @property
    def below(self) -> list[PurePath]:
        """Their directories below those that were searched."""
        return [log.below for log in self.logs]


def find_logs(words: Iterable[str], *, for_workers: bool = False) -> Fleet:
    """Find the logs that words name.

    A directory is searched, however deep, for files that end as logs do; on a disk, also for
    others that begin as logs do. The directory of a ROS 2 bag is one log. ``@list.txt`` names a
    file of such words, one a line, ``#`` beginning a remark.

    Args:
        words: what was named.
        for_workers: name logs on a disk from its root, since workers may stand elsewhere.

    Raises:
        CallError: a word names nothing, or a list cannot be read.
        StoreError: a store fails.
    """
    found: dict[Location, Found] = {}
    left_out = 0
    for word in words:
        for one in _named(word):
            if one.searched and one.place.name.endswith(ANNOTATED):
                left_out += 1
                continue
            place = storage.from_root(one.place) if for_workers else one.place
            found.setdefault(place, replace(one, place=place))
    if not found:
        raise CallError("there are no logs: the lists and directories that were named hold none")
    return Fleet(tuple(found.values()), left_out)


def _named(word: str) -> Iterator[Found]:
    if word.startswith("@") and len(word) > 1:
        for line in _lines(storage.location(word[1:])):
            yield from _named(line)
        return
    place = storage.location(word)
    if isinstance(place, Path):
        yield from _on_disk(place, word)
    else:
        yield from _in_store(place)


def _lines(place: Location) -> list[str]:
    try:
        data = storage.content(place, _LARGEST_LIST)
    except CallError as error:
        raise CallError(f"@{error}") from error
    except OSError as error:
        raise CallError(f"@{place}: cannot be read: {error.strerror}") from error
    if data is None:
        raise CallError(f"@{storage.shown(place)}: is too long for a list of logs")
    try:
        lines = [line.strip() for line in data.decode("utf-8").splitlines()]
    except UnicodeDecodeError as error:
        raise CallError(f"@{storage.shown(place)}: is no list of logs, not even text") from error
    return [line for line in lines if line and not line.startswith(("#", "@"))]


def _on_disk(place: Path, word: str) -> Iterator[Found]:
    try:
        there = place.exists()
        folder = there and place.is_dir()
    except OSError:
        # A name that no disk takes; whoever opens it will say so.
        there, folder = True, False
    if folder:
        yield from _searched(place)
    elif there or not _WILD.search(word):
        yield Found(place)
    else:
        matches = sorted(glob.glob(word, recursive=True))  # noqa: PTH207 - takes absolute patterns, too
        if not matches:
            raise CallError(f"{word}: no file has such a name")
        for match in matches:
            yield from _on_disk(Path(match), match)


def _searched(folder: Path) -> Iterator[Found]:
    """Find the logs below a directory of a disk."""
    if _is_bag([file.name for file in storage.files_in(folder)], folder.name):
        yield Found(folder)
        return
    logs = list(_below(folder, PurePath()))
    if not logs:
        raise CallError(f"{folder}: is a directory, not a log file, and holds no logs")
    yield from logs


def _below(folder: Path, below: PurePath) -> Iterator[Found]:
    for entry in sorted(folder.iterdir()):
        if entry.name.startswith("."):
            continue
        if entry.is_dir():
            if _is_bag([file.name for file in storage.files_in(entry)], entry.name):
                yield Found(entry, below, searched=True)
            else:
                yield from _below(entry, below / entry.name)
        elif entry.is_file() and (_ends_like_a_log(entry.name) or _begins_like_a_log(entry)):
            yield Found(entry, below, searched=True)


def _in_store(place: "UPath") -> Iterator[Found]:
    if _WILD.search(place.path) and place.protocol not in {"http", "https"}:
        names = sorted(storage.asked(place, lambda: list(place.fs.glob(place.path))))
        if not names:
            raise CallError(f"{storage.shown(place)}: no object has such a name")
        for name in names:
            yield from _in_store(_like(place, name))
        return
    if not _ends_like_a_log(place.name) and storage.is_folder(place):
        yield from _searched_in_store(place)
    else:
        yield Found(place)


def _searched_in_store(folder: "UPath") -> Iterator[Found]:
    """Find the logs below a directory of a store: one listing, whatever its depth."""
    names = sorted(storage.asked(folder, lambda: list(folder.fs.find(folder.path))))
    root = PurePosixPath(folder.path)
    files: dict[PurePosixPath, list[str]] = {}
    for name in names:
        path = PurePosixPath(name)
        files.setdefault(path.parent, []).append(path.name)
    bags = {path for path, inside in files.items() if _is_bag(inside, path.name)}
    found = [Found(_like(folder, str(bag)), _relative(bag.parent, root)) for bag in bags]
    for name in names:
        path = PurePosixPath(name)
        if _ends_like_a_log(path.name) and path.parent not in bags:
            below = _relative(path.parent, root)
            found.append(Found(_like(folder, name), below, searched=True))
    if not found:
        raise CallError(f"{storage.shown(folder)}: there are no logs")
    yield from sorted(found, key=lambda one: str(one.place))


def _relative(path: PurePosixPath, root: PurePosixPath) -> PurePosixPath:
    return path.relative_to(root) if path.is_relative_to(root) else PurePosixPath()


def _like(place: "UPath", name: str) -> "UPath":
    """Return another object of the same store."""
    other: UPath = type(place)(place.fs.unstrip_protocol(name), **place.storage_options)
    return other


def _is_bag(names: Sequence[str], folder: str) -> bool:
    """Tell whether the files in a directory are a ROS 2 bag: one log.

    Where its metadata is lost, the recorder's way of naming files tells:
    ``<directory>_<number>.<suffix>``.
    """
    if ROSBAG2_METADATA in names:
        return True
    numbered = re.compile(re.escape(folder) + r"_\d+\.(db3|mcap)(\.zstd)?")
    return any(numbered.fullmatch(name) for name in names)


def _ends_like_a_log(name: str) -> bool:
    return name.removesuffix(".zstd").endswith(_SUFFIXES)


def _begins_like_a_log(file: Path) -> bool:
    try:
        with file.open("rb") as opened:
            return opened.read(16).startswith(_MAGIC)
    except OSError:
        return False
