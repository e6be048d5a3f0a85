"""Logs that were compressed whole, as ROS 2 recorders can: decompressed into a temporary file."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import BinaryIO, Final

import zstandard

from dogbot_logtool.errors import LogError
from dogbot_logtool.io.scratch import scratch_folder
from dogbot_logtool.io.storage import Location, file_stem, shown
from dogbot_logtool.reader.containers.log import Log
from dogbot_logtool.reader.containers.signatures import is_zstd
from dogbot_logtool.reader.containers.sources.source import ByteSource

_PIECE: Final = 1 << 20
_MAGIC_SIZE: Final = 4
_MOST_FREE: Final = 256 << 20
_MAX_RATIO: Final = 200
"""A file must not swell to more than this times its size, or `_MOST_FREE`."""


def open_zstd(source: ByteSource, open_file: Callable[[Path], Log]) -> Log:
    """Open a zstd-compressed log; nothing stays on the disk.

    Args:
        source: the compressed file.
        open_file: opens what is in it.

    Raises:
        LogError: it is damaged or swells absurdly, or what is in it is no log.
    """
    path = source.path
    with scratch_folder() as folder:
        copy = folder / file_stem(path)
        with copy.open("xb") as file:
            _decompress(path, source.size, file)
        try:
            log = open_file(copy)
        except LogError as error:
            raise LogError(str(error).replace(str(copy), shown(path))) from error
    # The file's name is gone, but the log holds its bytes open.
    log.source.path = path
    return log


def _decompress(path: Location, size: int, target: BinaryIO) -> None:
    most = max(_MOST_FREE, _MAX_RATIO * size)
    written = 0
    try:
        with path.open("rb") as compressed:
            for piece in _content(compressed):
                written += len(piece)
                if written > most:
                    raise LogError(f"{shown(path)}: its {size} bytes swell to over {most}")
                target.write(piece)
    except zstandard.ZstdError as error:
        raise LogError(f"{shown(path)}: its zstd data is damaged ({error})") from error
    except OSError as error:
        raise LogError(f"{shown(path)}: cannot be decompressed: {error.strerror}") from error


def _content(file: BinaryIO) -> Iterator[bytes]:
    """Yield what the frames of a file hold, in pieces.

    Parallel compressors write many frames, and such as are to be skipped before them. Whatever
    follows the last one is no part of the content.
    """
    zstd = zstandard.ZstdDecompressor()
    data = file.read(_PIECE)
    while is_zstd(data):
        frame = zstd.decompressobj()
        while data:
            yield frame.decompress(data)
            if frame.eof:
                break
            data = file.read(_PIECE)
        rest = frame.unused_data
        data = rest if len(rest) >= _MAGIC_SIZE else rest + file.read(_PIECE)
