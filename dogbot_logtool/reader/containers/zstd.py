"""What recorders compress with zstd: whole logs, or messages one by one."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import BinaryIO, Final

import numpy as np
import zstandard

from dogbot_logtool.errors import LogError
from dogbot_logtool.io.storage import file_stem, name_of, scratch_folder
from dogbot_logtool.reader.containers.log import Batch, Log
from dogbot_logtool.reader.containers.loss import Loss
from dogbot_logtool.reader.containers.registry import ZSTD_MAGIC, is_zstd
from dogbot_logtool.reader.containers.source import ByteSource
from dogbot_logtool.reader.decode.columns import gather

_PIECE: Final = 2 << 10
"""Bytes that are decompressed at once: each byte may swell to 32 kB."""
_MOST_FREE: Final = 256 << 20
_MAX_RATIO: Final = 200
"""A file must not swell to more than this times its size, or `_MOST_FREE`."""
_BATCH_BUDGET: Final = 64 << 20
_MAX_BATCH_RATIO: Final = 40
"""A batch must not swell to more than this times its size, or `_BATCH_BUDGET`."""


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
        try:
            with copy.open("xb") as file:
                loss = _decompress(source, file)
        except OSError as error:
            raise LogError(f"{name_of(path)}: cannot be decompressed: {error.strerror}") from error
        try:
            log = open_file(copy)
        except LogError as error:
            why = str(error).replace(str(copy), name_of(path))
            raise LogError(why if loss is None else f"{name_of(path)}: {loss.what}") from error
    # The file's name is gone, but the log holds its bytes open.
    log.source.path = path
    if loss is not None:
        # Whatever was in the compressed bytes came after all that was read.
        log.losses = (loss._replace(start_time=log.end_time), *log.losses)
    return log


def _decompress(source: ByteSource, target: BinaryIO) -> Loss | None:
    """Write what the frames of a file hold, up to the piece in which one is damaged.

    Parallel compressors write many frames, and such as are to be skipped before them.

    Returns:
        what is wrong with the rest.

    Raises:
        LogError: there is too much content.
    """
    size, offset, data = source.size, 0, source.read(0, _PIECE)
    most = max(_MOST_FREE, _MAX_RATIO * size)
    zstd = zstandard.ZstdDecompressor()
    try:
        while is_zstd(data):
            frame = zstd.decompressobj()
            while not frame.eof:
                if not data:
                    return Loss(size, f"its zstd data is cut off after {size} bytes", 0, None)
                target.write(frame.decompress(data))
                if target.tell() > most:
                    raise LogError(f"{name_of(source.path)}: its {size} bytes swell to over {most}")
                offset += len(data) - len(frame.unused_data)
                data = source.read(offset, _PIECE)
    except zstandard.ZstdError as error:
        what = (
            f"its zstd data is damaged behind byte {offset} ({error}); what stands before was read"
        )
        return Loss(offset, what, size - offset, None)
    start = offset
    while data and not data.strip(b"\0"):
        offset += len(data)
        data = source.read(offset, _PIECE)
    what = f"the {size - start} bytes behind its zstd data were left out"
    return Loss(start, what, size - start, None) if data else None


def unpacked(batch: Batch) -> Batch:
    """Decompress the messages of a batch that are zstd frames of their own."""
    messages = batch.messages
    packed = messages.end - messages.start >= len(ZSTD_MAGIC)
    if packed.any():
        heads = gather(batch.buffer, messages.start[packed], len(ZSTD_MAGIC))
        packed[packed] = heads == np.void(ZSTD_MAGIC)
    if not packed.any():
        return batch
    parts: list[bytes | None] = []
    left = max(_BATCH_BUDGET, _MAX_BATCH_RATIO * len(batch.buffer))
    rows = zip(packed.tolist(), messages.start.tolist(), messages.end.tolist(), strict=True)
    for is_packed, start, end in rows:
        data = batch.buffer[start:end].tobytes()
        parts.append(_content(data, left) if is_packed else data)
        left -= len(parts[-1] or b"")
    ends = np.cumsum([len(part or b"") for part in parts])
    starts = np.append(0, ends[:-1])
    buffer = np.frombuffer(b"".join(part or b"" for part in parts) or b"\0", np.uint8)
    fresh = replace(batch, buffer=buffer, messages=replace(messages, start=starts, end=ends))
    kept = np.array([part is not None for part in parts])
    if kept.all():
        return fresh
    lost = int((~kept).sum())
    loss = Loss(0, f"{lost} messages cannot be decompressed", 0, lost)
    return replace(fresh.only(kept), losses=(*batch.losses, loss))


def _content(data: bytes, most: int) -> bytes | None:
    """Return the content of a frame; None if it is damaged or larger than allowed."""
    try:
        if most <= 0 or zstandard.frame_content_size(data) > most:
            return None
        plain = zstandard.ZstdDecompressor().decompress(data, max_output_size=most)
    except (zstandard.ZstdError, MemoryError):
        return None
    return plain if len(plain) <= most else None
