"""MCAP files."""

from dataclasses import replace
from typing import Final

import numpy as np
from mcap import records
from mcap.opcode import Opcode

from dogbot_logtool.core.arrays import Bytes
from dogbot_logtool.reader.containers.chunked_log import ChunkedLog
from dogbot_logtool.reader.containers.contents import UNKNOWN_CHANNEL, Chunk, Contents
from dogbot_logtool.reader.containers.loss import Loss
from dogbot_logtool.reader.containers.mcap.chunk import chunk_at
from dogbot_logtool.reader.containers.mcap.records import RECORD_HEAD, decode_record
from dogbot_logtool.reader.containers.mcap.scan import SUMMARY_CONTRADICTS, McapScan
from dogbot_logtool.reader.containers.salvage.content import ChunkContent, ChunkDamage
from dogbot_logtool.reader.containers.signatures import MCAP_MAGIC
from dogbot_logtool.reader.containers.sources.source import ByteSource

_LARGEST_HEADER: Final = 1 << 20
_MOST_FIRST_CHUNKS: Final = 8
_LARGEST_FIRST_CHUNK: Final = 16 << 20
"""Larger chunks, decompressed, are not read when a log is opened."""


class McapLog(ChunkedLog):
    """An MCAP file of any profile."""

    container = "MCAP"
    copies_chunks = True

    def __init__(self, source: ByteSource, contents: Contents, scan: McapScan) -> None:
        super().__init__(source, contents, scan)
        self._descriptions = scan.descriptions

    def parse(self, chunk: Chunk, stored: memoryview, target: Bytes) -> ChunkContent:
        """See `ChunkedLog.parse`."""
        content = self._scan.parse(chunk, stored, target)
        found = self._descriptions.contradictions_in(target, content.others, chunk.offset)
        return replace(content, losses=(*content.losses, *found)) if found else content

    def describes_hidden(self, content: ChunkContent, data: Bytes) -> bool:
        """See `ChunkedLog.describes_hidden`."""
        schemas = {c.schema.id for c in self.channels.values() if c.schema is not None}
        ids = {Opcode.CHANNEL: self.channels.keys(), Opcode.SCHEMA: schemas}
        return any(
            int.from_bytes(data[start + RECORD_HEAD.size :][:2].tobytes(), "little") not in ids[op]
            for op, start, _ in content.others.tolist()
            if op in ids
        )

    def by_own_header(self, chunk: Chunk) -> Chunk | None:
        """See `ChunkedLog.by_own_header`."""
        if chunk.is_scanned or not chunk.is_record:
            return None
        try:
            own = chunk_at(self.source, chunk.offset)
        except ChunkDamage:
            return None
        if own.end != chunk.end or own.data_offset + own.data_size != own.end:
            return None
        corrected = replace(
            chunk,
            data_offset=own.data_offset,
            data_size=own.data_size,
            compression=own.compression,
            size=own.size,
        )
        return corrected if corrected != chunk else None

    def own_times(self, chunk: Chunk) -> tuple[int | None, int | None] | None:
        """See `ChunkedLog.own_times`: those of its header."""
        try:
            own = chunk_at(self.source, chunk.offset)
        except ChunkDamage:
            return None
        return own.start_time, own.end_time

    def contradicts_summary(self) -> bool:
        """Tell whether the first messages of a channel are described otherwise in their chunk.

        A channel is described before its first message, mostly in the same chunk.
        """
        chunks = self._first_chunks()
        ranges = [(chunk.offset, chunk.index_end - chunk.offset) for chunk in chunks]
        for chunk, stored in zip(chunks, self.source.read_many(ranges), strict=True):
            target = np.empty(chunk.size, np.uint8)
            try:
                self._scan.check(chunk)
                content = self._scan.parse(chunk, memoryview(stored), target)
            except ChunkDamage:
                continue
            if self._descriptions.contradictions_in(target, content.others, chunk.offset):
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
            # Without an index, the first chunk may hold messages of any channel.
            counts = dict.fromkeys(missing, 1) if chunk.counts is None else chunk.counts
            found = {number for number, count in counts.items() if count and number in missing}
            if found and chunk.size <= _LARGEST_FIRST_CHUNK:
                first.append(chunk)
            missing -= found
        return first


def open_log(source: ByteSource, distribution: str) -> McapLog:
    """Open an MCAP file through its summary; where that is wrong or absent, by all its records."""
    del distribution
    scan = McapScan(source)
    contents, problem = scan.indexed()
    if contents is not None:
        log = McapLog(source, _with_profile(source, contents), scan)
        if not log.contradicts_summary():
            return log
        problem = Loss(0, SUMMARY_CONTRADICTS)
    source = source.nearby()
    scan = McapScan(source)
    contents = scan.scanned(len(MCAP_MAGIC), problem)
    return McapLog(source, _with_profile(source, contents), scan)


def _with_profile(source: ByteSource, contents: Contents) -> Contents:
    """Add the profile that the file's header names, or say that it cannot be read."""
    start = len(MCAP_MAGIC)
    head = source.read(start, RECORD_HEAD.size).ljust(RECORD_HEAD.size, b"\0")
    opcode, length = RECORD_HEAD.unpack(head)
    if opcode == Opcode.HEADER and length <= _LARGEST_HEADER:
        body = source.read(start + RECORD_HEAD.size, length)
        header = decode_record(records.Header, body) if len(body) == length else None
        if header is not None:
            return replace(contents, profile=header.profile)
    damage = Loss(start, "the header is damaged, so that the log's profile is not known")
    return replace(contents, losses=(damage, *contents.losses))
