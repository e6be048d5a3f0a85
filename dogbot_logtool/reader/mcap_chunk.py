"""One MCAP chunk: its header, its checksum, and the messages in it.

The messages are found through the chunk's message index or by walking its records.

The index is only a hint: it is believed when every record that it names is what it says and the
records tile the chunk, so that nothing is missing. Otherwise the records are walked one by one.
"""

import struct
import zlib
from dataclasses import dataclass, field
from typing import Final

import numpy as np
from mcap.opcode import Opcode
from numpy.typing import NDArray

from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.reader.columns import Bytes, gather
from dogbot_logtool.reader.compression import check_claimed_size, decompress_into
from dogbot_logtool.reader.log import (
    Chunk,
    ChunkContent,
    ChunkDamage,
    Loss,
    Messages,
    no_messages,
)
from dogbot_logtool.reader.mcap_records import RECORD_HEAD
from dogbot_logtool.reader.source import ByteSource

CHUNK_HEAD_SIZE: Final = 8 + 8 + 8 + 4
"""Bytes of a chunk record before the name of its compression."""
MESSAGE_HEAD: Final = np.dtype(
    [
        ("opcode", "u1"),
        ("length", "<u8"),
        ("channel", "<u2"),
        ("sequence", "<u4"),
        ("log_time", "<i8"),
        ("publish_time", "<i8"),
    ]
)
"""A message record up to its payload."""
INDEX_ENTRY: Final = np.dtype([("log_time", "<i8"), ("offset", "<u8")])
_INDEX_HEAD: Final = struct.Struct("<HI")


def chunk_at(source: ByteSource, place: int, content: int, length: int) -> Chunk:
    """Read a chunk record's own header."""
    head = source.read(content, min(length, CHUNK_HEAD_SIZE + 4 + 64 + 8))
    try:
        start, end, size, crc, name_size = struct.unpack_from("<QQQII", head)
        name_start = CHUNK_HEAD_SIZE + 4
        (data_size,) = struct.unpack_from("<Q", head, name_start + name_size)
        compression = str(head[name_start : name_start + name_size], "utf-8")
    except (struct.error, UnicodeDecodeError) as error:
        raise ChunkDamage("its header is damaged") from error
    data_offset = content + name_start + name_size + 8
    record_end = content + length
    if data_size > record_end - data_offset:
        raise ChunkDamage("it claims more data than its record holds")
    return Chunk(
        place, data_offset, data_size, record_end, record_end, compression, size, crc, start, end
    )


def check_chunk(chunk: Chunk, file_size: int) -> None:
    """Check what a chunk claims.

    Raises:
        ChunkDamage: it cannot be honest.
    """
    check_claimed_size(chunk.size, chunk.data_size)
    if chunk.end > file_size:
        raise ChunkDamage("it reaches beyond the end of the file")


def parse_chunk(chunk: Chunk, stored: memoryview, target: Bytes) -> ChunkContent:
    """Decompress a chunk, verify its CRC and find its messages."""
    crc = _confirm_header(chunk, stored) if chunk.is_record else 0
    data = stored[chunk.data_offset - chunk.offset :][: chunk.data_size]
    decompress_into(target, data, chunk.compression)
    if crc and zlib.crc32(target.data) != crc:
        raise ChunkDamage("its checksum does not hold")
    return _content(target, stored[chunk.end - chunk.offset :], chunk.offset)


def _confirm_header(chunk: Chunk, stored: memoryview) -> int:
    """Compare the chunk's own header with what the index said of it; return its CRC."""
    opcode, length = RECORD_HEAD.unpack_from(stored) if len(stored) >= 9 else (0, 0)
    if opcode != Opcode.CHUNK or chunk.offset + RECORD_HEAD.size + length != chunk.end:
        raise ChunkDamage("the index says that it begins there, but it does not")
    size, crc, name_size = struct.unpack_from("<QII", stored, RECORD_HEAD.size + 16)
    name = stored[RECORD_HEAD.size + CHUNK_HEAD_SIZE + 4 :][:name_size]
    if size != chunk.size or bytes(name) != chunk.compression.encode():
        raise ChunkDamage("its header contradicts the index")
    return int(crc)


@dataclass(slots=True)
class _Walked:
    offsets: list[int] = field(default_factory=list)
    others: list[tuple[int, int, int]] = field(default_factory=list)
    stopped_at: int | None = None


def _content(records: Bytes, index: memoryview, offset: int) -> ChunkContent:
    """Find the messages of a chunk.

    Args:
        records: (n,) uint8, the decompressed chunk.
        index: the file's bytes behind the chunk, which hold its message index if there is one.
        offset: of the chunk in the file, for saying where damage is.
    """
    hint = _indexed_offsets(index)
    if hint is not None:
        content = _content_by_index(records, *hint)
        if content is not None:
            return content
    walked = _walk(records, 0, len(records))
    losses: list[Loss] = []
    if hint is not None and walked.stopped_at is None and len(hint[0]):
        what = f"the message index of the chunk at byte {offset} is wrong; it was read without"
        losses.append(Loss(offset, what))
    if walked.stopped_at is not None:
        lost = len(records) - walked.stopped_at
        what = f"the chunk at byte {offset} holds {lost} bytes that are no record"
        losses.append(Loss(offset, what, lost, None))
    messages = _messages_at(records, np.array(walked.offsets, np.int64))
    return ChunkContent(messages, tuple(walked.others), tuple(losses))


def _indexed_offsets(index: memoryview) -> tuple[Ints, Ints, Ints] | None:
    """Return offset, channel and log time of the messages that an index names, by offset."""
    parts: list[NDArray[np.void]] = []
    channels: list[Ints] = []
    place = 0
    while place + RECORD_HEAD.size <= len(index):
        opcode, length = RECORD_HEAD.unpack_from(index, place)
        place += RECORD_HEAD.size
        if opcode != Opcode.MESSAGE_INDEX or not 6 <= length <= len(index) - place:
            break
        channel, size = _INDEX_HEAD.unpack_from(index, place)
        if size > length - 6 or size % INDEX_ENTRY.itemsize:
            return None
        entries = np.frombuffer(index[place + 6 : place + 6 + size], INDEX_ENTRY)
        parts.append(entries)
        channels.append(np.full(len(entries), channel, np.int64))
        place += length
    if not parts:
        return None
    entries = np.concatenate(parts)
    order = np.argsort(entries["offset"], kind="stable")
    offset = entries["offset"][order].astype(np.int64)
    return offset, np.concatenate(channels)[order], entries["log_time"][order]


def _content_by_index(
    records: Bytes, offset: Ints, channel: Ints, log_time: Ints
) -> ChunkContent | None:
    """Return what the index names, or None if it does not describe the chunk truthfully."""
    if len(offset) and (
        offset[0] < 0
        or offset[-1] + MESSAGE_HEAD.itemsize > len(records)
        or (offset[1:] == offset[:-1]).any()
    ):
        return None
    head = (
        gather(records, offset, MESSAGE_HEAD.itemsize).view(MESSAGE_HEAD)
        if len(offset)
        else (np.empty(0, MESSAGE_HEAD))
    )
    if not (
        (head["opcode"] == Opcode.MESSAGE).all()
        and (head["channel"] == channel).all()
        and (head["log_time"] == log_time).all()
        and (head["length"] <= len(records)).all()
    ):
        return None
    end = offset + RECORD_HEAD.size + head["length"].astype(np.int64)
    others = _between(records, offset, end)
    return None if others is None else ChunkContent(_messages(head, offset, end), others)


def _between(records: Bytes, start: Ints, end: Ints) -> tuple[tuple[int, int, int], ...] | None:
    """Return the records between the messages, or None if messages or rubbish are among them."""
    gap_start = np.concatenate([[0], end])
    gap_end = np.concatenate([start, [len(records)]])
    others: list[tuple[int, int, int]] = []
    for gap in np.flatnonzero(gap_start != gap_end):
        walked = _walk(records, int(gap_start[gap]), int(gap_end[gap]))
        if walked.stopped_at is not None or walked.offsets:
            return None
        others.extend(walked.others)
    return tuple(others)


def _walk(records: Bytes, start: int, end: int) -> _Walked:
    """Follow the records one by one; stop at the first that does not fit."""
    walked = _Walked()
    data = records.data
    place = start
    while place < end:
        if place + RECORD_HEAD.size > end:
            walked.stopped_at = place
            break
        opcode, length = RECORD_HEAD.unpack_from(data, place)
        content = place + RECORD_HEAD.size
        is_message = opcode == Opcode.MESSAGE
        if not opcode or length > end - content or (is_message and length < 22):
            walked.stopped_at = place
            break
        if is_message:
            walked.offsets.append(place)
        else:
            walked.others.append((opcode, content, content + length))
        place = content + length
    return walked


def _messages_at(records: Bytes, offset: Ints) -> Messages:
    if not len(offset):
        return no_messages()
    head = gather(records, offset, MESSAGE_HEAD.itemsize).view(MESSAGE_HEAD)
    return _messages(head, offset, offset + RECORD_HEAD.size + head["length"].astype(np.int64))


def _messages(head: NDArray[np.void], offset: Ints, end: Ints) -> Messages:
    return Messages(
        channel=head["channel"].astype(np.int64),
        log_time=head["log_time"].astype(np.int64),
        publish_time=head["publish_time"].astype(np.int64),
        sequence=head["sequence"].astype(np.int64),
        start=offset + MESSAGE_HEAD.itemsize,
        end=end,
    )
