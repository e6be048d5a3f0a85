"""Decompression of chunks, of messages and of whole logs, within limits: nothing can swell."""

import bz2
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Final

import lz4.block
import lz4.frame
import numpy as np
import xxhash
import zstandard

from dogbot_logtool.core.arrays import Bytes
from dogbot_logtool.errors import LogError
from dogbot_logtool.io.storage import name_of
from dogbot_logtool.reader.containers.log import Batch, Log
from dogbot_logtool.reader.containers.loss import Loss
from dogbot_logtool.reader.containers.registry import ZSTD_MAGIC, is_zstd
from dogbot_logtool.reader.containers.salvage import ChunkDamage
from dogbot_logtool.reader.containers.source import ByteSource, copied
from dogbot_logtool.reader.decode.columns import gather

MAX_CHUNK_SIZE: Final = 1 << 30
_UNSUSPICIOUS_SIZE: Final = 32 << 20
_MAX_RATIO: Final = 40
"""Larger chunks than `_UNSUSPICIOUS_SIZE` must not claim to shrink by more than this."""

_LZ4_MAGIC: Final = b"\x04\x22\x4d\x18"
_LZ4_VERSION, _LZ4_SIZE, _LZ4_CHECKSUM = 0x40, 0x08, 0x04
_LZ4_ANY: Final = _LZ4_CHECKSUM | _LZ4_SIZE | 0x20
"""Flags that a frame may have: checksum and size of its content, and blocks by themselves."""
_CODEC_ERRORS: Final = (
    zstandard.ZstdError,
    lz4.block.LZ4BlockError,
    RuntimeError,
    OSError,
    ValueError,
    EOFError,
)

_PIECE: Final = 2 << 10
"""Bytes that are decompressed at once: each byte may swell to 32 kB."""
_MOST_FREE: Final = 256 << 20
_MAX_FILE_RATIO: Final = 200
"""A file must not swell to more than this times its size, or `_MOST_FREE`."""
_BATCH_BUDGET: Final = 64 << 20
_MAX_BATCH_RATIO: Final = 40
"""A batch must not swell to more than this times its size, or `_BATCH_BUDGET`."""


def is_honest_size(claimed: int, compressed: int) -> bool:
    """Tell whether the claimed size of a chunk can be true."""
    return claimed <= min(MAX_CHUNK_SIZE, max(_UNSUSPICIOUS_SIZE, _MAX_RATIO * compressed))


def decompress_into(target: Bytes, data: memoryview, compression: str) -> int:
    """Decompress a chunk into the target.

    Args:
        target: (n,) uint8, contiguous, as long as the chunk claims to be.
        data: the compressed bytes.
        compression: ``none`` or empty, ``lz4``, ``bz2`` or ``zstd``.

    Returns:
        the number of bytes: n, or fewer if they are not compressed and cut off.

    Raises:
        ChunkDamage: the data is damaged, or of another size than claimed.
    """
    is_plain = compression in {"", "none"}
    try:
        match compression:
            case "" | "none":
                size = _copy_into(target, data)
            case "zstd":
                size = _unzstd_into(target, data)
            case "lz4":
                size = _copy_into(target, _unlz4(data, len(target)))
            case "bz2":
                content = bz2.BZ2Decompressor().decompress(data, len(target) + 1)
                size = _copy_into(target, content)
            case _:
                raise ChunkDamage(f"its compression {compression!r} is not known")
    except _CODEC_ERRORS as error:
        raise ChunkDamage(f"its {compression} data is damaged ({error})") from error
    if size > len(target):
        raise ChunkDamage(f"it claims to hold {len(target)} bytes but does not")
    if size < len(target) and not is_plain:
        raise ChunkDamage(f"its {compression} data is damaged or cut off")
    return size


def _copy_into(target: Bytes, data: bytes | memoryview) -> int:
    if len(data) <= len(target):
        target[: len(data)] = np.frombuffer(data, np.uint8)
    return len(data)


def _unzstd_into(target: Bytes, data: memoryview) -> int:
    with zstandard.ZstdDecompressor().stream_reader(data, read_across_frames=True) as stream:
        size = 0
        while size < len(target) and (got := stream.readinto(target[size:].data)):
            size += got
        return size + len(stream.read(1))


def _unlz4(data: memoryview, size: int) -> bytes:
    """Decompress an LZ4 frame.

    Recorders write frames of a single block, which the block decoder takes several times faster
    than the frame decoder; the frame's content checksum is then verified here. Any other frame
    goes to the frame decoder.

    Raises:
        ValueError: the frame is cut off, or its checksum does not hold.
    """
    block = _single_block(data)
    if block is None:
        decompressor = lz4.frame.LZ4FrameDecompressor()
        content = bytes(decompressor.decompress(data, max_length=size + 1))
        if not decompressor.eof and len(content) <= size:
            raise ValueError("it is cut off")
        return content
    body, checksum = block
    content = bytes(lz4.block.decompress(body, uncompressed_size=size))
    if checksum is not None and xxhash.xxh32_intdigest(content) != checksum:
        raise ValueError("content checksum does not hold")
    return content


def _single_block(data: memoryview) -> tuple[memoryview, int | None] | None:
    """Return a frame's only compressed block and its content checksum, or None for other frames.

    LZ4 frame format: magic, flags, block descriptor, optional content size (8 bytes), header
    checksum, size of the block, the block, a zero size, and the optional checksum of the content.
    """
    if len(data) < 15:
        return None
    flags = data[4]
    start = 11 + (8 if flags & _LZ4_SIZE else 0)
    size = int.from_bytes(data[start - 4 : start], "little")
    body, tail = data[start : start + size], bytes(data[start + size :])
    has_checksum = bool(flags & _LZ4_CHECKSUM)
    is_plain = bytes(data[:4]) == _LZ4_MAGIC and flags & ~_LZ4_ANY == _LZ4_VERSION
    if not is_plain or len(tail) != 4 + 4 * has_checksum or any(tail[:4]):
        return None
    return body, int.from_bytes(tail[4:], "little") if has_checksum else None


def open_zstd(source: ByteSource, open_source: Callable[[ByteSource], Log]) -> Log:
    """Open a zstd-compressed log; nothing stays on the disk.

    What stands before damage is read, and the damage is a loss.

    Args:
        source: the compressed file.
        open_source: opens what is in it.

    Raises:
        LogError: it swells absurdly, or what is in it is no log.
    """
    losses: list[Loss] = []
    copy = copied(source.path, _decompressed(source, losses))
    try:
        log = open_source(copy)
    except BaseException as error:
        copy.close()
        if losses and isinstance(error, LogError):
            raise LogError(f"{name_of(source.path)}: {losses[0].what}") from error
        raise
    # Whatever was in the compressed bytes came after all that was read.
    log.losses = (*(loss._replace(start_time=log.end_time) for loss in losses), *log.losses)
    return log


def _decompressed(source: ByteSource, losses: list[Loss]) -> Iterator[tuple[int, bytes]]:
    """Yield what the frames of a file hold, up to the piece in which one is damaged, by its offset.

    Parallel compressors write many frames, and such as are to be skipped before them.

    Args:
        source: the file.
        losses: receives what is wrong with the rest.

    Raises:
        LogError: there is too much content.
    """
    size, offset, data = source.size, 0, source.read(0, _PIECE)
    most, written = max(_MOST_FREE, _MAX_FILE_RATIO * size), 0
    zstd = zstandard.ZstdDecompressor()
    try:
        while is_zstd(data):
            frame = zstd.decompressobj()
            while not frame.eof:
                if not data:
                    raise zstandard.ZstdError("it is cut off")
                content = frame.decompress(data)
                yield written, content
                written += len(content)
                if written > most:
                    raise LogError(f"{name_of(source.path)}: its {size} bytes swell to over {most}")
                offset += len(data) - len(frame.unused_data)
                data = source.read(offset, _PIECE)
        while data and not data.strip(b"\0"):
            offset += len(data)
            data = source.read(offset, _PIECE)
        if data:
            raise zstandard.ZstdError("what follows is no zstd data")
    except zstandard.ZstdError as error:
        what = (
            f"its zstd data is damaged behind byte {offset} ({error}); what stands before was read"
        )
        losses.append(Loss(offset, what, size - offset, None))


def unpacked(batch: Batch) -> Batch:
    """Decompress the messages of a batch that are zstd frames of their own."""
    messages = batch.messages
    starts = messages.start[messages.end - messages.start >= len(ZSTD_MAGIC)]
    heads = gather(batch.buffer, starts, len(ZSTD_MAGIC)) if len(starts) else np.empty(0, "V4")
    if not (heads == np.void(ZSTD_MAGIC)).any():
        return batch
    parts: list[bytes | None] = []
    left = max(_BATCH_BUDGET, _MAX_BATCH_RATIO * len(batch.buffer))
    for start, end in zip(messages.start.tolist(), messages.end.tolist(), strict=True):
        data = batch.buffer[start:end].tobytes()
        parts.append(_content(data, left) if data.startswith(ZSTD_MAGIC) else data)
        left -= len(parts[-1] or b"")
    size = np.array([len(part or b"") for part in parts])
    ends = np.cumsum(size)
    buffer = np.frombuffer(b"".join(part or b"" for part in parts) or b"\0", np.uint8)
    fresh = replace(batch, buffer=buffer, messages=replace(messages, start=ends - size, end=ends))
    lost = parts.count(None)
    if not lost:
        return fresh
    loss = Loss(0, f"{lost} messages cannot be decompressed", 0, lost)
    kept = np.array([part is not None for part in parts])
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
