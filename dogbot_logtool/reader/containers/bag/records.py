"""The records of a ROS 1 bag (format 2.0): a header of named fields, then data.

Both are led by their length as a 32-bit number; a header's fields are ``name=value``, each led by
its length.
"""

import re
import struct
from collections.abc import Mapping
from enum import IntEnum
from typing import Final, TypeVar

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.arrays import Bytes, Ints
from dogbot_logtool.reader.containers.salvage import Read, Records
from dogbot_logtool.reader.decode.columns import gather, gather_bytes, rows_like

AnyNumber = TypeVar("AnyNumber", int, Ints)

U32: Final = struct.Struct("<I")
_MAX_HEADER_SIZE: Final = 1 << 20
HEAD_SIZE: Final = 512
"""Bytes that hold nearly every record's header."""
INDEX_ENTRY_SIZE: Final = 12
_MOST_FORMS: Final = 8
"""Recorders write all their message headers alike; more kinds are decoded one by one."""
_LONGEST_HEADER: Final = 4096
_LENGTHS: Final = 8
"""Bytes of the lengths of a record's header and data."""


class BagOp(IntEnum):
    """Kinds of records."""

    MESSAGE = 0x02
    BAG_HEADER = 0x03
    INDEX = 0x04
    CHUNK = 0x05
    CHUNK_INFO = 0x06
    CONNECTION = 0x07


_ENTRY_SIZES: Final[Mapping[int, int]] = {BagOp.INDEX: INDEX_ENTRY_SIZE, BagOp.CHUNK_INFO: 8}
_FIELDS: Final[Mapping[int, Mapping[str, int | None]]] = {
    BagOp.MESSAGE: {"conn": 4, "time": 8},
    BagOp.CONNECTION: {"conn": 4, "topic": None},
    BagOp.CHUNK: {"size": 4, "compression": None},
    BagOp.INDEX: {"conn": 4},
    BagOp.CHUNK_INFO: {"chunk_pos": 8},
    BagOp.BAG_HEADER: {"index_pos": 8},
}
"""Fields that the headers of records must have, and their sizes in bytes; None: any."""


def channel_id(connection: AnyNumber) -> AnyNumber:
    """Return the id of a connection's channel: they are numbered from 1 on."""
    return connection + 1


class MalformedRecord(Exception):  # noqa: N818 - it never reaches a user
    """Bytes that are no record."""


def header_fields(data: bytes | memoryview) -> dict[str, tuple[int, bytes]]:
    """Return where the value of each field of a header begins, and the value.

    Raises:
        MalformedRecord: it is no list of fields.
    """
    found: dict[str, tuple[int, bytes]] = {}
    data = bytes(data)
    offset = 0
    while offset < len(data):
        if offset + 4 > len(data):
            raise MalformedRecord
        (size,) = U32.unpack_from(data, offset)
        field = data[offset + 4 : offset + 4 + size]
        name, equals, value = field.partition(b"=")
        if len(field) != size or not equals:
            raise MalformedRecord
        offset += 4 + size
        found[name.decode("utf-8", "replace")] = offset - len(value), value
    return found


class Record:
    """A record's header; what is asked for and not there, or not as long, is malformed."""

    def __init__(self, header: bytes | memoryview, data: int, end: int) -> None:
        """Split the header.

        Args:
            header: its bytes.
            data: first byte of the data.
            end: first byte after the record.

        Raises:
            MalformedRecord: it is no list of fields.
        """
        self.fields = header_fields(header)
        self.data = data
        self.end = end

    def raw(self, name: str, size: int | None = None) -> bytes:
        """Return a field, of a size in bytes if that is given.

        Raises:
            MalformedRecord: there is none of the name, or of another size.
        """
        _, value = self.fields.get(name, (0, None))
        if value is None or size not in {None, len(value)}:
            raise MalformedRecord
        return value

    def number(self, name: str, size: int = 4) -> int:
        """Return a number of some bytes."""
        return int.from_bytes(self.raw(name, size), "little")

    def op(self) -> int:
        """Return the kind of the record."""
        return self.number("op", 1)

    def time_ns(self, name: str) -> int:
        """Return a time, ns."""
        nanoseconds, seconds = divmod(self.number(name, 8), 1 << 32)
        return seconds * 1_000_000_000 + nanoseconds

    def is_sound(self) -> bool:
        """Tell whether it has the fields of its kind, and its data the right size.

        Raises:
            MalformedRecord: a field is missing.
        """
        op = self.op()
        for name, size in _FIELDS.get(op, {}).items():
            self.raw(name, size)
        if op in _ENTRY_SIZES:
            return self.end - self.data == self.number("count") * _ENTRY_SIZES[op]
        return op in _FIELDS


def record_in_file(read: Read, offset: int, head: bytes = b"") -> Record:
    """Read the header of a record; its data may reach beyond the file's end.

    Args:
        read: reads the file.
        offset: where the record begins.
        head: its first bytes, if they have been read.

    Raises:
        MalformedRecord: there is no record's header.
    """
    head = head or read(offset, HEAD_SIZE)
    header_size = U32.unpack_from(head)[0] if len(head) >= 4 else 0
    if header_size > _MAX_HEADER_SIZE:
        raise MalformedRecord
    if len(head) < 8 + header_size:
        head = read(offset, 8 + header_size)
    if len(head) < 8 + header_size:
        raise MalformedRecord
    (data_size,) = U32.unpack_from(head, 4 + header_size)
    data = offset + 8 + header_size
    return Record(memoryview(head)[4 : 4 + header_size], data, data + data_size)


def record_at(data: bytes | memoryview, offset: int) -> Record:
    """Read the header of a record in memory.

    Raises:
        MalformedRecord: there is no whole record.
    """
    record = record_in_file(lambda start, size: bytes(data[start : start + size]), offset)
    if record.end > len(data):
        raise MalformedRecord
    return record


class BagFormat:
    """How bags write records; see `RecordFormat`."""

    message = int(BagOp.MESSAGE)
    describing = frozenset({int(BagOp.CONNECTION)})
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
        found = Records(*np.zeros((8, len(offset)), np.int64))
        found.offset[:] = offset
        left = np.flatnonzero((offset >= 0) & (offset + _LENGTHS <= len(records)))
        header_size = np.zeros(len(offset), np.int64)
        header_size[left] = gather(records, offset[left], 4).view("<u4") if len(left) else 0
        forms = 0
        while len(left):
            rows, left = left[:1], left[1:]
            first = int(offset[rows[0]])
            try:
                record = record_at(records.data, first)
                op = record.op()
                is_message = op == BagOp.MESSAGE and record.is_sound()
            except MalformedRecord:
                continue
            found.start[rows], found.end[rows] = record.data, record.end
            size = record.data - first
            if op == BagOp.CONNECTION:
                found.op[rows] = op
            if not is_message or size > _LONGEST_HEADER:
                continue
            forms += 1
            if forms <= _MOST_FORMS:
                fits = offset[left] + size <= len(records)
                rows = np.append(rows, left[fits & (header_size[left] == size - _LENGTHS)])
            heads = gather_bytes(records, offset[rows], size)
            form, constant = _form(record, size)
            alike = rows_like(heads & constant, heads[0] & constant)
            rows, values = rows[alike], heads.view(form)[alike, 0]
            start = offset[rows] + size
            found.start[rows], found.end[rows] = start, start + values["data_size"]
            found.channel[rows] = channel_id(values["connection"].astype(np.int64))
            found.log_time[rows] = found.publish_time[rows] = nanoseconds(values)
            found.op[rows] = np.where(found.end[rows] <= len(records), op, 0)
            if len(rows) > 1:
                left = left[found.end[left] == 0]
        return found

    def sound(self, read: Read, offset: int, end: int) -> bool:
        """See `RecordFormat.sound`."""
        try:
            record = record_in_file(read, offset)
            if record.end > end:
                is_chunk = record.op() == BagOp.CHUNK
                return is_chunk and bool(record.raw("compression"))
            return record.is_sound()
        except MalformedRecord:
            return False


def _form(message: Record, size: int) -> tuple[np.dtype[np.void], Bytes]:
    """Return how a recorder writes the headers of messages, all with the same fields in one order.

    Args:
        message: one of them.
        size: bytes of its header and both lengths.

    Returns:
        the values that differ from message to message; and a mask of the other bytes, (size,).
    """
    (connection, _), (time, _) = message.fields["conn"], message.fields["time"]
    offsets = [4 + connection, 4 + time, 8 + time, size - 4]
    names = ["connection", "seconds", "nanoseconds", "data_size"]
    constant = np.full(size, 255, np.uint8)
    for first in offsets:
        constant[first : first + 4] = 0
    form = np.dtype({"names": names, "formats": ["<u4"] * 4, "offsets": offsets, "itemsize": size})
    return form, constant


def nanoseconds(times: NDArray[np.void]) -> Ints:
    """Return (n,) ns from the columns ``seconds`` and ``nanoseconds``."""
    seconds = times["seconds"].astype(np.int64)
    total: Ints = seconds * 1_000_000_000 + times["nanoseconds"]
    return total
