"""Opening a log: its first bytes tell what it is, not its name."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Final

from dogbot_logtool.errors import LogError
from dogbot_logtool.io import storage
from dogbot_logtool.io.storage import Location
from dogbot_logtool.reader import not_a_log
from dogbot_logtool.reader.containers.log import BATCH_SIZE, Log, Loss
from dogbot_logtool.reader.containers.signatures import is_zstd
from dogbot_logtool.reader.containers.sources.source import ByteSource
from dogbot_logtool.reader.registry import CONTAINERS, ROSBAG2_SUFFIXES, Container

if TYPE_CHECKING:
    from upath import UPath

_MAGIC_SIZE: Final = 16
_MOST_AT_ONCE: Final = 8 * BATCH_SIZE
"""Bytes that are read at once of a log whose chunks overlap; with more, file order is kept."""
_MOST_DAMAGED_BYTES: Final = 2


def open_log(path: Location) -> Log:
    """Open a ROS 1 bag, an MCAP, or a ROS 2 bag: its directory or one of its files.

    Of a log in a store, only what is asked for is read, by range, as long as it has an index;
    without one, and of a SQLite file, a temporary copy is.

    Raises:
        CallError: there is no such file.
        LogError: it is none of them.
        StoreError: the store fails.
    """
    if isinstance(path, Path):
        return _open_folder(path) if storage.is_folder(path) else _open_file(path)
    facts = storage.facts(path)
    return _open_folder(path) if facts.is_folder else _open_object(path, "", facts)


def open_joined(paths: Sequence[Location]) -> Log:
    """Open files of one recording as one log, merged by time.

    Raises:
        CallError: there is no such file.
        LogError: one is no log.
        StoreError: the store fails.
    """
    if len(paths) == 1:
        return _by_time(open_log(paths[0]))
    from dogbot_logtool.reader.containers.merged_log import join  # noqa: PLC0415

    logs: list[Log] = []
    try:
        for path in paths:
            logs.append(open_log(path))  # noqa: PERF401 - those that are open are closed
        kinds = sorted({log.container for log in logs})
        joined = join(logs[0].source.path, logs)
    except BaseException:
        for log in logs:
            log.close()
        raise
    joined.joined = tuple(log.source.path for log in logs[1:])
    joined.container = f"{len(logs)} joined logs ({', '.join(kinds)})"
    return joined


def _by_time(log: Log) -> Log:
    """Return a log merged by time if its chunks are out of order and few of them overlap."""
    if log.is_in_order():
        return log
    from dogbot_logtool.reader.containers.merged_log import most_at_once, reorder  # noqa: PLC0415

    return reorder(log) if most_at_once(log.chunks) <= _MOST_AT_ONCE else log


def _open_folder(path: Location) -> Log:
    from dogbot_logtool.reader.containers.rosbag2.directory import open_rosbag2  # noqa: PLC0415

    return open_rosbag2(path, _open_file, ROSBAG2_SUFFIXES)


def _open_file(path: Location, distribution: str = "", *, packed: bool = True) -> Log:
    if isinstance(path, Path):
        return _open_or_close(ByteSource(path), distribution, packed=packed)
    return _open_object(path, distribution, storage.facts(path))


def _open_object(path: "UPath", distribution: str, facts: storage.Facts) -> Log:
    # Imported late: only URLs need it.
    from dogbot_logtool.reader.containers.sources.remote_source import RemoteSource  # noqa: PLC0415

    return _open_or_close(RemoteSource(path, facts), distribution, packed=True)


def _open_or_close(source: ByteSource, distribution: str, *, packed: bool) -> Log:
    try:
        return _open_source(source, distribution, packed=packed)
    except BaseException:
        source.close()
        raise


def _open_source(source: ByteSource, distribution: str, *, packed: bool) -> Log:
    magic = source.read(0, _MAGIC_SIZE)
    if is_zstd(magic) and packed:
        from dogbot_logtool.reader.containers.sources.zstd_file import open_zstd  # noqa: PLC0415

        # Only once: no recorder compresses a compressed file again.
        log = open_zstd(source, lambda inner: _open_file(inner, distribution, packed=False))
        source.close()
        return log
    container = _with_magic(magic)
    if container is not None:
        return _open_container(container, source, distribution)
    if (what := not_a_log.changed_as_text(magic)) is not None:
        raise LogError(f"{storage.shown(source.path)}: {what}")
    container = None if not_a_log.is_known(magic) else _with_damaged_magic(magic)
    if container is None:
        raise LogError(f"{storage.shown(source.path)}: {not_a_log.describe(source)}")
    log = _open_container(container, source, distribution)
    log.losses = (Loss(0, "the file's first bytes are damaged"), *log.losses)
    return log


def _open_container(container: Container, source: ByteSource, distribution: str) -> Log:
    log = container.open(source, distribution)
    log.losses = tuple(map(log.located, log.losses))
    return log


def _with_magic(magic: bytes) -> Container | None:
    """Return the container whose files begin so."""
    return next((each for each in CONTAINERS if magic.startswith(each.magic)), None)


def _with_damaged_magic(magic: bytes) -> Container | None:
    """Return the container whose files begin nearly so, if it can be scanned."""
    scanned = (each for each in CONTAINERS if each.is_scanned)
    return next((each for each in scanned if _resembles(magic, each.magic)), None)


def _resembles(magic: bytes, expected: bytes) -> bool:
    """Tell whether a file begins as expected, but for a few bytes."""
    start = magic[: len(expected)]
    differing = sum(a != b for a, b in zip(start, expected, strict=False))
    return len(start) == len(expected) and differing <= _MOST_DAMAGED_BYTES
