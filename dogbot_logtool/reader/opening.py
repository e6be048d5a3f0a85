"""Opening a log: its first bytes tell what it is, not its name."""

import re
from collections.abc import Sequence
from contextlib import ExitStack, closing
from importlib import import_module
from pathlib import Path
from typing import Final

from dogbot_logtool.errors import LogError
from dogbot_logtool.io import storage
from dogbot_logtool.io.storage import Location
from dogbot_logtool.reader.containers.log import Log
from dogbot_logtool.reader.containers.loss import Loss
from dogbot_logtool.reader.containers.registry import (
    CONTAINERS,
    ROSBAG2_METADATA,
    Container,
    is_zstd,
)
from dogbot_logtool.reader.containers.source import ByteSource, RemoteSource

_MAGIC_SIZE: Final = 16
_MOST_DAMAGED_BYTES: Final = 2
_HEAD: Final = 4096
_OLD: Final = rb"#ROSBAG V1"
_TAKEN_FOR_TEXT: Final = (
    # Other line ends; a byte-order mark; read as UTF-8, Latin-1, Windows-1252 or ASCII.
    rb"\x89MCAP0(\n|\r\r|\r\x01)|#ROSBAG V2\.0\r|\xef\xbb\xbf(\x89MCAP|#ROSBAG)|"
    rb"(\xef\xbf\xbd|\xc2\x89|\xe2\x80\xb0|\?)?MCAP"
)
_NOT_LOGS: Final = {
    rb"\Z": "is empty (0 bytes): nothing was recorded or copied into it",
    _TAKEN_FOR_TEXT: (
        "was changed on its way by what took it for text (a transfer, an editor, a script): bytes "
        "everywhere in it are no longer the recorded ones; copy it again in binary mode"
    ),
    rb"version https://git-lfs\.|outs:\n- md5:|.{,50}annex/objects/": (
        "is a pointer to the log, not the log itself: fetch that ('git lfs pull', 'git annex get' "
        "or 'dvc pull')"
    ),
    # zstd within zstd, gzip, bzip2, xz, lz4, zip, 7z and tar.
    rb"(?s)\x28\xb5\x2f\xfd|\x1f\x8b|BZh|\xfd7zXZ|\x04\x22\x4d\x18|PK|7z\xbc\xaf|.{257}ustar": (
        "is compressed, or an archive of files; unpack it first"
    ),
    _OLD: "is a bag of an older format than 2.0; 'rosbag fix' or 'rosbag migrate' updates it",
    rb"rosbag2_bagfile_information:": (
        f"is the {ROSBAG2_METADATA} of a ROS 2 bag; name the directory that it is in"
    ),
    rb"\0+\Z": (
        "begins with zeros where a log says what it is: room was made for it, but its start was "
        "never written (a crash or a copy that broke off); copy it again"
    ),
    rb"(\xef\xbb\xbf)?\s*[<{[]": (
        "is a text (a web page, XML or JSON), not a log: maybe a server's error in place of it; "
        "look into it, and download the log again"
    ),
    rb"": (
        "is neither a ROS 1 bag (#ROSBAG V2.0) nor an MCAP file nor a file of a ROS 2 bag: its "
        "first bytes are none of theirs"
    ),
}
"""How files begin that are no logs, and the sentence, without its subject, that says so."""


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

    with ExitStack() as opened:
        logs = [opened.enter_context(closing(open_log(path))) for path in paths]
        joined = JoinedLog(logs[0].source.path, logs)
        opened.pop_all()
    joined.joined = tuple(log.source.path for log in logs[1:])
    kinds = ", ".join(sorted({log.container for log in logs}))
    joined.container = f"{len(logs)} joined logs ({kinds})"
    return joined


def _open_file(
    path: Location,
    distribution: str = "",
    facts: storage.Facts | None = None,
) -> Log:
    """Open a file.

    Args:
        path: the file.
        distribution: of ROS 2, that recorded it; empty: not known.
        facts: what its store says of it, if it was asked.
    """
    source = (
        ByteSource(path)
        if isinstance(path, Path)
        else RemoteSource(path, facts or storage.facts(path))
    )
    try:
        return _open_source(source, distribution)
    except BaseException:
        source.close()
        raise


def _open_source(source: ByteSource, distribution: str, *, packed: bool = True) -> Log:
    """Open what is in a file; compressed it may be only once, as no recorder does that twice."""
    magic = source.read(0, _MAGIC_SIZE)
    if is_zstd(magic) and packed:
        from dogbot_logtool.reader.containers.compression import open_zstd  # noqa: PLC0415

        unpacked = open_zstd(source, lambda inner: _open_source(inner, distribution, packed=False))
        source.close()
        return unpacked
    container = next((each for each in CONTAINERS if magic.startswith(each.magic)), None)
    damage: tuple[Loss, ...] = ()
    if container is None:
        container = _with_damaged_magic(magic)
        damage = (Loss(0, "the file's first bytes are damaged"),)
        # A log that was taken for text on its way resembles one, but no length holds in it.
        if container is None or re.match(_TAKEN_FOR_TEXT + b"|" + _OLD, magic):
            raise LogError(f"{storage.name_of(source.path)}: {_not_a_log(source)}")
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


def _not_a_log(source: ByteSource) -> str:
    """Return the sentence, without its subject, that says what a file is if not a log."""
    head = source.read(0, _HEAD)
    if head and any(each.magic.startswith(head) for each in CONTAINERS):
        return f"breaks off after {source.size} bytes, before a log says what it is; copy it again"
    return next(what for start, what in _NOT_LOGS.items() if re.match(start, head))
