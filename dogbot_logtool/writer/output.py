"""Output that cannot be half: written beside its final name, renamed when whole."""

import contextlib
import os
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import BinaryIO

from dogbot_logtool.errors import CallError, LogtoolError


def targets(logs: Sequence[Path], output: Path | None, ending: str) -> list[tuple[Path, Path]]:
    """Return the output of every log.

    Args:
        logs: the inputs.
        output: a file, or a directory; None: the current directory.
        ending: of the name in a directory, after that of the log.

    Raises:
        CallError: several logs would go to one file.
    """
    if output is not None and not _is_folder(output):
        if len(logs) > 1:
            raise CallError(f"{output}: is no directory, and there are {len(logs)} logs")
        return [(logs[0], output)]
    folder = output or Path()
    pairs = [(log, folder / f"{log.stem}{ending}") for log in logs]
    names = [target for _, target in pairs]
    for log, target in pairs:
        if names.count(target) > 1:
            raise CallError(f"{log}: another log has the same name, so both would go to {target}")
    return pairs


def _is_folder(path: Path) -> bool:
    try:
        return path.is_dir()
    except OSError:
        # A name that no disk takes; whoever opens it will say so.
        return False


def refuse_bad_target(target: Path, source: Path | None, *, overwrite: bool) -> None:
    """Check a target before any work is done.

    Raises:
        CallError: it is a directory, the input itself, exists and may not be overwritten, or its
            folder does not exist.
    """
    try:
        _refuse(target, source, overwrite=overwrite)
    except OSError as error:
        raise CallError(f"{target}: cannot be written: {error.strerror}") from error


def _refuse(target: Path, source: Path | None, *, overwrite: bool) -> None:
    if target.is_dir():
        raise CallError(f"{target}: is a directory; name a file in it")
    if source is not None and target.exists() and target.samefile(source):
        raise CallError(f"{target}: is the input itself; choose another output with -o")
    if target.exists() and not overwrite:
        raise CallError(f"{target}: exists already; --overwrite replaces it, or name another")
    if not target.parent.is_dir():
        raise CallError(f"{target.parent}: no such folder")


@contextlib.contextmanager
def whole_file(target: Path, *, overwrite: bool) -> Iterator[BinaryIO]:
    """Open a temporary file that becomes the target when the block ends without an error.

    On any error or interruption it is removed.

    Raises:
        LogtoolError: the file cannot be written, a full disk for instance.
        CallError: the target has come to exist in the meantime and may not be overwritten.
    """
    temporary: Path | None = None
    try:
        handle, name = tempfile.mkstemp(
            prefix=".dogbot-logtool.", suffix=".part", dir=target.parent
        )
        temporary = Path(name)
        with os.fdopen(handle, "wb") as file:
            yield file
        _move_into_place(temporary, target, overwrite=overwrite)
    except OSError as error:
        raise LogtoolError(f"{target}: cannot be written: {error.strerror or error}") from error
    finally:
        if temporary is not None:
            temporary.unlink(missing_ok=True)


def _move_into_place(temporary: Path, target: Path, *, overwrite: bool) -> None:
    # Temporary files are private to their owner; the result gets what a plain open would give.
    mask = os.umask(0)
    os.umask(mask)
    temporary.chmod(0o666 & ~mask)
    if overwrite:
        temporary.replace(target)
        return
    try:
        os.link(temporary, target)
    except FileExistsError as error:
        raise CallError(
            f"{target}: exists already; --overwrite replaces it, or name another"
        ) from error
    except OSError:
        # A filesystem without hard links.
        if target.exists():
            raise CallError(f"{target}: exists already; --overwrite replaces it") from None
        temporary.replace(target)
