"""Opening a log: what it is, is told by its first bytes, not by its name.

The code of a container is imported when such a log is opened.
"""

from pathlib import Path
from typing import TYPE_CHECKING, Final, TypeVar

from dogbot_logtool.errors import LogError
from dogbot_logtool.io import storage
from dogbot_logtool.io.storage import Location
from dogbot_logtool.reader.containers import not_a_log
from dogbot_logtool.reader.containers.log import Log, Loss
from dogbot_logtool.reader.containers.signatures import BAG_MAGIC, MCAP_MAGIC, SQLITE_MAGIC, is_zstd
from dogbot_logtool.reader.containers.source import ByteSource

if TYPE_CHECKING:
    from upath import UPath

OpenedLog = TypeVar("OpenedLog", bound=Log)

_MOST_DAMAGED_BYTES: Final = 2


def open_log(path: Location) -> Log:
    """Open a ROS 1 bag, an MCAP, or a ROS 2 bag: its directory or one of its files.

    Of a log in a store, only what is asked for is read, by range, as long as it has an index;
    without one, and where a library needs a file, a temporary copy is.

    Raises:
        CallError: there is no such file.
        LogError: it is none of them.
        StoreError: the store fails.
    """
    if isinstance(path, Path):
        return _open_folder(path) if storage.is_folder(path) else _open_file(path)
    facts = storage.facts(path)
    return _open_folder(path) if facts.is_folder else _open_object(path, "", facts)


def _open_folder(path: Location) -> Log:
    from dogbot_logtool.reader.containers.rosbag2.directory import open_rosbag2  # noqa: PLC0415

    return open_rosbag2(path, _open_file)


def _open_file(path: Location, distribution: str = "", *, packed: bool = True) -> Log:
    if isinstance(path, Path):
        return _open_or_close(ByteSource(path), distribution, packed=packed)
    return _open_object(path, distribution, storage.facts(path))


def _open_object(place: "UPath", distribution: str, facts: storage.Facts) -> Log:
    # Imported late: only URLs need it.
    from dogbot_logtool.reader.containers.remote_source import RemoteSource, open_copied  # noqa: PLC0415

    source = RemoteSource(place, facts)
    if source.read(0, 16) == SQLITE_MAGIC:
        return open_copied(source, lambda copy: _open_file(copy, distribution))
    return _open_or_close(source, distribution, packed=True)


def _open_or_close(source: ByteSource, distribution: str, *, packed: bool) -> Log:
    try:
        return _open_source(source, distribution, packed=packed)
    except BaseException:
        source.close()
        raise


def _open_source(source: ByteSource, distribution: str, *, packed: bool) -> Log:
    magic = source.read(0, 16)
    if magic == SQLITE_MAGIC:
        from dogbot_logtool.reader.containers.sqlite.log import open_sqlite  # noqa: PLC0415

        return open_sqlite(source, distribution)
    if is_zstd(magic) and packed:
        from dogbot_logtool.reader.containers.zstd_file import open_zstd  # noqa: PLC0415

        # Only once: a file within a file within a file is nobody's log.
        log = open_zstd(source, lambda inner: _open_file(inner, distribution, packed=False))
        source.close()
        return log
    if (what := not_a_log.changed_as_text(magic)) is not None:
        raise LogError(f"{storage.shown(source.path)}: {what}")
    known = not_a_log.is_known(magic)
    if not known and _resembles(magic, MCAP_MAGIC):
        from dogbot_logtool.reader.containers.mcap.log import open_mcap  # noqa: PLC0415

        return _noting_damage(open_mcap(source), magic, MCAP_MAGIC)
    if not known and _resembles(magic, BAG_MAGIC):
        from dogbot_logtool.reader.containers.bag.log import open_bag  # noqa: PLC0415

        return _noting_damage(open_bag(source), magic, BAG_MAGIC)
    raise LogError(f"{storage.shown(source.path)}: {not_a_log.describe(source)}")


def _resembles(magic: bytes, expected: bytes) -> bool:
    """Tell whether a file begins as expected, or nearly so."""
    start = magic[: len(expected)]
    differing = sum(a != b for a, b in zip(start, expected, strict=False))
    return len(start) == len(expected) and differing <= _MOST_DAMAGED_BYTES


def _noting_damage(log: OpenedLog, magic: bytes, expected: bytes) -> OpenedLog:
    if not magic.startswith(expected):
        log.losses = (Loss(0, "the file's first bytes are damaged"), *log.losses)
    return log
