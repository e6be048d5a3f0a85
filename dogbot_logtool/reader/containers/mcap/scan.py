"""The chunks, descriptions and other records of an MCAP file: by its summary, or by all records."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from typing import Final

import numpy as np
from mcap import records
from mcap.opcode import Opcode

from dogbot_logtool.core.arrays import Bytes, distinct
from dogbot_logtool.reader.containers.chunked_log import ChunkedLog, open_chunked
from dogbot_logtool.reader.containers.compression import check_claimed_size
from dogbot_logtool.reader.containers.contents import Channel, Chunk, Contents, Extra
from dogbot_logtool.reader.containers.loss import Loss, differing_counts, lost_messages
from dogbot_logtool.reader.containers.mcap.chunk import chunk_at, parse_chunk
from dogbot_logtool.reader.containers.mcap.descriptions import DESCRIBING, Descriptions, Trust
from dogbot_logtool.reader.containers.mcap.format import (
    FIRST_PRIVATE_OPCODE,
    LARGEST_OPCODE,
    McapFormat,
)
from dogbot_logtool.reader.containers.mcap.records import (
    RECORD_HEAD,
    WHOLE_SMALL_RECORD,
    decode_record,
)
from dogbot_logtool.reader.containers.mcap.summary import (
    DATA_END_SIZE,
    Summary,
    check_data,
    indexed_chunk,
    read_summary,
)
from dogbot_logtool.reader.containers.salvage.content import ChunkContent, ChunkDamage
from dogbot_logtool.reader.containers.salvage.scan import IndexEntry, Scan
from dogbot_logtool.reader.containers.signatures import MCAP_MAGIC
from dogbot_logtool.reader.containers.sources.source import ByteSource, in_groups

_LARGEST_HEADER: Final = 1 << 20
_MOST_FIRST_CHUNKS: Final = 8
_LARGEST_FIRST_CHUNK: Final = 16 << 20
"""Larger chunks, decompressed, are not read when a log is opened."""
_SUMMARY_CONTRADICTS: Final = (
    "the summary contradicts itself or the chunks; the log was read without it"
)
_BETWEEN: Final = (
    Opcode.HEADER,
    Opcode.SCHEMA,
    Opcode.CHANNEL,
    Opcode.MESSAGE_INDEX,
    Opcode.ATTACHMENT,
    Opcode.METADATA,
    Opcode.DATA_END,
)
"""Record types that may stand between the chunks without the summary's naming them."""


class McapScan(Scan):
    """Finds chunks, bare messages, descriptions and extra records."""

    container = "MCAP"
    magic = MCAP_MAGIC
    copies_chunks = True

    def __init__(self, source: ByteSource) -> None:
        self.descriptions = Descriptions()
        self._mcap_format = McapFormat(self.descriptions.channels)
        super().__init__(source, self._mcap_format)
        self._statistics: records.Statistics | None = None
        self._data_end: int | None = None
        self._closed = False
        """There is a footer, so that the recording was closed properly."""

    def indexed(self) -> tuple[Contents | None, Loss | None]:
        """See `Scan.indexed`."""
        summary, problem = read_summary(self.source, self.descriptions)
        if summary is None or summary.statistics is None:
            return None, problem
        statistics = self._statistics = summary.statistics
        channels = self._channels()
        missing = any(self.descriptions.without_schema())
        if missing or not summary.is_complete(statistics, channels.keys()):
            return None, None
        counts = {**dict.fromkeys(channels, 0), **statistics.channel_message_counts}
        if not (summary.agrees(statistics) and self._holds(summary)):
            return None, Loss(summary.offset, _SUMMARY_CONTRADICTS)
        if self._chunks_contradict(_first_chunks(summary.chunks, counts)):
            return None, Loss(0, _SUMMARY_CONTRADICTS)
        profile = self._profile()
        if loss := check_data(self.source, summary.offset - DATA_END_SIZE, thorough=False):
            self._losses.add(loss)
        losses = self._losses.all()
        times = summary.times(statistics) if statistics.message_count else (None, None)
        found = channels, summary.chunks, counts, *times, profile, self._extras, losses
        return Contents(*found), None

    def _holds(self, summary: Summary) -> bool:
        """Tell whether a summary agrees with the file.

        A chunk whose own header is damaged is there nevertheless if a checksum vouches for the
        summary.
        """
        return (
            (summary.verified or _are_there(self.source, summary.chunks))
            and self._fills(len(MCAP_MAGIC), summary.chunks, summary.offset)
            and [extra.offset for extra in self._extras] == summary.extras
            and not any(self.descriptions.contradictions())
        )

    def _chunks_contradict(self, chunks: Sequence[Chunk]) -> bool:
        """Tell whether chunks describe channels otherwise than the summary, or describe others."""
        ranges = [(chunk.offset, chunk.index_end - chunk.offset) for chunk in chunks]
        for chunk, stored in zip(chunks, self.source.read_many(ranges), strict=True):
            target = np.empty(chunk.size, np.uint8)
            try:
                self.check(chunk)
                content = self.parse(chunk, memoryview(stored), target)
            except ChunkDamage:
                continue
            numbers = distinct(content.messages.channel).tolist()
            if self.contradictions(content, target, chunk) or not self.ids.keys() >= {*numbers}:
                return True
        return False

    def _between(self, offset: int, stop: int) -> int | None:
        head = self.source.read(offset, RECORD_HEAD.size)
        if len(head) < RECORD_HEAD.size:
            return None
        opcode, length = RECORD_HEAD.unpack(head)
        content = offset + RECORD_HEAD.size
        if content + length > stop or not (opcode in _BETWEEN or opcode > LARGEST_OPCODE):
            return None
        return self._record(opcode, offset, content, content + length)

    def _step(self, offset: int) -> int | None:
        size = self.source.size
        head = self.source.read(offset, RECORD_HEAD.size)
        if len(head) < RECORD_HEAD.size:
            return size if head == MCAP_MAGIC else None
        opcode, length = RECORD_HEAD.unpack(head)
        content = offset + RECORD_HEAD.size
        end: int = content + length
        if opcode == Opcode.CHUNK:
            return self._chunk_record(offset)
        if opcode >= FIRST_PRIVATE_OPCODE and end <= size:
            # One bit makes a private record of a chunk, but not the other way round.
            is_chunk = self._mcap_format.is_chunk(self.source, content, length)
            return self._chunk_record(offset) if is_chunk else end
        sound = end <= size and (
            self._mcap_format.has_sound_content(self.source, content, opcode, length)
            # Their channel may be described later, or in the summary.
            or (opcode == Opcode.MESSAGE and self._runs.begins(offset, end))
        )
        if not sound or (opcode == Opcode.MESSAGE and self._is_no_message(content, length)):
            return None
        return self._record(opcode, offset, content, end)

    def _is_no_message(self, content: int, length: int) -> bool:
        """Tell whether a record is of another kind than its opcode says, where that is likely."""
        unlikely = self._data_end is not None or self._some_checked
        return unlikely and self._mcap_format.passes_for_another(self.source, content, length)

    def _record(self, opcode: int, offset: int, content: int, end: int) -> int | None:
        match opcode:
            case Opcode.MESSAGE:
                return self._bare(offset, end)
            case Opcode.FOOTER if self.source.read(end, len(MCAP_MAGIC)) == MCAP_MAGIC:
                return self._close(offset, end + len(MCAP_MAGIC))
            case Opcode.SCHEMA | Opcode.CHANNEL:
                body = self.source.read(content, min(end - content, WHOLE_SMALL_RECORD))
                trust = Trust.DATA if self._data_end is None else Trust.SUMMARY
                self.descriptions.add(opcode, body, offset, trust)
            case Opcode.STATISTICS:
                body = self.source.read(content, end - content)
                self._statistics = decode_record(records.Statistics, body)
            case Opcode.CHUNK_INDEX:
                body = self.source.read(content, end - content)
                if index := decode_record(records.ChunkIndex, body):
                    chunk = indexed_chunk(index)
                    entry = IndexEntry(chunk.start_time, chunk.end_time, chunk.counts)
                    self._index_entries[chunk.offset] = entry
            case Opcode.MESSAGE_INDEX:
                self._take_index(offset, end)
            case Opcode.ATTACHMENT | Opcode.METADATA:
                self._extras.append(Extra(opcode, offset, end - offset, self.source))
            case Opcode.DATA_END:
                self._data_end = offset
        return end

    def _close(self, footer: int, end: int) -> int:
        """Stop behind the footer of a recording that was closed properly."""
        self._closed = True
        if self._data_end is None and self._chunks and self._chunks[-1].end == footer:
            # The record that ends the data is missing: a false message may have taken it.
            self._doubtful.add(self._chunks[-1].offset)
        return self._end(end)

    def _chunk_record(self, offset: int) -> int | None:
        try:
            chunk = chunk_at(self.source, offset)
        except ChunkDamage:
            return None
        return self._take_chunk(chunk, chunk.data_offset + chunk.data_size)

    def check(self, chunk: Chunk) -> None:
        """See `Scan.check`."""
        check_claimed_size(chunk.size, chunk.data_size)
        if chunk.data_offset + chunk.data_size > self.source.size:
            raise ChunkDamage("it is cut off by the end of the file", chunk.messages)

    def parse(self, chunk: Chunk, stored: memoryview, target: Bytes) -> ChunkContent:
        """See `Scan.parse`."""
        return parse_chunk(chunk, stored, target, self._mcap_format)

    def by_own_header(self, chunk: Chunk) -> Chunk | None:
        """See `Scan.by_own_header`."""
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
        """See `Scan.own_times`: those of its header."""
        try:
            own = chunk_at(self.source, chunk.offset)
        except ChunkDamage:
            return None
        return own.start_time, own.end_time

    def contradictions(self, content: ChunkContent, data: Bytes, chunk: Chunk) -> Sequence[Loss]:
        """See `Scan.contradictions`."""
        return self.descriptions.contradictions_in(data, content.others, chunk.offset)

    def describes_others(
        self, channels: Collection[Channel], content: ChunkContent, data: Bytes
    ) -> bool:
        """See `Scan.describes_others`."""
        schemas = {each.schema.id for each in channels if each.schema is not None}
        ids = {Opcode.CHANNEL: {each.id for each in channels}, Opcode.SCHEMA: schemas}
        return any(
            int.from_bytes(data[start + RECORD_HEAD.size :][:2].tobytes(), "little") not in ids[op]
            for op, start, _ in content.others.tolist()
            if op in ids
        )

    def _describe(self, op: int, record: Bytes, chunk: Chunk) -> None:
        if op in DESCRIBING:
            body = record[RECORD_HEAD.size :].tobytes()
            trust = Trust.VERIFIED if chunk.crc else Trust.DATA
            self.descriptions.add(op, body, chunk.offset, trust)

    @property
    def ids(self) -> Mapping[int, int]:
        """See `Scan.ids`."""
        return {number: number for number in self.descriptions.channels}

    def _channels(self) -> Mapping[int, Channel]:
        return self.descriptions.channels_by_id()

    def _profile(self) -> str:
        """Return the profile that the file's header names; say if that cannot be read."""
        start = len(MCAP_MAGIC)
        head = self.source.read(start, RECORD_HEAD.size).ljust(RECORD_HEAD.size, b"\0")
        opcode, length = RECORD_HEAD.unpack(head)
        if opcode == Opcode.HEADER and length <= _LARGEST_HEADER:
            body = self.source.read(start + RECORD_HEAD.size, length)
            header = decode_record(records.Header, body) if len(body) == length else None
            if header is not None:
                return header.profile
        what = "the header is damaged, so that the log's profile is not known"
        self._losses.add(Loss(start, what))
        return ""

    def _conclude(self, counts: Mapping[int, int]) -> None:
        for loss in (*self.descriptions.contradictions(), *self.descriptions.without_schema()):
            self._losses.add(loss)
        if self._statistics is not None:
            self._compare_statistics(counts, self._statistics)
        self._check_data()

    def _compare_statistics(
        self, counts: Mapping[int, int], statistics: records.Statistics
    ) -> None:
        stated, found = statistics.message_count, sum(counts.values())
        if stated != found:
            known_lost = lost_messages(self._losses.all())
            explained = known_lost is None or stated <= found + known_lost
            what = f"the summary counts {stated} messages, but {found} were found"
            self._losses.add(Loss(0, what, 0, 0 if explained else None))
        elif what := differing_counts(self._channels(), statistics.channel_message_counts, counts):
            self._losses.add(Loss(0, f"the summary counts {what}"))

    def _check_data(self) -> None:
        if self._data_end is not None:
            bare = any(not chunk.is_record for chunk in self._chunks)
            loss = check_data(self.source, self._data_end, thorough=bare)
            if loss is not None:
                # Outside chunks, a message may be lost without a trace.
                unknown = bare and self._statistics is None
                self._losses.add(replace(loss, messages=None) if unknown else loss)
        elif self._closed:
            what = "the record that ends the log's data is missing, and maybe others before it"
            self._losses.add(Loss(self.source.size, what, 0, None))


def _first_chunks(chunks: Sequence[Chunk], counts: Mapping[int, int]) -> list[Chunk]:
    """Return the chunks in which channels have their first messages, but not too many.

    A channel is described before its first message, mostly in the same chunk.
    """
    missing = {number for number, count in counts.items() if count}
    first: list[Chunk] = []
    for chunk in chunks:
        if not missing or len(first) == _MOST_FIRST_CHUNKS:
            break
        # Without an index, the first chunk may hold messages of any channel.
        own = dict.fromkeys(missing, 1) if chunk.counts is None else chunk.counts
        found = {number for number, count in own.items() if count and number in missing}
        if found and chunk.size <= _LARGEST_FIRST_CHUNK:
            first.append(chunk)
        missing -= found
    return first


def _are_there(source: ByteSource, chunks: Sequence[Chunk]) -> bool:
    """Tell whether each chunk's record begins where its index says, and ends there, too."""
    heads = in_groups(source, [(chunk.offset, RECORD_HEAD.size) for chunk in chunks])
    return all(
        head == RECORD_HEAD.pack(Opcode.CHUNK, chunk.end - chunk.offset - RECORD_HEAD.size)
        for head, chunk in zip(heads, chunks, strict=True)
    )


def open_log(source: ByteSource, distribution: str) -> ChunkedLog:
    """Open an MCAP file."""
    del distribution
    return open_chunked(McapScan, source)
