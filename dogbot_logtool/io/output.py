"""Output that cannot be half.

A file on a disk gets its name when it is whole; to a store it is uploaded as one object, which is
there when the store has all of it.
"""

import contextlib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

from dogbot_logtool.errors import CallError, StoreError
from dogbot_logtool.io import storage
from dogbot_logtool.io.local_file import exists_already, local_file, status_of
from dogbot_logtool.io.storage import Location

if TYPE_CHECKING:
    from upath import UPath


def refuse_bad_target(
    target: Location, source: Location | None, *, overwrite: bool, makes_folder: bool = False
) -> None:
    """Check a target before any work is done.

    Args:
        target: where the output is to be.
        source: the input.
        overwrite: whether a file that is there may be replaced.
        makes_folder: whether a directory that is missing is made.

    Raises:
        CallError: it is no regular file, is the input itself, exists and may not be overwritten, or
            its directory does not exist.
    """
    try:
        if isinstance(target, Path):
            _refuse(target, source, overwrite=overwrite, makes_folder=makes_folder)
        else:
            _refuse_object(target, source, overwrite=overwrite)
    except OSError as error:
        raise CallError(f"{target}: cannot be written: {error.strerror}") from error


def _refuse(target: Path, source: Location | None, *, overwrite: bool, makes_folder: bool) -> None:
    if target.is_dir():
        raise CallError(f"{target}: is a directory; name a file in it")
    there = status_of(target) is not None
    if there and isinstance(source, Path) and target.samefile(source):
        raise CallError(f"{target}: is the input itself; choose another output with -o")
    if there and not overwrite:
        raise exists_already(target)
    folder = target.parent
    if makes_folder:
        folder = next(one for one in (folder, *folder.parents) if one.exists())
    if not folder.is_dir():
        what = "is a file, not a folder" if folder.exists() else "no such folder"
        raise CallError(f"{folder}: {what}")


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
def whole_file(
    target: Location,
    *,
    overwrite: bool,
    makes_folder: bool = False,
    is_wanted: Callable[[], bool] = lambda: True,
) -> Iterator[BinaryIO]:
    """Open a file that becomes the target when the block ends without an error.

    On any error or interruption nothing of it stays. A URL is uploaded while it is written.

    Args:
        target: where the output is to be.
        overwrite: replace a file that is there.
        makes_folder: make its directory if it is missing.
        is_wanted: called when the block has ended; where it returns false, nothing is kept.

    Raises:
        LogtoolError: the file cannot be written, a full disk for instance.
        CallError: the target has come to exist in the meantime and may not be overwritten.
    """
    opened = (
        local_file(target, overwrite=overwrite, makes_folder=makes_folder, is_wanted=is_wanted)
        if isinstance(target, Path)
        else _uploaded_object(target, overwrite=overwrite, is_wanted=is_wanted)
    )
    with opened as file:
        yield file


@contextlib.contextmanager
def _uploaded_object(
    target: "UPath", *, overwrite: bool, is_wanted: Callable[[], bool]
) -> Iterator[BinaryIO]:
    target.fs.invalidate_cache()
    try:
        file = target.fs.open(target.path, "wb", autocommit=False)
        try:
            yield file
            if is_wanted():
                file.close()
                _refuse_object(target, None, overwrite=overwrite)
                file.commit()
            else:
                _discard(file)
        except BaseException:
            _discard(file)
            raise
    except (OSError, NotImplementedError) as error:
        is_refused = isinstance(error, NotImplementedError)
        what = "this kind of store is read only" if is_refused else str(error) or "no reason given"
        raise StoreError(f"{storage.shown(target)}: cannot be written: {what}") from error


def _discard(file: Any) -> None:  # noqa: ANN401 - a file of fsspec, or of one of its stores
    # A later close must not complete the upload.
    with contextlib.suppress(AttributeError):
        file.closed = True
    file.discard()
