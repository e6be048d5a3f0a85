"""Searching a disk: every directory once, whatever links lead to it."""

import glob
import os
import re
from collections import deque
from collections.abc import Iterator
from pathlib import Path
from typing import Final

_ANY_DEPTH: Final = r"(?:^|(?<=/))\*\*(?:/+\*\*)*(?:/+|$)"
"""``**`` as a whole part of a pattern, or several in a row."""
Unreadable = dict[Path, str]
"""Directories that could not be searched, and why."""


def walk(root: Path, unreadable: Unreadable) -> Iterator[tuple[Path, list[str], list[str]]]:
    """Yield a directory and those below it, each once, however many links lead to it.

    A directory that is reached without a link comes under that name. Links to a directory above
    the root are not followed: they would search the whole disk.

    Args:
        root: where to begin.
        unreadable: receives the directories that cannot be read.

    Returns:
        its path, and the names of its directories and files but for hidden ones. Directories that
        are removed from the list are not entered.
    """

    def note(error: OSError) -> None:
        unreadable[Path(error.filename)] = error.strerror or str(error)

    seen = {_identity(above) for above in Path(os.path.realpath(root)).parents}
    roots = deque([root])
    while roots:
        for name, folders, files in os.walk(roots.popleft(), onerror=note):
            path = Path(name)
            identity = _identity(path)
            if identity in seen:
                folders.clear()
                continue
            seen.add(identity)
            folders[:] = [each for each in folders if not each.startswith(".")]
            yield path, folders, [each for each in files if not each.startswith(".")]
            links = (path / each for each in sorted(folders))
            roots.extend(each for each in links if os.path.islink(each))  # noqa: PTH114 - false for a name that no disk takes


def _identity(path: Path) -> tuple[int, int] | Path:
    """Return what tells a directory from all others."""
    try:
        status = path.stat()
    except OSError:
        return path
    return status.st_dev, status.st_ino


def matches(pattern: str, unreadable: Unreadable) -> list[Path]:
    """Return the files and directories of a disk that fit a pattern, sorted.

    Patterns are those of `glob`, but ``**`` enters each directory only once: directories with
    links to themselves have endlessly many names. Links to a directory above them fit none.
    """
    if os.name == "nt":
        pattern = pattern.replace("\\", "/")
    paths = {Path(name) for name in _fitting(pattern, unreadable)}
    return sorted(path for path in paths if not (path.is_symlink() and _leads_up(path)))


def _fitting(pattern: str, unreadable: Unreadable) -> Iterator[str]:
    depth = re.search(_ANY_DEPTH, pattern)
    if depth is None:
        yield from glob.glob(pattern)  # noqa: PTH207 - takes absolute patterns, too
        return
    head, tail = pattern[: depth.start()], pattern[depth.end() :] or "*"
    for root in glob.glob(head) if head else [""]:  # noqa: PTH207
        for path, _, _ in walk(Path(root), unreadable):
            inside = os.path.join(glob.escape(str(path)), tail)  # noqa: PTH118 - a pattern
            yield from _fitting(inside, unreadable)


def _leads_up(link: Path) -> bool:
    return Path(os.path.realpath(link.parent)).is_relative_to(os.path.realpath(link))
