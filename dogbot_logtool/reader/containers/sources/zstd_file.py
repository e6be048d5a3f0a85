"""Logs that were compressed whole, as ROS 2 recorders can: decompressed into a temporary file."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import BinaryIO, Final

import zstandard

from dogbot_logtool.errors import LogError
from dogbot_logtool.io.scratch import scratch_folder
from dogbot_logtool.io.storage import Location, file_stem, shown
from dogbot_logtool.reader.containers.log import Log, Loss
from dogbot_logtool.reader.containers.signatures import is_zstd
from dogbot_logtool.reader.containers.sources.source import ByteSource

_PIECE: Final = 2 << 10
"""Bytes that are decompressed at once: each byte may swell to 32 kB."""
_MAGIC_SIZE: Final = 4
_MOST_FREE: Final = 256 << 20
_MAX_RATIO: Final = 200
"""A file must not swell to more than this times its size, or `_MOST_FREE`."""


def open_zstd(source: ByteSource, open_file: Callable[[Path], Log]) -> Log:
    """Open a zstd-compressed log; nothing stays on the disk.

    What stands before damage is read, and the damage is a loss.

    Args:
        source: the compressed file.
        open_file: opens what is in it.

    Raises:
        LogError: it swells absurdly, or what is in it is no log.
    """
    path = source.path
    with scratch_folder() as folder:
        copy = folder / file_stem(path)
        with copy.open("xb") as file:
            loss = _decompress(path, source.size, file)
        try:
            log = open_file(copy)
        except LogError as error:
            why = str(error).replace(str(copy), shown(path))
            raise LogError(why if loss is None else f"{shown(path)}: {loss.what}") from error
    # The file's name is gone, but the log holds its bytes open.
    log.source.path = path
    if loss is not None:
        # Whatever was in the compressed bytes came after all that was read.
        log.losses = (replace(loss, start_time=log.end_time), *log.losses)
    return log


def _decompress(path: Location, size: int, target: BinaryIO) -> Loss | None:
    """Decompress all that can be; return what is wrong with the rest."""
    most = max(_MOST_FREE, _MAX_RATIO * size)
    try:
        with path.open("rb") as packed:
            try:
                return _unpack(packed, size, target, most)
            except zstandard.ZstdError:
                good = max(packed.tell() - _PIECE, 0)
        target.seek(0)
        with path.open("rb") as packed:
            return _unpack_carefully(packed, size, target, most, good)
    except _SwellsError as error:
        raise LogError(f"{shown(path)}: its {size} bytes swell to over {most}") from error
    except OSError as error:
        raise LogError(f"{shown(path)}: cannot be decompressed: {error.strerror}") from error


def _unpack_carefully(
    packed: BinaryIO, size: int, target: BinaryIO, most: int, good: int
) -> Loss | None:
    """Decompress a damaged file byte by byte behind its good bytes, up to the damage."""
    try:
        return _unpack(packed, size, target, most, good)
    except zstandard.ZstdError as error:
        offset = packed.tell()
        what = (
            f"its zstd data is damaged at byte {offset} ({error}); only what stands before came out"
        )
        return Loss(offset, what, size - offset, None)


def _unpack(
    packed: BinaryIO, size: int, target: BinaryIO, most: int, careful_from: int | None = None
) -> Loss | None:
    """Write what the frames of a file hold; return what is wrong behind that.

    Parallel compressors write many frames, and such as are to be skipped before them.

    Args:
        packed: the file.
        size: of it, bytes.
        target: receives the content.
        most: bytes that it may have.
        careful_from: byte from which on it is read byte by byte.

    Raises:
        zstandard.ZstdError: a frame is damaged.
        _SwellsError: there is more content.
    """
    zstd = zstandard.ZstdDecompressor()
    data = packed.read(_MAGIC_SIZE)
    while is_zstd(data):
        frame = zstd.decompressobj()
        while not frame.eof:
            if not data:
                return Loss(size, f"its zstd data is cut off after {size} bytes", 0, None)
            target.write(frame.decompress(data))
            if target.tell() > most:
                raise _SwellsError
            careful = careful_from is not None and packed.tell() >= careful_from
            data = frame.unused_data if frame.eof else packed.read(1 if careful else _PIECE)
        data += packed.read(max(_MAGIC_SIZE - len(data), 0))
    offset = packed.tell() - len(data)
    while data and not data.strip(b"\0"):
        data = packed.read(_PIECE)
    what = f"the {size - offset} bytes behind its zstd data were left out"
    return Loss(offset, what, size - offset, None) if data else None


class _SwellsError(Exception):
    """A file holds more than it may."""
