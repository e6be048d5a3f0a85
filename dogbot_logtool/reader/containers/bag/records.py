"""The records of a ROS 1 bag (format 2.0): a header of named fields, then data.

Both are led by their length as a 32-bit number; a header's fields are ``name=value``, each led by
its length.
"""

import struct
from collections.abc import Mapping
from enum import IntEnum
from typing import Final

from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.reader.containers.chunks.records import Readable
from dogbot_logtool.reader.containers.contents import Channel, Schema

U32: Final = struct.Struct("<I")
_TIME: Final = struct.Struct("<II")
MAX_HEADER_SIZE: Final = 1 << 20
HEAD_SIZE: Final = 512
"""Bytes that hold nearly every record's header."""


class BagOp(IntEnum):
    """Kinds of records."""

    MESSAGE = 0x02
    BAG_HEADER = 0x03
    INDEX = 0x04
    CHUNK = 0x05
    CHUNK_INFO = 0x06
    CONNECTION = 0x07


class MalformedRecord(Exception):  # noqa: N818 - it never reaches a user
    """Bytes that are no record."""


class Fields:
    """The header of a record."""

    def __init__(self, data: bytes | memoryview) -> None:
        """Split a header.

        Raises:
            MalformedRecord: it is no list of fields.
        """
        self._values: dict[bytes, bytes] = {}
        data = bytes(data)
        offset = 0
        while offset < len(data):
            if offset + 4 > len(data):
                raise MalformedRecord("a header field is cut off")
            (size,) = U32.unpack_from(data, offset)
            field = data[offset + 4 : offset + 4 + size]
            name, equals, value = field.partition(b"=")
            if len(field) != size or not equals:
                raise MalformedRecord("a header field is damaged")
            self._values[name] = value
            offset += 4 + size

    def op(self) -> int:
        """Return the kind of the record."""
        value = self.raw("op")
        if len(value) != 1:
            raise MalformedRecord("a record's kind is damaged")
        return value[0]

    def has(self, name: str) -> bool:
        """Tell whether there is a field of the name."""
        return name.encode() in self._values

    def raw(self, name: str) -> bytes:
        """Return a field.

        Raises:
            MalformedRecord: there is none of the name.
        """
        value = self._values.get(name.encode())
        if value is None:
            raise MalformedRecord(f"the header field {name!r} is missing")
        return value

    def u32(self, name: str) -> int:
        """Return a 32-bit number."""
        return int.from_bytes(self._sized(name, 4), "little")

    def u64(self, name: str) -> int:
        """Return a 64-bit number."""
        return int.from_bytes(self._sized(name, 8), "little")

    def time_ns(self, name: str) -> int:
        """Return a time, ns."""
        seconds, nanoseconds = _TIME.unpack(self._sized(name, 8))
        return int(seconds) * 1_000_000_000 + int(nanoseconds)

    def text(self, name: str) -> str:
        """Return a text; bytes that are not UTF-8 are replaced."""
        return self.raw(name).decode("utf-8", "replace")

    def texts(self) -> Mapping[str, str]:
        """Return all fields as texts."""
        return {
            name.decode("utf-8", "replace"): value.decode("utf-8", "replace")
            for name, value in self._values.items()
        }

    def _sized(self, name: str, size: int) -> bytes:
        value = self.raw(name)
        if len(value) != size:
            raise MalformedRecord(f"the header field {name!r} has a wrong size")
        return value


@dataclass(frozen=True, slots=True)
class Record:
    """A record's header and the offset of its data."""

    fields: Fields
    data: int
    """First byte of the data."""
    end: int
    """First byte after the record."""


def record_bounds(data: bytes | memoryview, offset: int, end: int) -> tuple[int, int]:
    """Return where a record in memory has the end of its header, and its own.

    Args:
        data: bytes that hold it.
        offset: where it begins.
        end: where it must end at the latest.

    Raises:
        MalformedRecord: there is no whole record.
    """
    if offset + 4 > end:
        raise MalformedRecord("a record is cut off")
    (header_size,) = U32.unpack_from(data, offset)
    header_end = offset + 4 + header_size
    if header_end + 4 > end:
        raise MalformedRecord("a record is cut off")
    (data_size,) = U32.unpack_from(data, header_end)
    record_end = header_end + 4 + data_size
    if record_end > end:
        raise MalformedRecord("a record is cut off")
    return header_end, record_end


def record_at(data: bytes | memoryview, offset: int, end: int) -> Record:
    """Read the header of a record in memory; arguments and errors are those of `record_bounds`."""
    header_end, record_end = record_bounds(data, offset, end)
    return Record(Fields(data[offset + 4 : header_end]), header_end + 4, record_end)


def record_in_file(source: Readable, offset: int) -> Record:
    """Read the header of a record in the file; its data may reach beyond the file's end.

    Raises:
        MalformedRecord: there is no record's header.
    """
    head = source.read(offset, HEAD_SIZE)
    if len(head) < 4:
        raise MalformedRecord("a record is cut off")
    (header_size,) = U32.unpack_from(head)
    if header_size > MAX_HEADER_SIZE:
        raise MalformedRecord("a header is absurdly long")
    if len(head) < 8 + header_size:
        head = source.read(offset, 8 + header_size)
        if len(head) < 8 + header_size:
            raise MalformedRecord("a record is cut off")
    (data_size,) = U32.unpack_from(head, 4 + header_size)
    data = offset + 8 + header_size
    return Record(Fields(memoryview(head)[4 : 4 + header_size]), data, data + data_size)


def connection_channel(
    number: int, fields: Fields, data: bytes | memoryview, schemas: dict[tuple[str, str], Schema]
) -> Channel:
    """Build a channel from a connection record.

    Args:
        number: the channel's id.
        fields: the record's header.
        data: the record's data: the header that the publisher sent when it connected.
        schemas: those met so far, by type and definition; a new one is added.

    Raises:
        MalformedRecord: type or definition are missing.
    """
    sent = Fields(data)
    texts = dict(sent.texts())
    name, definition = texts.pop("type", ""), texts.pop("message_definition", "")
    if not name:
        raise MalformedRecord("a connection has no type")
    texts.pop("topic", None)
    # The topic of the record is the one under which it was recorded, after any remapping.
    new = Schema(len(schemas) + 1, name, "ros1msg", definition.encode())
    schema = schemas.setdefault((name, definition), new)
    return Channel(number, fields.text("topic"), "ros1", schema, texts)
