"""Searching a disk: every directory once, whatever links lead to it."""

import glob
import os
import re
from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path, PurePath
from typing import Final

_ANY_DEPTH: Final = r"(?:^|(?<=/))\*\*(?:/+\*\*)*(?:/+|$)"
"""``**`` as a whole part of a pattern, or several in a row."""


@dataclass(frozen=True, slots=True)
class UnreadableDirectory:
    """A directory that could not be searched."""

    path: Path
    reason: str


@dataclass(frozen=True, slots=True)
class Listing:
    """The entries of a directory by name, without hidden ones."""

    path: Path
    below: PurePath
    """The directory's path below the one that is searched."""
    files: list["os.DirEntry[str]"]
    """All but directories, links that lead nowhere included."""
    folders: list["os.DirEntry[str]"]
    """Directories and links to them; those that are removed are not entered."""


def walk(root: Path, unreadable: list[UnreadableDirectory]) -> Iterator[Listing]:
    """Yield a directory and those below it, each once, however many links lead to it.

    A directory that is reached without a link comes under that name. Links to a directory above
    the root are not followed: they would search the whole disk.

    Args:
        root: where to begin.
        unreadable: receives the directories that cannot be read.
    """
    seen = {_identity(above) for above in Path(os.path.realpath(root)).parents}
    real, linked = deque([(root, PurePath())]), deque[tuple[Path, PurePath]]()
    while real or linked:
        path, below = (real or linked).popleft()
        identity = _identity(path)
        if identity in seen:
            continue
        seen.add(identity)
        try:
            listing = _list(path, below)
        except OSError as error:
            unreadable.append(UnreadableDirectory(path, error.strerror or str(error)))
            continue
        yield listing
        for entry in listing.folders:
            (linked if entry.is_symlink() else real).append((Path(entry.path), below / entry.name))


def _list(path: Path, below: PurePath) -> Listing:
    listing = Listing(path, below, [], [])
    with os.scandir(path) as entries:
        for entry in sorted(entries, key=lambda entry: entry.name):
            if not entry.name.startswith("."):
                (listing.folders if _is_folder(entry) else listing.files).append(entry)
    return listing


def _is_folder(entry: "os.DirEntry[str]") -> bool:
    try:
        return entry.is_dir()
    except OSError:
        # A link to itself, for instance.
        return False


def _identity(path: Path) -> tuple[int, int] | Path:
    """Return what tells a directory from all others."""
    try:
        status = path.stat()
    except OSError:
        return path
    return status.st_dev, status.st_ino


def matches(pattern: str, unreadable: list[UnreadableDirectory]) -> list[Path]:
    """Return the files and directories of a disk that fit a pattern, sorted.

    Patterns are those of `glob`, but ``**`` enters each directory only once: directories with
    links to themselves have endlessly many names. Links to a directory above them fit none.
    """
    if os.name == "nt":
        pattern = pattern.replace("\\", "/")
    names = {Path(name) for name in _matches(pattern, unreadable)}
    return sorted(path for path in names if not (path.is_symlink() and _leads_up(path)))


def _leads_up(link: Path) -> bool:
    return Path(os.path.realpath(link.parent)).is_relative_to(os.path.realpath(link))


def _matches(pattern: str, unreadable: list[UnreadableDirectory]) -> Iterator[str]:
    depth = re.search(_ANY_DEPTH, pattern)
    if depth is None:
        yield from glob.glob(pattern)  # noqa: PTH207 - takes absolute patterns, too
        return
    head, tail = pattern[: depth.start()], pattern[depth.end() :] or "*"
    for root in glob.glob(head) if head else [""]:  # noqa: PTH207
        for listing in walk(Path(root), unreadable):
            inside = os.path.join(glob.escape(str(listing.path)), tail)  # noqa: PTH118 - a pattern
            yield from _matches(inside, unreadable)
