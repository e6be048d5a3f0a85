"""The chunks, descriptions and other records of an MCAP file: by its summary, or by all records."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Final

from mcap import records
from mcap.opcode import Opcode

from dogbot_logtool.core.arrays import Bytes
from dogbot_logtool.reader.containers.contents import Channel, Chunk, Contents, Extra, time_range
from dogbot_logtool.reader.containers.loss import Loss, differing_counts, lost_messages
from dogbot_logtool.reader.containers.mcap.chunk import check_chunk, chunk_at, parse_chunk
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
    Section,
    check_data,
    damaged_summary,
    indexed_chunk,
    read_section,
)
from dogbot_logtool.reader.containers.salvage.content import ChunkContent, ChunkDamage
from dogbot_logtool.reader.containers.salvage.scan import IndexEntry, Scan
from dogbot_logtool.reader.containers.signatures import MCAP_MAGIC
from dogbot_logtool.reader.containers.sources.source import ByteSource, in_groups

_LARGEST_TIME: Final = 2**63 - 1
SUMMARY_CONTRADICTS: Final = (
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

    def __init__(self, source: ByteSource) -> None:
        self.descriptions = Descriptions()
        self._mcap_format = McapFormat(self.descriptions.channels)
        super().__init__(source, self._mcap_format)
        self._extras: list[Extra] = []
        self._statistics: records.Statistics | None = None
        self._data_end: int | None = None
        self._closed = False
        """There is a footer, so that the recording was closed properly."""

    def indexed(self) -> tuple[Contents | None, Loss | None]:
        """Read the summary.

        Returns:
            the contents, or None where the summary is absent, damaged, incomplete or contradicts
            the chunks; and what is wrong with it.
        """
        section, problem = read_section(self._source)
        if section is None:
            return None, problem
        chunks: list[Chunk] = []
        extras: list[int] = []
        for opcode, body in section.records:
            if not self._summarised(opcode, body, chunks, extras):
                return None, damaged_summary(section.offset)
        chunks.sort(key=lambda chunk: chunk.offset)
        if self._statistics is None or not self._is_complete(self._statistics, chunks, extras):
            return None, None
        if not self._is_true(self._statistics, chunks, extras, section):
            return None, Loss(section.offset, SUMMARY_CONTRADICTS)
        loss = check_data(self._source, section.offset - DATA_END_SIZE, thorough=False)
        channels = self.descriptions.channels_by_id()
        counts = {**dict.fromkeys(channels, 0), **self._statistics.channel_message_counts}
        times = _stated_times(chunks, self._statistics)
        if not self._statistics.message_count:
            times = None, None
        losses = () if loss is None else (loss,)
        return Contents(channels, chunks, counts, *times, "", self._extras, losses), None

    def _summarised(self, opcode: int, body: bytes, chunks: list[Chunk], extras: list[int]) -> bool:
        """Take a record of the summary; tell whether it is well-formed.

        Args:
            opcode: its kind.
            body: its content.
            chunks: receives the one that it describes.
            extras: receives the offset of the attachment or metadata record that it names.
        """
        match opcode:
            case Opcode.SCHEMA | Opcode.CHANNEL:
                return self.descriptions.add(opcode, body, 0, Trust.SUMMARY)
            case Opcode.STATISTICS:
                self._statistics = decode_record(records.Statistics, body)
                return self._statistics is not None
            case Opcode.CHUNK_INDEX:
                index = decode_record(records.ChunkIndex, body)
                chunks += [indexed_chunk(index)] if index else []
                return index is not None
            case Opcode.ATTACHMENT_INDEX | Opcode.METADATA_INDEX:
                extras.append(int.from_bytes(body[:8], "little"))
                return len(body) >= 16
        return True

    def _is_complete(
        self, statistics: records.Statistics, chunks: Sequence[Chunk], extras: Sequence[int]
    ) -> bool:
        """Tell whether the summary has all the parts that opening a log needs."""
        return (
            statistics.chunk_count == len(chunks)
            and (bool(chunks) or not statistics.message_count)
            and statistics.channel_message_counts.keys() <= self.descriptions.channels.keys()
            and not any(self.descriptions.without_schema())
            and statistics.attachment_count + statistics.metadata_count == len(extras)
            # Times that do not fit 64 bits with a sign are left to a look at the messages.
            and max(statistics.message_start_time, statistics.message_end_time) <= _LARGEST_TIME
        )

    def _is_true(
        self,
        statistics: records.Statistics,
        chunks: Sequence[Chunk],
        extras: Sequence[int],
        section: Section,
    ) -> bool:
        """Tell whether the parts of the summary agree with each other and with the file.

        A chunk whose own header is damaged is there nevertheless if a checksum vouches for the
        summary.
        """
        return (
            sum(statistics.channel_message_counts.values()) == statistics.message_count
            and _chunk_indexes_agree(chunks, statistics)
            and all(each.data_offset + each.data_size <= each.end for each in chunks)
            and all(each.end <= each.index_end for each in chunks)
            and (section.verified or _are_there(self._source, chunks))
            and self._fills(len(MCAP_MAGIC), chunks, section.offset)
            and [extra.offset for extra in self._extras] == sorted(extras)
            and not any(self.descriptions.contradictions())
        )

    def _between(self, offset: int, stop: int) -> int | None:
        head = self._source.read(offset, RECORD_HEAD.size)
        if len(head) < RECORD_HEAD.size:
            return None
        opcode, length = RECORD_HEAD.unpack(head)
        content = offset + RECORD_HEAD.size
        if content + length > stop or not (opcode in _BETWEEN or opcode > LARGEST_OPCODE):
            return None
        return self._record(opcode, offset, content, content + length)

    def scanned(self, start: int, problem: Loss | None) -> Contents:
        """See `Scan.scanned`."""
        contents = super().scanned(start, problem)
        for loss in (*self.descriptions.contradictions(), *self.descriptions.without_schema()):
            self._losses.add(loss)
        self._compare_statistics(contents.counts, contents.channels)
        self._check_data()
        return replace(contents, extras=self._extras, losses=self._losses.all())

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
                return self._close(offset, end + len(MCAP_MAGIC))
            case Opcode.SCHEMA | Opcode.CHANNEL:
                body = self._source.read(content, min(end - content, WHOLE_SMALL_RECORD))
                trust = Trust.DATA if self._data_end is None else Trust.SUMMARY
                self.descriptions.add(opcode, body, offset, trust)
            case Opcode.STATISTICS:
                body = self._source.read(content, end - content)
                self._statistics = decode_record(records.Statistics, body)
            case Opcode.CHUNK_INDEX:
                body = self._source.read(content, end - content)
                if index := decode_record(records.ChunkIndex, body):
                    chunk = indexed_chunk(index)
                    entry = IndexEntry(chunk.start_time, chunk.end_time, chunk.counts)
                    self._index_entries[chunk.offset] = entry
            case Opcode.MESSAGE_INDEX:
                self._take_index(offset, end)
            case Opcode.ATTACHMENT | Opcode.METADATA:
                self._extras.append(Extra(opcode, offset, end - offset, self._source))
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
            chunk = chunk_at(self._source, offset)
        except ChunkDamage:
            return None
        return self._take_chunk(chunk, chunk.data_offset + chunk.data_size)

    def check(self, chunk: Chunk) -> None:
        """See `Scan.check`."""
        check_chunk(chunk, self._source.size)

    def parse(self, chunk: Chunk, stored: memoryview, target: Bytes) -> ChunkContent:
        """See `Scan.parse`."""
        return parse_chunk(chunk, stored, target, self._mcap_format)

    def _describe(self, op: int, record: Bytes, chunk: Chunk) -> None:
        if op in DESCRIBING:
            body = record[RECORD_HEAD.size :].tobytes()
            trust = Trust.VERIFIED if chunk.crc else Trust.DATA
            self.descriptions.add(op, body, chunk.offset, trust)

    def _settle_ids(self) -> Mapping[int, int]:
        return {number: number for number in self.descriptions.channels}

    def _channels(self) -> Mapping[int, Channel]:
        return self.descriptions.channels_by_id()

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


def _chunk_indexes_agree(chunks: Sequence[Chunk], statistics: records.Statistics) -> bool:
    """Tell whether the chunk indexes give the statistics, as far as they tell of messages."""
    counts: Counter[int] = Counter()
    for chunk in chunks:
        if chunk.counts is None:
            return True
        counts.update(chunk.counts)
    if counts != Counter(statistics.channel_message_counts):
        return False
    start, end = _stated_times(chunks, statistics)
    # A time of 0 is left out of the statistics by a writer that takes it for none.
    return start in {0, statistics.message_start_time} and end == statistics.message_end_time


def _stated_times(
    chunks: Sequence[Chunk], statistics: records.Statistics
) -> tuple[int | None, int | None]:
    """Return the log times of the first and the last message, by the chunk indexes if known."""
    if chunks and all(chunk.messages for chunk in chunks):
        return time_range(chunks)
    return statistics.message_start_time, statistics.message_end_time


def _are_there(source: ByteSource, chunks: Sequence[Chunk]) -> bool:
    """Tell whether each chunk's record begins where its index says, and ends there, too."""
    heads = in_groups(source, [(chunk.offset, RECORD_HEAD.size) for chunk in chunks])
    return all(
        head == RECORD_HEAD.pack(Opcode.CHUNK, chunk.end - chunk.offset - RECORD_HEAD.size)
        for head, chunk in zip(heads, chunks, strict=True)
    )
