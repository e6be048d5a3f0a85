"""MCAP files: opened through their summary where there is a sound one, else by a walk."""

from dataclasses import replace
from typing import Final

import numpy as np
from mcap import records
from mcap.opcode import Opcode

from dogbot_logtool.core.geometry.arrays import Bytes
from dogbot_logtool.reader.containers.channel_ids import UNKNOWN_CHANNEL
from dogbot_logtool.reader.containers.log import (
    Chunk,
    ChunkContent,
    ChunkDamage,
    Contents,
    Log,
    Loss,
)
from dogbot_logtool.reader.containers.mcap.chunk import check_chunk, chunk_at, parse_chunk
from dogbot_logtool.reader.containers.mcap.descriptions import DescriptionCheck
from dogbot_logtool.reader.containers.mcap.format import McapFormat
from dogbot_logtool.reader.containers.mcap.records import RECORD_HEAD, decode_record
from dogbot_logtool.reader.containers.mcap.summary import SUMMARY_CONTRADICTS, read_summary
from dogbot_logtool.reader.containers.signatures import MCAP_MAGIC
from dogbot_logtool.reader.containers.source import ByteSource
from dogbot_logtool.reader.salvage.mcap_survey import McapSurvey

_LARGEST_HEADER: Final = 1 << 20
_MOST_FIRST_CHUNKS: Final = 8
_LARGEST_FIRST_CHUNK: Final = 16 << 20
"""Chunks that are larger when decompressed are left to whoever reads the log."""


class McapLog(Log):
    """An MCAP file of any profile."""

    container = "MCAP"
    copies_chunks = True

    def __init__(self, source: ByteSource, contents: Contents) -> None:
        super().__init__(source, contents)
        self._format = McapFormat(contents.channels)
        self._descriptions = DescriptionCheck(contents.channels)

    def check(self, chunk: Chunk) -> None:
        """See `Log.check`."""
        check_chunk(chunk, self.source.size)

    def parse(self, chunk: Chunk, stored: memoryview, target: Bytes) -> ChunkContent:
        """See `Log.parse`."""
        content = parse_chunk(chunk, stored, target, self._format)
        if not len(content.others):
            return content
        found = self._descriptions.contradictions(target, content.others, chunk.offset)
        return replace(content, losses=(*content.losses, *found)) if found else content

    def _overlaps(self, chunk: Chunk, start: int | None, end: int | None) -> bool:
        """See `Log._overlaps`: a chunk is left out only if its own header says so, too.

        Headers in a store are not fetched for that.
        """
        if super()._overlaps(chunk, start, end):
            return True
        if chunk.surveyed or not self.source.has_cheap_seeks:
            return False
        try:
            own = chunk_at(self.source, chunk.offset)
        except ChunkDamage:
            return True
        return super()._overlaps(own, start, end)

    def contradicts_summary(self) -> bool:
        """Tell whether the first messages of a channel are described otherwise in their chunk.

        A channel is described before its first message, mostly in the same chunk.
        """
        chunks = self._first_chunks()
        places = [(chunk.offset, chunk.index_end - chunk.offset) for chunk in chunks]
        for chunk, stored in zip(chunks, self.source.read_many(places), strict=True):
            target = np.empty(chunk.size, np.uint8)
            try:
                self.check(chunk)
                content = parse_chunk(chunk, memoryview(stored), target, self._format)
            except ChunkDamage:
                continue
            if self._descriptions.contradictions(target, content.others, chunk.offset):
                return True
            if (self._channel_ids.of(content.messages.channel) == UNKNOWN_CHANNEL).any():
                return True
        return False

    def _first_chunks(self) -> list[Chunk]:
        """Return the chunks in which channels have their first messages, but not too many."""
        missing = {number for number, count in self.counts.items() if count}
        first: list[Chunk] = []
        for chunk in self.chunks:
            if not missing or len(first) == _MOST_FIRST_CHUNKS:
                break
            # Without an index, the first chunk is as good a guess as any.
            counts = dict.fromkeys(missing, 1) if chunk.counts is None else chunk.counts
            found = {number for number, count in counts.items() if count and number in missing}
            if found and chunk.size <= _LARGEST_FIRST_CHUNK:
                first.append(chunk)
            missing -= found
        return first


def open_mcap(source: ByteSource) -> McapLog:
    """Open an MCAP file whose magic has been seen."""
    profile = _profile(source)
    contents, problem = read_summary(source)
    if contents is not None and McapLog(source, contents).contradicts_summary():
        contents, problem = None, Loss(0, SUMMARY_CONTRADICTS)
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
