"""Searching a disk: every directory once, whatever links lead to it."""

import os
import re
from collections import deque
from collections.abc import Iterator
from pathlib import Path, PurePath
from typing import Final

_ANY: Final = re.compile(r"(?<=.)\*{2,}|\*{2,}(?=.)")
"""Stars in a part of a pattern that is more than ``**``."""
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


def matches(pattern: str) -> list[Path]:
    """Return the files and directories of a disk that fit a pattern, sorted.

    Patterns are those of `pathlib`, in which ``**`` follows no links: directories with links to
    themselves have endlessly many names. Hidden names fit patterns with hidden parts only, and
    links to a directory above them none.
    """
    pure = PurePath(pattern)
    parts = [_ANY.sub("*", part) for part in pure.relative_to(pure.anchor).parts]
    found = set(Path(pure.anchor).glob("/".join(parts)))
    if not any(map(_is_hidden, parts)):
        found = {path for path in found if not any(map(_is_hidden, path.parts))}
    return sorted(path for path in found if not (path.is_symlink() and _leads_up(path)))


def _is_hidden(name: str) -> bool:
    return name.startswith(".") and name != ".."


def _leads_up(link: Path) -> bool:
    return Path(os.path.realpath(link.parent)).is_relative_to(os.path.realpath(link))
