"""A scan of all records of an MCAP file whose summary is missing or wrong."""

from collections.abc import Mapping
from dataclasses import replace

from mcap import records
from mcap.opcode import Opcode

from dogbot_logtool.core.arrays import Bytes
from dogbot_logtool.reader.containers.chunks.chunk_content import ChunkContent, ChunkDamage
from dogbot_logtool.reader.containers.chunks.recovery_scan import IndexEntry, RecoveryScan
from dogbot_logtool.reader.containers.contents import Channel, Chunk, Contents, Extra, SharedCounts
from dogbot_logtool.reader.containers.loss import Loss, Losses, differing_counts, lost_messages
from dogbot_logtool.reader.containers.mcap.chunk import check_chunk, chunk_at, parse_chunk
from dogbot_logtool.reader.containers.mcap.descriptions import DESCRIBING, Descriptions, Trust
from dogbot_logtool.reader.containers.mcap.format import FIRST_PRIVATE_OPCODE, McapFormat
from dogbot_logtool.reader.containers.mcap.records import RECORD_HEAD, decode_record
from dogbot_logtool.reader.containers.mcap.summary import check_data, indexed_chunk
from dogbot_logtool.reader.containers.signatures import MCAP_MAGIC
from dogbot_logtool.reader.containers.sources.source import ByteSource


class McapRecoveryScan(RecoveryScan):
    """Finds chunks, bare messages, descriptions and extra records."""

    def __init__(self, source: ByteSource) -> None:
        self._descriptions = Descriptions()
        self._mcap_format = McapFormat(self._descriptions.channels)
        super().__init__(source, self._mcap_format, Losses())
        self._extras: list[Extra] = []
        self._statistics: records.Statistics | None = None
        self._data_end: int | None = None
        self._shared = SharedCounts()
        self._closed = False
        """There is a footer, so that the recording was closed properly."""

    def contents(self, problem: Loss | None) -> Contents:
        """Walk the file."""
        contents = self._contents(len(MCAP_MAGIC), problem)
        channels = self._descriptions.channels_by_id()
        for loss in (*self._descriptions.contradictions(), *self._descriptions.without_schema()):
            self._losses.add(loss)
        self._compare_statistics(contents.counts, channels)
        self._check_data()
        return replace(
            contents,
            channels=channels,
            counts={**dict.fromkeys(channels, 0), **contents.counts},
            extras=self._extras,
            losses=self._losses.all(),
        )

    def _step(self, offset: int) -> int | None:
        size = self._source.size
        head = self._source.read(offset, RECORD_HEAD.size)
        if len(head) < RECORD_HEAD.size:
            return size if head == MCAP_MAGIC else None
        opcode, length = RECORD_HEAD.unpack(head)
        content = offset + RECORD_HEAD.size
        end: int = content + length
        if opcode == Opcode.CHUNK:
            return self._chunk_record(offset)
        if opcode >= FIRST_PRIVATE_OPCODE and end <= size:
            # One bit makes a private record of a chunk, but not the other way round.
            is_chunk = self._mcap_format.is_chunk(self._source, content, length)
            return self._chunk_record(offset) if is_chunk else end
        sound = end <= size and (
            self._mcap_format.has_sound_content(self._source, content, opcode, length)
            # Their channel may be described later, or in the summary.
            or (opcode == Opcode.MESSAGE and self._begins_run(offset, end))
        )
        if not sound or (opcode == Opcode.MESSAGE and self._is_no_message(content, length)):
            return None
        return self._record(opcode, offset, content, end)

    def _is_no_message(self, content: int, length: int) -> bool:
        """Tell whether a record is of another kind than its opcode says, where that is likely."""
        unlikely = self._data_end is not None or self._some_checked
        return unlikely and self._mcap_format.passes_for_another(self._source, content, length)

    def _record(self, opcode: int, offset: int, content: int, end: int) -> int | None:
        match opcode:
            case Opcode.MESSAGE:
                return self._bare(offset, end)
            case Opcode.FOOTER if self._source.read(end, len(MCAP_MAGIC)) == MCAP_MAGIC:
                self._closed = True
                return self._end(end + len(MCAP_MAGIC))
            case Opcode.SCHEMA | Opcode.CHANNEL:
                body = self._source.read(content, end - content)
                trust = Trust.DATA if self._data_end is None else Trust.SUMMARY
                self._descriptions.add(opcode, body, offset, trust)
            case Opcode.STATISTICS | Opcode.CHUNK_INDEX:
                self._state(opcode, self._source.read(content, end - content))
            case Opcode.MESSAGE_INDEX:
                last = self._chunks[-1] if self._chunks else None
                if last and last.is_record and last.index_end == offset:
                    self._chunks[-1] = replace(self._chunks[-1], index_end=end)
            case Opcode.ATTACHMENT | Opcode.METADATA:
                self._extras.append(Extra(opcode, offset, end - offset, self._source))
            case Opcode.DATA_END:
                self._data_end = offset
        return end

    def _state(self, opcode: int, body: bytes) -> None:
        """Take what the summary section says of the data."""
        if opcode == Opcode.STATISTICS:
            self._statistics = decode_record(records.Statistics, body)
        elif (index := decode_record(records.ChunkIndex, body)) is not None:
            chunk = indexed_chunk(index, self._shared)
            self._index_entries[chunk.offset] = IndexEntry(
                chunk.start_time, chunk.end_time, chunk.counts
            )

    def _chunk_record(self, offset: int) -> int | None:
        try:
            chunk = chunk_at(self._source, offset)
        except ChunkDamage:
            return None
        return self._chunk(chunk, chunk.data_offset + chunk.data_size)

    def _parse(self, chunk: Chunk, stored: memoryview, target: Bytes) -> ChunkContent:
        return parse_chunk(chunk, stored, target, self._mcap_format)

    def _check(self, chunk: Chunk) -> None:
        check_chunk(chunk, self._source.size)

    def _describe(self, op: int, record: Bytes, chunk: Chunk) -> None:
        if op in DESCRIBING:
            body = record[RECORD_HEAD.size :].tobytes()
            trust = Trust.VERIFIED if chunk.crc else Trust.DATA
            self._descriptions.add(op, body, chunk.offset, trust)

    def _settle_ids(self) -> Mapping[int, int]:
        return {number: number for number in self._descriptions.channels}

    def _compare_statistics(
        self, counts: Mapping[int, int], channels: Mapping[int, Channel]
    ) -> None:
        statistics = self._statistics
        if statistics is None:
            return
        stated, found = statistics.message_count, sum(counts.values())
        if stated != found:
            known_lost = lost_messages(self._losses.all())
            explained = known_lost is None or stated <= found + known_lost
            what = f"the summary counts {stated} messages, but {found} were found"
            self._losses.add(Loss(0, what, 0, 0 if explained else None))
        elif what := differing_counts(channels, statistics.channel_message_counts, counts):
            self._losses.add(Loss(0, f"the summary counts {what}"))

    def _check_data(self) -> None:
        if self._data_end is not None:
            bare = any(not chunk.is_record for chunk in self._chunks)
            loss = check_data(self._source, self._data_end, thorough=bare)
            if loss is not None:
                # Outside chunks, a message may be lost without a trace.
                unknown = bare and self._statistics is None
                self._losses.add(replace(loss, messages=None) if unknown else loss)
        elif self._closed:
            what = "the record that ends the log's data is missing, and maybe others before it"
            self._losses.add(Loss(self._source.size, what, 0, None))
