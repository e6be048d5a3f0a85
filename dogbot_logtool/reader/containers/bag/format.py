"""How ROS 1 bags write records: messages by their columns, and the search for sound records."""

import re
from collections.abc import Iterator
from typing import Final

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.arrays import Bytes, Flags, Ints
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.reader.containers.bag.records import (
    U32,
    BagOp,
    MalformedRecord,
    Record,
    record_at,
    record_in_file,
)
from dogbot_logtool.reader.containers.chunks.records import Readable, Records, blank_messages
from dogbot_logtool.reader.decode.columns import gather, gather_bytes, rows_like
from dogbot_logtool.reader.decode.message_table import Messages

INDEX_ENTRY_SIZE: Final = 12
_IN_CHUNK: Final = (BagOp.MESSAGE, BagOp.CONNECTION)
_MOST_TEMPLATES: Final = 8
"""Recorders write all their message headers alike; more kinds are decoded one by one."""
_RECORD_START: Final = (
    rb"(?s)(?=[\x08-\xff].\0\0.\0\0\0"
    rb"(?:op|conn|time|topic|compression|size|ver|count|chunk_pos|chunk_count|conn_count|"
    rb"index_pos|start_time|end_time)=)"
)
"""A header of plausible length that begins with a known field."""
_LONGEST_HEADER: Final = 4096


class BagFormat:
    """How bags write records; see `RecordFormat`."""

    message = int(BagOp.MESSAGE)

    def __init__(self) -> None:
        self._usual: _Template | None = None
        """The header of the messages that were found last."""

    def chain(self, data: memoryview, offset: int, end: int, limit: int) -> list[int]:
        """See `RecordFormat.chain`."""
        bounds = [offset]
        unpack = U32.unpack_from
        while offset + 8 <= end and limit:
            header_end = offset + 4 + unpack(data, offset)[0]
            if header_end + 4 > end:
                break
            offset = header_end + 4 + unpack(data, header_end)[0]
            if offset > end:
                break
            bounds.append(offset)
            limit -= 1
        return bounds

    def decode(self, records: Bytes, bounds: Ints) -> Records:
        """See `RecordFormat.decode`."""
        offset, end = bounds[:-1], bounds[1:]
        found = Records(
            np.zeros(len(offset), np.int64),
            offset,
            blank_messages(np.zeros(len(offset), np.int64), end),
        )
        header_size = gather(records, offset, 4).view("<u4").astype(np.int64)
        left = np.arange(len(offset))
        templates = 0
        while len(left):
            template = _decode_one(records, found, int(left[0]))
            left = left[1:]
            if template is None or not len(left) or templates == _MOST_TEMPLATES:
                continue
            templates += 1
            _fill(found, left[header_size[left] == template.size], records, template)
            left = left[found.op[left] == 0]
        return found

    def heads(self, records: Bytes, offset: Ints) -> Records | None:
        """See `RecordFormat.heads`."""
        if offset[0] < 0:
            return None
        values = _values(records, offset, self._usual)
        if values is None:
            self._usual = _template(records, int(offset[0]))
            values = _values(records, offset, self._usual)
        if values is None:
            return None
        start = offset + values.itemsize
        end = start + values["data_size"]
        if end.max() > len(records):
            return None
        time = nanoseconds(values)
        channel = values["connection"].astype(np.int64)
        messages = Messages(channel, time, time, np.zeros(len(time), np.int64), start, end)
        return Records(np.full(len(offset), self.message, np.int64), offset, messages)

    def candidates(self, window: bytes) -> Iterator[int]:
        """See `RecordFormat.candidates`."""
        return (match.start() for match in re.finditer(_RECORD_START, window))

    def sound(self, source: Readable, offset: int, end: int) -> bool:
        """See `RecordFormat.sound`."""
        try:
            record = record_in_file(source, offset)
            op = record.fields.op()
            if record.end > end:
                return op == BagOp.CHUNK and bool(record.fields.raw("compression"))
            sound = is_sound(record, op)
        except MalformedRecord:
            return False
        return sound and _may_follow(source, record.end, end)

    def resembles(self, records: Bytes, before: int, offset: int, end: int) -> bool:
        """See `RecordFormat.resembles`."""
        size = 4 + int(U32.unpack_from(records.data, before)[0])
        here = records[offset : min(offset + size, end)]
        alike = np.count_nonzero(here == records[before : before + len(here)])
        return bool(2 * alike >= len(here) >= 8 or re.match(_RECORD_START, here.tobytes()))


def is_sound(record: Record, op: int) -> bool:
    """Tell whether a record has the fields of its kind, and its data the right size.

    Raises:
        MalformedRecord: a field is missing.
    """
    fields, size = record.fields, record.end - record.data
    match op:
        case BagOp.MESSAGE:
            fields.u32("conn")
            fields.time_ns("time")
        case BagOp.CONNECTION:
            fields.u32("conn")
            fields.raw("topic")
        case BagOp.CHUNK:
            fields.u32("size")
            fields.raw("compression")
        case BagOp.INDEX:
            fields.u32("conn")
            return size == fields.u32("count") * INDEX_ENTRY_SIZE
        case BagOp.CHUNK_INFO:
            fields.u64("chunk_pos")
            return size == fields.u32("count") * 8
        case BagOp.BAG_HEADER:
            fields.u64("index_pos")
        case _:
            return False
    return True


def _may_follow(source: Readable, offset: int, end: int) -> bool:
    """Tell whether a record's end leads to another record, or to one that is cut off."""
    if offset == end:
        return True
    try:
        record_in_file(source, offset).fields.op()
    except MalformedRecord:
        head = source.read(offset, 4)
        size = int.from_bytes(head, "little")
        return len(head) < 4 or (size <= _LONGEST_HEADER and offset + 8 + size > end)
    return True


@dataclass(frozen=True, slots=True)
class _Template:
    """A message header, of which one recorder writes all with the same fields in one order."""

    size: int
    """Bytes of the header."""
    head: Bytes
    """(8 + size,) the header between the lengths of header and data; zero where `constant` is."""
    constant: Bytes
    """(8 + size,) 0 for the bytes that differ from message to message, 255 for all others."""
    values: np.dtype[np.void]
    """Those that differ."""

    def matches(self, heads: Bytes) -> Flags:
        """Tell which rows, (n, 8 + size), are such a head."""
        return rows_like(heads & self.constant, self.head)


def _template(records: Bytes, offset: int) -> _Template | None:
    """Return a message's header as a template, None if there is no message."""
    try:
        record = record_at(records.data, offset, len(records))
    except MalformedRecord:
        return None
    return _template_of(records, offset, record)


def _values(records: Bytes, offset: Ints, template: _Template | None) -> NDArray[np.void] | None:
    """Return the values in the headers at some offsets, None if any is not like the template."""
    if template is None or offset[-1] + 8 + template.size > len(records):
        return None
    heads = gather_bytes(records, offset, 8 + template.size)
    return heads.view(template.values)[:, 0] if template.matches(heads).all() else None


def _template_of(records: Bytes, offset: int, record: Record) -> _Template | None:
    size = record.data - offset - 8
    head = records[offset : offset + 8 + size]
    try:
        if record.fields.op() != BagOp.MESSAGE or size > _LONGEST_HEADER:
            return None
        record.fields.u32("conn")
        record.fields.time_ns("time")
        connection, time = _value_offsets(head[:-4].tobytes())
    except (MalformedRecord, KeyError):
        return None
    values = np.dtype(
        {
            "names": ["connection", "seconds", "nanoseconds", "data_size"],
            "formats": ["<u4"] * 4,
            "offsets": [connection, time, time + 4, 4 + size],
            "itemsize": 8 + size,
        }
    )
    constant = np.full(8 + size, 255, np.uint8)
    for first in (connection, time, time + 4, 4 + size):
        constant[first : first + 4] = 0
    return _Template(size, head & constant, constant, values)


def _value_offsets(header: bytes) -> tuple[int, int]:
    """Return where connection and time stand in a sound header, which its length leads."""
    offsets: dict[bytes, int] = {}
    offset = 4
    while offset < len(header):
        (size,) = U32.unpack_from(header, offset)
        name = header[offset + 4 : offset + 4 + size].partition(b"=")[0]
        offsets[name] = offset + 4 + len(name) + 1
        offset += 4 + size
    return offsets[b"conn"], offsets[b"time"]


def _fill(found: Records, rows: Ints, records: Bytes, template: _Template) -> None:
    """Decode the messages among some rows, whose headers have the template's length."""
    if not len(rows):
        return
    heads = gather_bytes(records, found.offset[rows], 8 + template.size)
    alike = template.matches(heads)
    rows, values = rows[alike], heads.view(template.values)[alike, 0]
    found.op[rows] = BagOp.MESSAGE
    found.messages.channel[rows] = values["connection"]
    found.messages.log_time[rows] = nanoseconds(values)
    found.messages.publish_time[rows] = found.messages.log_time[rows]
    found.messages.start[rows] = found.offset[rows] + 8 + template.size


def nanoseconds(times: NDArray[np.void]) -> Ints:
    """Return (n,) ns from the columns ``seconds`` and ``nanoseconds``."""
    seconds = times["seconds"].astype(np.int64)
    total: Ints = seconds * 1_000_000_000 + times["nanoseconds"]
    return total


def _decode_one(records: Bytes, found: Records, row: int) -> _Template | None:
    """Decode one record of any kind; return its header if it may serve as a template."""
    offset = int(found.offset[row])
    try:
        record = record_at(records.data, offset, int(found.messages.end[row]))
        op = record.fields.op()
    except MalformedRecord:
        return None
    if op not in _IN_CHUNK:
        return None
    found.messages.start[row] = record.data
    if op == BagOp.CONNECTION:
        found.op[row] = op
        return None
    template = _template_of(records, offset, record)
    if template is not None:
        _fill(found, np.array([row]), records, template)
    return template
