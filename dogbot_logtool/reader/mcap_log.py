"""MCAP files: opened through their summary where there is a sound one, else by a walk."""

from dataclasses import replace

from mcap import records
from mcap.opcode import Opcode

from dogbot_logtool.errors import LogError
from dogbot_logtool.reader.columns import Bytes
from dogbot_logtool.reader.log import Chunk, ChunkContent, Log
from dogbot_logtool.reader.mcap_chunk import check_chunk, parse_chunk
from dogbot_logtool.reader.mcap_records import MAGIC, RECORD_HEAD, decode_record
from dogbot_logtool.reader.mcap_summary import read_summary
from dogbot_logtool.reader.mcap_survey import Survey
from dogbot_logtool.reader.source import ByteSource


class McapLog(Log):
    """An MCAP file of any profile."""

    container = "MCAP"
    copies_chunks = True

    def check(self, chunk: Chunk) -> None:
        """See `Log.check`."""
        check_chunk(chunk, self.source.size)

    def parse(self, chunk: Chunk, stored: memoryview, target: Bytes) -> ChunkContent:
        """See `Log.parse`."""
        return parse_chunk(chunk, stored, target)


def open_mcap(source: ByteSource) -> McapLog:
    """Open an MCAP file whose magic has been seen.

    Raises:
        LogError: not even its header can be read.
    """
    profile = _read_header(source)
    contents, problem = read_summary(source)
    if contents is None:
        contents = Survey(source).contents(problem)
    return McapLog(source, replace(contents, profile=profile))


def _read_header(source: ByteSource) -> str:
    head = source.read(len(MAGIC), RECORD_HEAD.size)
    if len(head) == RECORD_HEAD.size:
        opcode, length = RECORD_HEAD.unpack(head)
        if opcode == Opcode.HEADER and length <= 1 << 20:
            body = source.read(len(MAGIC) + RECORD_HEAD.size, length)
            header = decode_record(records.Header, body) if len(body) == length else None
            if header is not None:
                return header.profile
    raise LogError(f"{source.path}: the MCAP header record is missing or damaged")
