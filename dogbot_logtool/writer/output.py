"""Output that cannot be half.

A file is written beside its final name and renamed when whole; to a store it is uploaded as one
object, which is there when the store has all of it.
"""

import contextlib
import os
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path, PurePath
from typing import TYPE_CHECKING, BinaryIO

from dogbot_logtool import storage
from dogbot_logtool.errors import CallError, LogtoolError, StoreError
from dogbot_logtool.storage import Location

if TYPE_CHECKING:
    from upath import UPath


def targets(
    logs: Sequence[Location],
    output: Location | None,
    ending: str,
    below: Sequence[PurePath] = (),
) -> list[tuple[Location, Location]]:
    """Return the output of every log.

    Args:
        logs: the inputs.
        output: a file, or a directory; a URL is a file if its suffix is that of the ending, else a
            directory; None: the current directory.
        ending: of the name in a directory, after that of the log.
        below: the directory of each output below that one; none: there.

    Raises:
        CallError: several logs would go to one file.
    """
    if output is not None and not _is_folder(output, "." + ending.rpartition(".")[2]):
        if len(logs) > 1:
            raise CallError(f"{output}: is no directory, and there are {len(logs)} logs")
        return [(logs[0], output)]
    folder = output or Path()
    places = below or [PurePath()] * len(logs)
    pairs = [
        (log, _below(folder, place) / f"{storage.file_stem(log)}{ending}")
        for log, place in zip(logs, places, strict=True)
    ]
    taken: set[Location] = set()
    for log, target in pairs:
        if target in taken:
            raise CallError(f"{log}: another log has the same name, so both would go to {target}")
        taken.add(target)
    return pairs


def _below(folder: Location, place: PurePath) -> Location:
    # A store takes a dot for a name.
    return folder / place if place.parts else folder


def _is_folder(path: Location, suffix: str) -> bool:
    try:
        return path.is_dir() if isinstance(path, Path) else path.suffix != suffix
    except OSError:
        # A name that no disk takes; whoever opens it will say so.
        return False


def refuse_bad_target(target: Location, source: Location | None, *, overwrite: bool) -> None:
    """Check a target before any work is done.

    Raises:
        CallError: it is a directory, the input itself, exists and may not be overwritten, or its
            folder does not exist.
    """
    try:
        if isinstance(target, Path):
            _refuse(target, source, overwrite=overwrite)
        else:
            _refuse_object(target, source, overwrite=overwrite)
    except OSError as error:
        raise CallError(f"{target}: cannot be written: {error.strerror}") from error


def _refuse(target: Path, source: Location | None, *, overwrite: bool) -> None:
    if target.is_dir():
        raise CallError(f"{target}: is a directory; name a file in it")
    is_input = isinstance(source, Path) and target.exists() and target.samefile(source)
    if is_input:
        raise CallError(f"{target}: is the input itself; choose another output with -o")
    if target.exists() and not overwrite:
        raise CallError(f"{target}: exists already; --overwrite replaces it, or name another")
    if not target.parent.is_dir():
        raise CallError(f"{target.parent}: no such folder")


def _refuse_object(target: "UPath", source: Location | None, *, overwrite: bool) -> None:
    if target == source:
        raise CallError(
            f"{storage.shown(target)}: is the input itself; choose another output with -o"
        )
    if not overwrite and storage.asked(target, lambda: target.fs.exists(target.path)):
        raise CallError(
            f"{storage.shown(target)}: exists already; --overwrite replaces it, -o names another"
        )


@contextlib.contextmanager
def whole_file(target: Location, *, overwrite: bool) -> Iterator[BinaryIO]:
    """Open a temporary file that becomes the target when the block ends without an error.

    On any error or interruption it is removed. A URL is uploaded while it is written.

    Raises:
        LogtoolError: the file cannot be written, a full disk for instance.
        CallError: the target has come to exist in the meantime and may not be overwritten.
    """
    opened = (
        _renamed_file(target, overwrite=overwrite)
        if isinstance(target, Path)
        else _uploaded_object(target, overwrite=overwrite)
    )
    with opened as file:
        yield file


@contextlib.contextmanager
def _uploaded_object(target: "UPath", *, overwrite: bool) -> Iterator[BinaryIO]:
    target.fs.invalidate_cache()
    try:
        file = target.fs.open(target.path, "wb", autocommit=False)
        try:
            yield file
            file.close()
            _refuse_object(target, None, overwrite=overwrite)
            file.commit()
        except BaseException:
            # Whatever closes it later must not complete the upload.
            file.closed = True
            file.discard()
            raise
    except (OSError, NotImplementedError) as error:
        what = str(error) or type(error).__name__
        raise StoreError(f"{storage.shown(target)}: cannot be written: {what}") from error


@contextlib.contextmanager
def _renamed_file(target: Path, *, overwrite: bool) -> Iterator[BinaryIO]:
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
