"""The journals that a killed recorder leaves beside a database."""

import stat
from collections.abc import Callable
from pathlib import Path

from dogbot_logtool.errors import LogtoolError
from dogbot_logtool.io.storage import Location
from dogbot_logtool.reader.containers.loss import Loss
from dogbot_logtool.reader.containers.sources.source import ByteSource
from dogbot_logtool.reader.containers.sqlite.pages import JournalError, Pages
from dogbot_logtool.reader.containers.sqlite.rollback_journal import MAGIC, saved_pages
from dogbot_logtool.reader.containers.sqlite.write_ahead_log import WriteAheadLog


def take_journals(pages: Pages, path: Location) -> list[Loss]:
    """Take what the journals beside a database hold; return what there is to say of them.

    Nothing is written anywhere, and of the journals only regular files are opened.

    Args:
        pages: of the database; receives those of the journals.
        path: of the database. A copy of an object in a store has no journals.
    """
    if not isinstance(path, Path):
        return []
    path = path.resolve()
    losses = [
        _take(pages, path.with_name(path.name + suffix), use)
        for suffix, use in (("-journal", _roll_back), ("-wal", _go_on))
    ]
    return [loss for loss in losses if loss is not None]


def _take(pages: Pages, path: Path, use: Callable[[Pages, ByteSource], str | None]) -> Loss | None:
    try:
        file = _opened(path)
        if file is None:
            return None
        try:
            what = use(pages, file)
        except BaseException:
            file.close()
            raise
    except JournalError as error:
        what = f"cannot be used ({error}); the log was read without it"
    except LogtoolError as error:
        why = str(error).removeprefix(f"{path}: ")
        what = f"cannot be used (it {why}); the log was read without it"
    return None if what is None else Loss(0, f"{path.name} beside it {what}", 0, None)


def _opened(path: Path) -> ByteSource | None:
    """Open a journal; None: there is none, or it is empty."""
    try:
        status = path.lstat()
    except OSError:
        return None
    if stat.S_ISLNK(status.st_mode):
        raise JournalError("it is a link")
    return ByteSource(path) if status.st_size or not stat.S_ISREG(status.st_mode) else None


def _roll_back(pages: Pages, file: ByteSource) -> str | None:
    if file.read(0, len(MAGIC)) != MAGIC:
        # Its transaction was completed, and its header overwritten.
        file.close()
        return None
    pages.replace(file, saved_pages(file, pages.size))
    return (
        "tells what rows were before they were written, since its recording broke off meanwhile; "
        "the log was read so"
    )


def _go_on(pages: Pages, file: ByteSource) -> str | None:
    log = WriteAheadLog(file, pages.size)
    pages.replace(file, log.committed())
    return f"is {log.problem}; what was recorded after that is lost" if log.problem else None
