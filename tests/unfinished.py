"""Outputs that are being written: files with a temporary name, or with none."""

import contextlib
from pathlib import Path


def unfinished(folder: Path, process: int) -> list[Path]:
    """Return the files in a directory that a process and its children are writing.

    One that has no name is told by the link under ``/proc`` that leads to it.
    """
    named = [file for file in folder.iterdir() if file.name.endswith(".part")]
    return named or [
        link
        for each in _with_children(process)
        for link in _open_files(each)
        if _target(link).startswith(f"{folder}/#") and _target(link).endswith("(deleted)")
    ]


def _with_children(process: int) -> list[int]:
    found = [process]
    for each in found:
        with contextlib.suppress(OSError):
            for task in Path(f"/proc/{each}/task").iterdir():
                found.extend(map(int, (task / "children").read_text().split()))
    return found


def _open_files(process: int) -> list[Path]:
    with contextlib.suppress(OSError):
        return list(Path(f"/proc/{process}/fd").iterdir())
    return []


def _target(link: Path) -> str:
    with contextlib.suppress(OSError):
        return str(link.readlink())
    return ""
