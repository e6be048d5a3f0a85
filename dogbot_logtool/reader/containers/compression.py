"""Decompression of chunks into memory that is set aside beforehand: nothing can swell."""

import bz2
import struct
from typing import Final

import lz4.block
import lz4.frame
import numpy as np
import xxhash
import zstandard

from dogbot_logtool.core.arrays import Bytes
from dogbot_logtool.reader.containers.salvage.content import ChunkDamage

MAX_CHUNK_SIZE: Final = 1 << 30
_UNSUSPICIOUS_SIZE: Final = 32 << 20
_MAX_RATIO: Final = 40
"""Larger chunks than `_UNSUSPICIOUS_SIZE` must not claim to shrink by more than this."""

_LZ4_HEAD: Final = struct.Struct("<4sB2xI")
_LZ4_MAGIC: Final = b"\x04\x22\x4d\x18"
_LZ4_VERSION, _LZ4_CHECKSUM = 0x40, 0x04
_LZ4_ANY: Final = _LZ4_CHECKSUM | 0x20
"""Flags that a frame of one block may have: a checksum of its content, blocks by themselves."""
_CODEC_ERRORS: Final = (
    zstandard.ZstdError,
    lz4.block.LZ4BlockError,
    RuntimeError,
    OSError,
    ValueError,
    EOFError,
)


def check_claimed_size(claimed: int, compressed: int) -> None:
    """Refuse a chunk whose claimed size cannot be honest, before memory is set aside for it.

    Raises:
        ChunkDamage: saying what it claims.
    """
    if claimed > MAX_CHUNK_SIZE or claimed > max(_UNSUSPICIOUS_SIZE, _MAX_RATIO * compressed):
        raise ChunkDamage(f"it claims to hold {claimed} bytes in {compressed}")


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

    LZ4 frame format: magic, flags, block descriptor, header checksum, size of the block, the
    block, a zero size, and the optional checksum of the content.
    """
    if len(data) < _LZ4_HEAD.size:
        return None
    magic, flags, size = _LZ4_HEAD.unpack_from(data)
    body, tail = data[_LZ4_HEAD.size :][:size], bytes(data[_LZ4_HEAD.size + size :])
    has_checksum = bool(flags & _LZ4_CHECKSUM)
    is_plain = magic == _LZ4_MAGIC and flags & ~_LZ4_ANY == _LZ4_VERSION
    if not is_plain or len(tail) != 4 + 4 * has_checksum or any(tail[:4]):
        return None
    return body, int.from_bytes(tail[4:], "little") if has_checksum else None
