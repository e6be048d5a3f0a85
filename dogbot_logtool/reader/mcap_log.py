"""MCAP files: opened through their summary where there is a sound one, else by a walk."""

from dataclasses import replace
from typing import Final

from mcap import records
from mcap.opcode import Opcode

from dogbot_logtool.core.arrays import Bytes
from dogbot_logtool.reader.log import Chunk, ChunkContent, Contents, Log, Loss
from dogbot_logtool.reader.mcap_chunk import check_chunk, parse_chunk
from dogbot_logtool.reader.mcap_format import McapFormat
from dogbot_logtool.reader.mcap_records import RECORD_HEAD, decode_record
from dogbot_logtool.reader.mcap_summary import read_summary
from dogbot_logtool.reader.mcap_survey import McapSurvey
from dogbot_logtool.reader.signatures import MCAP_MAGIC
from dogbot_logtool.reader.source import ByteSource

_LARGEST_HEADER: Final = 1 << 20


class McapLog(Log):
    """An MCAP file of any profile."""

    container = "MCAP"
    copies_chunks = True

    def __init__(self, source: ByteSource, contents: Contents) -> None:
        super().__init__(source, contents)
        self._format = McapFormat(contents.channels)

    def check(self, chunk: Chunk) -> None:
        """See `Log.check`."""
        check_chunk(chunk, self.source.size)

    def parse(self, chunk: Chunk, stored: memoryview, target: Bytes) -> ChunkContent:
        """See `Log.parse`."""
        return parse_chunk(chunk, stored, target, self._format)


def open_mcap(source: ByteSource) -> McapLog:
    """Open an MCAP file whose magic has been seen."""
    profile = _profile(source)
    contents, problem = read_summary(source)
    if contents is None:
        source = source.nearby()
        contents = McapSurvey(source).contents(problem)
    if profile is None:
        damage = Loss(
            len(MCAP_MAGIC), "the header is damaged, so that the log's profile is not known"
        )
        contents = replace(contents, losses=(damage, *contents.losses))
    return McapLog(source, replace(contents, profile=profile or ""))


def _profile(source: ByteSource) -> str | None:
    """Return the profile that the header names, None if there is no header to be read."""
    head = source.read(len(MCAP_MAGIC), RECORD_HEAD.size)
    if len(head) < RECORD_HEAD.size:
        return None
    opcode, length = RECORD_HEAD.unpack(head)
    if opcode != Opcode.HEADER or length > _LARGEST_HEADER:
        return None
    body = source.read(len(MCAP_MAGIC) + RECORD_HEAD.size, length)
    header = decode_record(records.Header, body) if len(body) == length else None
    return None if header is None else header.profile
