"""How ROS 1 bags write records: messages by their columns, and the search for sound records."""

import re
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.arrays import Bytes, Flags, Ints
from dogbot_logtool.reader.containers.bag.records import (
    U32,
    BagOp,
    MalformedRecord,
    Record,
    channel_id,
    record_at,
    record_in_file,
)
from dogbot_logtool.reader.containers.salvage.records import Readable, Records, blank_messages
from dogbot_logtool.reader.decode.columns import gather, gather_bytes, rows_like

_MOST_TEMPLATES: Final = 8
"""Recorders write all their message headers alike; more kinds are decoded one by one."""
_LONGEST_HEADER: Final = 4096
_LENGTHS: Final = 8
"""Bytes of the lengths of a record's header and data."""


class BagFormat:
    """How bags write records; see `RecordFormat`."""

    message = int(BagOp.MESSAGE)
    record_start = re.compile(
        rb"(?s)(?=[\x08-\xff].\0\0.\0\0\0"
        rb"(?:op|conn|time|topic|compression|size|ver|count|chunk_pos|chunk_count|conn_count|"
        rb"index_pos|start_time|end_time)=)"
    )
    """A header of plausible length that begins with a known field."""

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

    def decode(self, records: Bytes, offset: Ints) -> Records:
        """See `RecordFormat.decode`."""
        op = np.zeros(len(offset), np.int64)
        messages = blank_messages(offset)
        left = np.flatnonzero((offset >= 0) & (offset + _LENGTHS <= len(records)))
        header_size = np.zeros(len(offset), np.int64)
        header_size[left] = gather(records, offset[left], 4).view("<u4") if len(left) else 0
        templates = 0
        while len(left):
            rows, left = left[:1], left[1:]
            first = int(offset[rows[0]])
            try:
                record = record_at(records.data, first, len(records))
                op[rows] = BagOp.CONNECTION if record.fields.op() == BagOp.CONNECTION else 0
            except MalformedRecord:
                continue
            messages.start[rows], messages.end[rows] = record.data, record.end
            template = _template(records, first, record)
            if template is None:
                continue
            templates += 1
            if templates <= _MOST_TEMPLATES:
                fits = offset[left] + _LENGTHS + template.size <= len(records)
                rows = np.append(rows, left[fits & (header_size[left] == template.size)])
            alike, values = template.read(records, offset[rows])
            rows, values = rows[alike], values[alike]
            start = offset[rows] + values.itemsize
            messages.start[rows], messages.end[rows] = start, start + values["data_size"]
            messages.channel[rows] = channel_id(values["connection"].astype(np.int64))
            messages.log_time[rows] = messages.publish_time[rows] = nanoseconds(values)
            op[rows] = np.where(messages.end[rows] <= len(records), BagOp.MESSAGE, 0)
            if len(rows) > 1:
                left = left[messages.end[left] == 0]
        return Records(op, offset, messages)

    def sound(self, source: Readable, offset: int, end: int) -> bool:
        """See `RecordFormat.sound`."""
        try:
            record = record_in_file(source, offset)
            if record.end > end:
                is_chunk = record.fields.op() == BagOp.CHUNK
                return is_chunk and bool(record.fields.raw("compression"))
            return record.is_sound() and _may_follow(source, record.end, end)
        except MalformedRecord:
            return False


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


@dataclass(frozen=True, slots=True, eq=False, repr=False)
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

    def read(self, records: Bytes, offset: Ints) -> tuple[Flags, NDArray[np.void]]:
        """Tell which headers at some offsets, (n,), are like it, and return the values of each."""
        heads = gather_bytes(records, offset, 8 + self.size)
        return rows_like(heads & self.constant, self.head), heads.view(self.values)[:, 0]


def _template(records: Bytes, offset: int, record: Record) -> _Template | None:
    """Return a message's header as a template, None if it is another record or not sound."""
    size = record.data - offset - 8
    try:
        if record.fields.op() != BagOp.MESSAGE or size > _LONGEST_HEADER:
            return None
        record.is_sound()
    except MalformedRecord:
        return None
    connection, time = (4 + record.fields.offsets[name] for name in ("conn", "time"))
    places = (connection, time, time + 4, 4 + size)
    values = np.dtype(
        {
            "names": ["connection", "seconds", "nanoseconds", "data_size"],
            "formats": ["<u4"] * 4,
            "offsets": places,
            "itemsize": 8 + size,
        }
    )
    constant = np.full(8 + size, 255, np.uint8)
    for first in places:
        constant[first : first + 4] = 0
    return _Template(size, records[offset : offset + 8 + size] & constant, constant, values)


def nanoseconds(times: NDArray[np.void]) -> Ints:
    """Return (n,) ns from the columns ``seconds`` and ``nanoseconds``."""
    seconds = times["seconds"].astype(np.int64)
    total: Ints = seconds * 1_000_000_000 + times["nanoseconds"]
    return total
