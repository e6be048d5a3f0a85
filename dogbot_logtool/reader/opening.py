"""Opening a log: its first bytes tell what it is, not its name."""

from collections.abc import Sequence
from importlib import import_module
from pathlib import Path
from typing import Final

from dogbot_logtool.errors import LogError
from dogbot_logtool.io import storage
from dogbot_logtool.io.storage import Location
from dogbot_logtool.reader import not_a_log
from dogbot_logtool.reader.containers.log import Log
from dogbot_logtool.reader.containers.loss import Loss
from dogbot_logtool.reader.containers.registry import CONTAINERS, Container, is_zstd
from dogbot_logtool.reader.containers.source import ByteSource

_MAGIC_SIZE: Final = 16
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
    facts = None if isinstance(path, Path) else storage.facts(path)
    if facts.is_folder if facts else storage.is_folder(path):
        from dogbot_logtool.reader.containers.rosbag2 import open_rosbag2  # noqa: PLC0415

        return open_rosbag2(path, _open_file)
    return _open_file(path, facts=facts)


def open_joined(paths: Sequence[Location]) -> Log:
    """Open files of one recording as one log.

    Raises:
        CallError: there is no such file.
        LogError: one is no log.
        StoreError: the store fails.
    """
    if len(paths) == 1:
        return open_log(paths[0])
    from dogbot_logtool.reader.containers.joined_log import JoinedLog  # noqa: PLC0415

    logs: list[Log] = []
    try:
        for path in paths:
            logs.append(open_log(path))  # noqa: PERF401 - those that are open are closed
        joined = JoinedLog(logs[0].source.path, logs)
    except BaseException:
        for log in logs:
            log.close()
        raise
    joined.joined = tuple(log.source.path for log in logs[1:])
    kinds = ", ".join(sorted({log.container for log in logs}))
    joined.container = f"{len(logs)} joined logs ({kinds})"
    return joined


def _open_file(
    path: Location,
    distribution: str = "",
    *,
    packed: bool = True,
    facts: storage.Facts | None = None,
) -> Log:
    """Open a file.

    Args:
        path: the file.
        distribution: of ROS 2, that recorded it; empty: not known.
        packed: whether it may be compressed: only once, as no recorder does that twice.
        facts: what its store says of it, if it was asked.
    """
    if isinstance(path, Path):
        source = ByteSource(path)
    else:
        # Imported late: only URLs need it.
        from dogbot_logtool.reader.containers.remote_source import (  # noqa: PLC0415
            RemoteSource,
        )

        source = RemoteSource(path, facts or storage.facts(path))
    try:
        return _open_source(source, distribution, packed=packed)
    except BaseException:
        source.close()
        raise


def _open_source(source: ByteSource, distribution: str, *, packed: bool) -> Log:
    magic = source.read(0, _MAGIC_SIZE)
    if is_zstd(magic) and packed:
        from dogbot_logtool.reader.containers.zstd import open_zstd  # noqa: PLC0415

        unpacked = open_zstd(source, lambda inner: _open_file(inner, distribution, packed=False))
        source.close()
        return unpacked
    container = next((each for each in CONTAINERS if magic.startswith(each.magic)), None)
    damage: tuple[Loss, ...] = ()
    if container is None:
        container = _with_damaged_magic(magic)
        damage = (Loss(0, "the file's first bytes are damaged"),)
        if container is None or not_a_log.is_known(magic):
            raise LogError(f"{storage.name_of(source.path)}: {not_a_log.describe(source)}")
    module = import_module(f"dogbot_logtool.reader.containers.{container.module}")
    log: Log = module.open_log(source, distribution)
    log.losses = (*damage, *map(log.located, log.losses))
    return log


def _with_damaged_magic(magic: bytes) -> Container | None:
    """Return the container whose files begin so but for a few bytes, if it can be scanned."""
    for each in CONTAINERS:
        start = magic[: len(each.magic)]
        differing = sum(a != b for a, b in zip(start, each.magic, strict=False))
        is_like = len(start) == len(each.magic) and differing <= _MOST_DAMAGED_BYTES
        if each.is_scanned and is_like:
            return each
    return None
