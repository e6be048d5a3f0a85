"""Attachments and metadata records of an MCAP, to be copied as they are."""

from mcap import records
from mcap.opcode import Opcode
from zlib_ng.zlib_ng import crc32

from dogbot_logtool.reader.containers.contents import Extra
from dogbot_logtool.reader.containers.mcap.records import RECORD_HEAD, decode_record
from dogbot_logtool.reader.containers.sources.source import ByteSource


def read_extra(
    source: ByteSource, extra: Extra
) -> tuple[bytes, records.Attachment | records.Metadata] | None:
    """Read a record that is no message.

    Returns:
        its bytes as they stand, and decoded; None if it is damaged.
    """
    record = source.read(extra.offset, extra.size)
    body = record[RECORD_HEAD.size :]
    if extra.opcode == Opcode.METADATA:
        metadata = decode_record(records.Metadata, body)
        return None if metadata is None else (record, metadata)
    attachment = decode_record(records.Attachment, body, padding=0)
    crc = int.from_bytes(record[-4:], "little")
    sound = crc in {0, crc32(body[:-4])}
    return None if attachment is None or not sound else (record, attachment)
