"""One MCAP chunk: its header, its checksum, and the messages in it."""

import struct
from dataclasses import replace
from operator import itemgetter
from typing import Final

import numpy as np
from mcap.opcode import Opcode
from zlib_ng.zlib_ng import crc32

from dogbot_logtool.core.arrays import Bytes
from dogbot_logtool.reader.containers.compression import decompress_into
from dogbot_logtool.reader.containers.contents import Chunk
from dogbot_logtool.reader.containers.loss import Loss
from dogbot_logtool.reader.containers.mcap.format import McapFormat
from dogbot_logtool.reader.containers.mcap.records import CHUNK_HEAD, RECORD_HEAD
from dogbot_logtool.reader.containers.salvage.content import ChunkContent, ChunkDamage, read_content
from dogbot_logtool.reader.containers.salvage.records import Index, IndexRecord, read_index
from dogbot_logtool.reader.containers.sources.source import ByteSource

INDEX_ENTRY: Final = np.dtype([("log_time", "<i8"), ("offset", "<u8")])
_INDEX_HEAD: Final = struct.Struct("<BQHI")
"""Opcode and length of an index record, channel, and bytes of its entries."""
_LONGEST_NAME: Final = 16
_KNOWN_NAMES: Final = (b"", b"lz4", b"zstd")


def chunk_at(source: ByteSource, offset: int) -> Chunk:
    """Read a chunk record's own header.

    The record may reach beyond the end of the file, and its two lengths may disagree.

    Raises:
        ChunkDamage: it makes no sense.
    """
    head = source.read(offset, RECORD_HEAD.size + CHUNK_HEAD.size + _LONGEST_NAME + 8)
    if len(head) < RECORD_HEAD.size + CHUNK_HEAD.size + 8:
        raise ChunkDamage("its header is cut off")
    _, length = RECORD_HEAD.unpack_from(head)
    start, end, size, crc, name_size = CHUNK_HEAD.unpack_from(head, RECORD_HEAD.size)
    name_start = RECORD_HEAD.size + CHUNK_HEAD.size
    name = head[name_start : name_start + name_size]
    if name not in _KNOWN_NAMES:
        name = _likely_name(head[name_start:], length) or name
    data_start = name_start + len(name) + 8
    is_name = len(name) <= _LONGEST_NAME and (not name or name.isalnum())
    if not is_name or len(head) < data_start:
        raise ChunkDamage("its header is damaged")
    (data_size,) = struct.unpack_from("<Q", head, data_start - 8)
    record_end = offset + RECORD_HEAD.size + length
    if data_start > RECORD_HEAD.size + length:
        raise ChunkDamage("its header is damaged")
    return Chunk(
        offset=offset,
        data_offset=offset + data_start,
        data_size=data_size,
        end=record_end,
        index_end=record_end,
        compression=str(name, "utf-8", "replace"),
        size=size,
        crc=crc,
        start_time=start,
        end_time=end,
    )


def _likely_name(after: bytes, length: int) -> bytes | None:
    """Return the compression whose name makes the chunk's lengths agree."""
    for name in _KNOWN_NAMES:
        data_start = len(name) + 8
        if len(after) < data_start:
            return None
        (data_size,) = struct.unpack_from("<Q", after, len(name))
        if CHUNK_HEAD.size + data_start + data_size == length:
            return name
    return None


def parse_chunk(chunk: Chunk, stored: memoryview, target: Bytes, fmt: McapFormat) -> ChunkContent:
    """Decompress a chunk, verify its CRC and find its messages.

    Raises:
        ChunkDamage: nothing in it can be trusted.
    """
    crc, contradictions = _header_of(chunk, stored) if chunk.is_record else (0, ())
    index = _index(stored[chunk.end - chunk.offset :])
    try:
        data = stored[chunk.data_offset - chunk.offset :][: chunk.data_size]
        size = decompress_into(target, data, chunk.compression)
        if size < len(target):
            raise ChunkDamage("it is cut off")
        if crc and crc32(target.data) != crc:
            raise ChunkDamage("its checksum does not hold")
        if contradictions and not crc:
            raise ChunkDamage("its header is damaged, and it has no checksum")
    except ChunkDamage as damage:
        raise ChunkDamage(str(damage), len(index.offset) if index else None) from damage
    content = read_content(fmt, target, index, chunk, verified=bool(crc))
    return replace(content, losses=(*contradictions, *content.losses))


def _header_of(chunk: Chunk, stored: memoryview) -> tuple[int, tuple[Loss, ...]]:
    """Return the CRC of the chunk's own header, and whether it contradicts what is known of it."""
    head_size = RECORD_HEAD.size + CHUNK_HEAD.size
    if len(stored) < head_size:
        raise ChunkDamage("it is cut off")
    opcode, length = RECORD_HEAD.unpack_from(stored)
    start, end, size, crc, name_size = CHUNK_HEAD.unpack_from(stored, RECORD_HEAD.size)
    name = bytes(stored[head_size:][:name_size])
    data_size = bytes(stored[head_size + name_size :][:8])
    if (
        opcode == Opcode.CHUNK
        and chunk.offset + RECORD_HEAD.size + length == chunk.end
        and size == chunk.size
        and name == chunk.compression.encode()
        and data_size == struct.pack("<Q", chunk.data_size)
        and (chunk.is_scanned or (start, end) == (chunk.start_time, chunk.end_time))
    ):
        return crc, ()
    what = f"the header of the chunk at byte {chunk.offset} is damaged; it was read nevertheless"
    return crc, (Loss(chunk.offset, what),)


def _index(behind: memoryview) -> Index | None:
    return read_index(behind, _index_record, INDEX_ENTRY, itemgetter("log_time"))


def _index_record(behind: memoryview, offset: int) -> IndexRecord | None:
    if offset + _INDEX_HEAD.size > len(behind):
        return None
    opcode, length, channel, size = _INDEX_HEAD.unpack_from(behind, offset)
    start, end = offset + _INDEX_HEAD.size, offset + RECORD_HEAD.size + length
    if opcode != Opcode.MESSAGE_INDEX or not start + size <= end <= len(behind):
        return None
    return channel, behind[start : start + size], end
