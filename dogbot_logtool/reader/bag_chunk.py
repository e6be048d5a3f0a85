"""One chunk of a ROS 1 bag: its header, and the messages in it.

The messages are found through the index records behind the chunk, or by walking the chunk's
records. The index is only a hint: it is believed when every record that it names is what it says
and the records tile the chunk, so that nothing is missing.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Final

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.reader.bag_records import (
    U32,
    BagOp,
    Fields,
    MalformedRecord,
    record_at,
    record_in_file,
)
from dogbot_logtool.reader.columns import Bytes, gather, gather_bytes
from dogbot_logtool.reader.compression import check_claimed_size, decompress_into
from dogbot_logtool.reader.log import Chunk, ChunkContent, ChunkDamage, Loss, Messages
from dogbot_logtool.reader.source import ByteSource

INDEX_ENTRY: Final = np.dtype([("seconds", "<u4"), ("nanoseconds", "<u4"), ("offset", "<u4")])
UNKNOWN_CHANNEL: Final = -1
"""Channel of messages whose connection is nowhere described."""
ChannelOf = Callable[[int], int]
"""Turns a connection number into a channel id."""


def chunk_at(source: ByteSource, place: int) -> Chunk:
    """Read a chunk record's header.

    Raises:
        ChunkDamage: there is no chunk.
    """
    try:
        record = record_in_file(source, place)
        if record.fields.op() != BagOp.CHUNK:
            raise ChunkDamage("the index says that it begins there, but it does not")
        return Chunk(
            offset=place,
            data_offset=record.data,
            data_size=record.end - record.data,
            end=record.end,
            index_end=record.end,
            compression=record.fields.text("compression"),
            size=record.fields.u32("size"),
        )
    except MalformedRecord as fault:
        raise ChunkDamage(f"its header is damaged ({fault})") from fault


def check_bag_chunk(chunk: Chunk, file_size: int) -> None:
    """Check what a chunk claims.

    Raises:
        ChunkDamage: it cannot be honest.
    """
    check_claimed_size(chunk.size, chunk.data_size)
    if chunk.end > file_size:
        raise ChunkDamage("it reaches beyond the end of the file")


def parse_bag_chunk(
    chunk: Chunk, stored: memoryview, target: Bytes, channel_of: ChannelOf
) -> ChunkContent:
    """Decompress a chunk and find its messages.

    Raises:
        ChunkDamage: nothing in it can be trusted.
    """
    data = stored[chunk.data_offset - chunk.offset :][: chunk.data_size]
    decompress_into(target, data, chunk.compression)
    return _content(target, stored[chunk.end - chunk.offset :], chunk.offset, channel_of)


def _content(records: Bytes, index: memoryview, offset: int, channel_of: ChannelOf) -> ChunkContent:
    """Find the messages of a chunk.

    Args:
        records: (n,) uint8, the decompressed chunk.
        index: the file's bytes behind the chunk, which hold its index records if there are any.
        offset: of the chunk in the file, for saying where damage is.
        channel_of: turns the bag's connection numbers into channel ids.
    """
    hint = _indexed_messages(index)
    if hint is not None:
        content = _content_by_index(records, hint, channel_of)
        if content is not None:
            return content
    walked = _walk(records, 0, len(records))
    losses: list[Loss] = []
    if walked.stopped_at is not None:
        lost = len(records) - walked.stopped_at
        what = f"the chunk at byte {offset} holds {lost} bytes that are no record"
        losses.append(Loss(offset, what, lost, None))
    elif hint is not None:
        what = f"the index of the chunk at byte {offset} is wrong; it was read without"
        losses.append(Loss(offset, what))
    messages = _messages(
        np.array(walked.connection, np.int64),
        np.array(walked.log_time, np.int64),
        np.array(walked.start, np.int64),
        np.array(walked.end, np.int64),
        channel_of,
    )
    return ChunkContent(messages, tuple(walked.others), tuple(losses))


@dataclass(frozen=True, slots=True)
class _Indexed:
    """What index records say of messages, in the order of the chunk."""

    offset: Ints
    connection: Ints
    log_time: Ints


def _indexed_messages(index: memoryview) -> _Indexed | None:
    parts: list[NDArray[np.void]] = []
    connections: list[Ints] = []
    place = 0
    while place < len(index):
        try:
            record = record_at(index, place, len(index))
            if record.fields.op() != BagOp.INDEX:
                break
            connection, count = record.fields.u32("conn"), record.fields.u32("count")
        except MalformedRecord:
            break
        if record.end - record.data != count * INDEX_ENTRY.itemsize:
            return None
        parts.append(np.frombuffer(index[record.data : record.end], INDEX_ENTRY))
        connections.append(np.full(count, connection, np.int64))
        place = record.end
    if not parts:
        return None
    entries = np.concatenate(parts)
    order = np.argsort(entries["offset"], kind="stable")
    entries = entries[order]
    return _Indexed(
        entries["offset"].astype(np.int64),
        np.concatenate(connections)[order],
        _nanoseconds(entries),
    )


def _nanoseconds(times: NDArray[np.void]) -> Ints:
    seconds = times["seconds"].astype(np.int64)
    nanoseconds: Ints = seconds * 1_000_000_000 + times["nanoseconds"]
    return nanoseconds


def _content_by_index(records: Bytes, hint: _Indexed, channel_of: ChannelOf) -> ChunkContent | None:
    """Return what the index names, or None if it does not describe the chunk truthfully."""
    offset = hint.offset
    found = _message_records(records, offset)
    if found is None:
        return None
    connection, log_time, start, end = found
    if (connection != hint.connection).any() or (log_time != hint.log_time).any():
        return None
    others = _between(records, offset, end)
    if others is None:
        return None
    messages = _messages(connection, log_time, start, end, channel_of)
    return ChunkContent(messages, others)


def _message_records(records: Bytes, offset: Ints) -> tuple[Ints, Ints, Ints, Ints] | None:
    """Decode message records: connection, log time, first and last byte of the payload.

    One recorder writes all its headers with the same fields in the same order, so the first one
    serves as a template. None if any record is not like it.
    """
    size = len(records)
    if not len(offset) or offset[0] < 0 or offset[-1] + 4 > size:
        return None
    header_size = int(U32.unpack_from(records.data, int(offset[0]))[0])
    if offset[-1] + 8 + header_size > size:
        return None
    template = _header_template(records, int(offset[0]) + 4, header_size)
    if template is None:
        return None
    places, constant = template
    if not len(offset):
        return None
    length = gather(records, offset, 4).view("<u4")
    header = gather_bytes(records, offset + 4, header_size)
    if (length != header_size).any() or (header[:, constant] != header[0, constant]).any():
        return None
    values = header.view(places).reshape(-1)
    start = offset + 8 + header_size
    end = start + gather(records, start - 4, 4).view("<u4").astype(np.int64)
    if end.max() > size:
        return None
    return values["connection"].astype(np.int64), _nanoseconds(values), start, end


def _header_template(
    records: Bytes, start: int, size: int
) -> tuple[np.dtype[np.void], NDArray[np.bool_]] | None:
    """Return where a message header's values stand, and which of its bytes are constant."""
    header = records[start : start + size].tobytes()
    try:
        fields = Fields(header)
        if fields.op() != BagOp.MESSAGE or len(fields.raw("conn")) != 4:
            return None
        fields.time_ns("time")
    except MalformedRecord:
        return None
    places = {name: _field_place(header, name) for name in (b"conn=", b"time=")}
    constant = np.ones(size, np.bool_)
    constant[places[b"conn="] : places[b"conn="] + 4] = False
    constant[places[b"time="] : places[b"time="] + 8] = False
    dtype = np.dtype(
        {
            "names": ["connection", "seconds", "nanoseconds"],
            "formats": ["<u4", "<u4", "<u4"],
            "offsets": [places[b"conn="], places[b"time="], places[b"time="] + 4],
            "itemsize": size,
        }
    )
    return dtype, constant


def _field_place(header: bytes, name: bytes) -> int:
    """Return where the value of a field that is known to be there begins."""
    place = 0
    while not header.startswith(name, place + 4):
        place += 4 + int(U32.unpack_from(header, place)[0])
    return place + 4 + len(name)


def _between(records: Bytes, start: Ints, end: Ints) -> tuple[tuple[int, int, int], ...] | None:
    """Return the records between the messages, or None if messages or rubbish are among them."""
    gap_start = np.concatenate([[0], end])
    gap_end = np.concatenate([start, [len(records)]])
    others: list[tuple[int, int, int]] = []
    for gap in np.flatnonzero(gap_start != gap_end):
        walked = _walk(records, int(gap_start[gap]), int(gap_end[gap]))
        if walked.stopped_at is not None or walked.start:
            return None
        others.extend(walked.others)
    return tuple(others)


@dataclass(slots=True)
class _Walked:
    connection: list[int] = field(default_factory=list)
    log_time: list[int] = field(default_factory=list)
    start: list[int] = field(default_factory=list)
    end: list[int] = field(default_factory=list)
    others: list[tuple[int, int, int]] = field(default_factory=list)
    stopped_at: int | None = None


def _walk(records: Bytes, start: int, end: int) -> _Walked:
    """Follow the records one by one; stop at the first that does not fit."""
    walked = _Walked()
    data = records.data
    place = start
    while place < end:
        try:
            record = record_at(data, place, end)
            op = record.fields.op()
            if op == BagOp.MESSAGE:
                connection, time = record.fields.u32("conn"), record.fields.time_ns("time")
                walked.connection.append(connection)
                walked.log_time.append(time)
                walked.start.append(record.data)
                walked.end.append(record.end)
            else:
                walked.others.append((op, place, record.end))
        except MalformedRecord:
            walked.stopped_at = place
            break
        place = record.end
    return walked


def _messages(
    connection: Ints, log_time: Ints, start: Ints, end: Ints, channel_of: ChannelOf
) -> Messages:
    numbers, code = np.unique(connection, return_inverse=True)
    channels = np.array([channel_of(int(number)) for number in numbers], np.int64)
    return Messages(
        channel=channels[code],
        log_time=log_time,
        publish_time=log_time,
        sequence=np.zeros(len(log_time), np.int64),
        start=start,
        end=end,
    )
