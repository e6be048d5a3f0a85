"""Output that cannot be half: written beside its final name, renamed when whole."""

import contextlib
import os
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

from dogbot_logtool.errors import CallError, LogtoolError


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
