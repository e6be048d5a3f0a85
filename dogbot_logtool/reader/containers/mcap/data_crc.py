"""The checksum over an MCAP file's whole data section."""

import struct
from typing import Final

from mcap.opcode import Opcode
from zlib_ng.zlib_ng import crc32

from dogbot_logtool.reader.containers.loss import Loss
from dogbot_logtool.reader.containers.mcap.records import RECORD_HEAD
from dogbot_logtool.reader.containers.sources.source import ByteSource

DATA_END_SIZE: Final = RECORD_HEAD.size + 4
_PIECE: Final = 1 << 20


def check_data(source: ByteSource, data_end: int, *, thorough: bool) -> Loss | None:
    """Verify the data section's checksum, if there is one.

    It covers what chunks' checksums do not: the header, messages outside chunks, attachments and
    metadata.

    Args:
        source: the file.
        data_end: where the DataEnd record begins.
        thorough: read a data section that is not cheap to read, too.
    """
    record = source.read(data_end, DATA_END_SIZE)
    if len(record) < DATA_END_SIZE or (data_end > source.cheap_size and not thorough):
        return None
    opcode, length = RECORD_HEAD.unpack_from(record)
    (expected,) = struct.unpack_from("<I", record, RECORD_HEAD.size)
    if opcode != Opcode.DATA_END or length < 4 or not expected:
        return None
    crc = 0
    for offset in range(0, data_end, _PIECE):
        crc = crc32(source.read(offset, min(_PIECE, data_end - offset)), crc)
    if crc == expected:
        return None
    return Loss(data_end, "the checksum over all of the log's data does not hold")
