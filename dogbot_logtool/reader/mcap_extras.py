"""Attachments and metadata records of an MCAP, to be copied as they are."""

import struct
import zlib
from io import BytesIO

from mcap import records
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode

from dogbot_logtool.reader.log import Extra
from dogbot_logtool.reader.source import ByteSource

_HEAD_SIZE = 9
_MALFORMED = (McapError, struct.error, UnicodeDecodeError, ValueError, OverflowError)


def read_extra(
    source: ByteSource, extra: Extra
) -> tuple[bytes, records.Attachment | records.Metadata] | None:
    """Read a record that is no message.

    Returns:
        its bytes as they stand, and decoded; None if it is damaged.
    """
    record = source.read(extra.offset, extra.size)
    body = ReadDataStream(BytesIO(record[_HEAD_SIZE:]))
    try:
        if extra.opcode == Opcode.METADATA:
            metadata: records.Metadata = records.Metadata.read(body)
            return record, metadata
        attachment: records.Attachment = records.Attachment.read(body)
    except _MALFORMED:
        return None
    crc = int.from_bytes(record[-4:], "little")
    sound = crc in {0, zlib.crc32(record[_HEAD_SIZE:-4])}
    return (record, attachment) if sound else None
