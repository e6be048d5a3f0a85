"""The chunks, descriptions and other records of an MCAP file: by its summary, or by all records."""

from collections import Counter
from collections.abc import Mapping
from operator import attrgetter, itemgetter
from typing import Final

from mcap import records
from mcap.opcode import Opcode

from dogbot_logtool.mcap_layout import INDEX_ENTRY, INDEX_HEAD, RECORD_HEAD
from dogbot_logtool.reader.containers.log import (
    Channel,
    Chunk,
    Extra,
    Schema,
)
from dogbot_logtool.reader.containers.loss import LONGEST_NAME, Loss, lost_messages
from dogbot_logtool.reader.containers.mcap.records import (
    CHUNK_HEAD,
    CHUNK_HEAD_SIZE,
    DAMAGED_SUMMARY,
    FIRST_PRIVATE_OPCODE,
    FOOTER_SIZE,
    LARGEST_OPCODE,
    MESSAGE_CONTENT_SIZE,
    McapFormat,
    check_data,
    chunk_at,
    described,
    indexed_chunk,
    is_chunk,
    read_footer,
)
from dogbot_logtool.reader.containers.record_log import (
    RecordLog,
    UnusableIndex,
    open_records,
)
from dogbot_logtool.reader.containers.registry import MCAP_MAGIC
from dogbot_logtool.reader.containers.salvage import Index, IndexRecord, read_index
from dogbot_logtool.reader.containers.source import ByteSource

_NO_ACCIDENT: Final = 4
"""So many messages behind each other are believed, though their channel is not described yet."""
_STATED: Final = ("start_time", "end_time", "counts")
_LARGEST_TIME: Final = 2**63 - 1
_LENGTHS: Final = attrgetter("end", "data_offset", "data_size", "size", "compression")


class McapLog(RecordLog):
    """Finds chunks, bare messages, descriptions and extra records."""

    container = "MCAP"
    magic = MCAP_MAGIC
    copies_chunks = True

    def __init__(self, source: ByteSource) -> None:
        super().__init__(source, described)
        self._format: McapFormat = McapFormat(self._may_be_channel)
        self._outside_channels: set[int] = set()
        self._passed_from = FIRST_PRIVATE_OPCODE
        """Opcode from which on records are passed over; with an index, those of later versions,
        too."""
        self._named: list[Chunk] = []
        """The chunks that the summary names."""
        self._statistics: records.Statistics | None = None
        self._has_header = False
        self._data_end: int | None = None
        self._closed = False
        """There is a footer, so that the recording was closed properly."""

    def use_index(self) -> None:
        """See `RecordLog.use_index`."""
        self._passed_from = LARGEST_OPCODE + 1
        footer = read_footer(self.source)
        start = footer.summary_start
        end = self.source.size - FOOTER_SIZE - len(MCAP_MAGIC)
        if not self._holds(start, end, {}) or self._take_outside():
            raise UnusableIndex(Loss(start, DAMAGED_SUMMARY))
        self.channels = self._described_channels()
        statistics = self._statistics
        if statistics is None or self._without_schema() or not self._is_complete(statistics):
            raise UnusableIndex
        if not self._agrees(footer, statistics):
            raise UnusableIndex(Loss(start, DAMAGED_SUMMARY))
        self._finish({**dict.fromkeys(self.channels, 0), **statistics.channel_message_counts})

    def _is_complete(self, statistics: records.Statistics) -> bool:
        """Tell whether a summary with some statistics has all that opening a log needs."""
        return (
            statistics.chunk_count == len(self._named)
            and (bool(self._named) or not statistics.message_count)
            and statistics.channel_message_counts.keys() <= self.channels.keys()
            # Times that do not fit 64 bits with a sign are left to a look at the messages.
            and max(statistics.message_start_time, statistics.message_end_time) <= _LARGEST_TIME
        )

    def _agrees(self, footer: records.Footer, statistics: records.Statistics) -> bool:
        """Tell whether the summary agrees with itself and with the file."""
        self._outside = []
        named = {chunk.offset: chunk for chunk in self._named}
        stated = Counter(statistics.channel_message_counts)
        is_counted = all(chunk.counts is not None for chunk in self._named)
        return bool(
            stated.total() == statistics.message_count
            and len(named) == len(self._named)
            # To ask a store for the header of each chunk takes longer than all else.
            and (
                (footer.summary_crc and not self.source.has_cheap_seeks) or self._heads_agree(named)
            )
            and self._holds(len(MCAP_MAGIC), footer.summary_start, named)
            and (not is_counted or Counter(self._counted()) == stated)
            and len(self.extras) == statistics.attachment_count + statistics.metadata_count
            and not self._take_outside()
        )

    def _heads_agree(self, named: Mapping[int, Chunk]) -> bool:
        """Tell whether the chunks' own headers are as their indexes say."""
        heads = self.source.read_many([(offset, CHUNK_HEAD_SIZE) for offset in named])
        found = map(chunk_at, named, heads)
        return all(own and _are_alike(own, named[own.offset]) for own in found)

    def _step(self, offset: int) -> int | None:
        size = self.source.size
        head = self.source.read(offset, CHUNK_HEAD_SIZE)
        if len(head) < RECORD_HEAD.size:
            return size if head == MCAP_MAGIC else None
        opcode, length = RECORD_HEAD.unpack_from(head)
        content = offset + RECORD_HEAD.size
        end: int = content + length
        is_private = opcode >= self._passed_from and end <= size
        # One bit makes a private record of a chunk, but not the other way round.
        if opcode == Opcode.CHUNK or (is_private and is_chunk(head)):
            chunk = chunk_at(offset, head)
            if chunk is None:
                return None
            return self._take_chunk(chunk, chunk.data_offset + chunk.data_size)
        if is_private or end > size:
            return end if is_private else None
        if opcode == Opcode.MESSAGE:
            return self._message(offset, content, end)
        found = self._format.content(self.source.read, content, opcode, length)
        return None if found is None else self._record(found, opcode, offset, end)

    def _message(self, offset: int, content: int, end: int) -> int | None:
        """Take messages outside of chunks, which do not stand behind the end of the data.

        Their channel may be described later, or in the summary.
        """
        is_short = end - content < MESSAGE_CONTENT_SIZE
        if is_short or self._data_end is not None:
            return None
        channel = int.from_bytes(self.source.read(content, 2), "little")
        if self._may_be_channel(channel) or len(self._run(offset, end)[1]) > _NO_ACCIDENT:
            return self._bare(offset, end)
        return None

    def _may_be_channel(self, number: int) -> bool:
        """Tell whether a channel was met; before any was met, all may be."""
        met = self._outside_channels
        is_first = not met and not self.descriptions.first
        return is_first or number in met or ("channel", number) in self.descriptions.first

    def _record(self, found: object, opcode: int, offset: int, end: int) -> int | None:
        match found:
            case records.Header() if not self._has_header:
                self._has_header = True
                self.profile = found.profile
            case records.Footer() if self.source.read(end, len(MCAP_MAGIC)) == MCAP_MAGIC:
                self._closed = True
                return self._end(end + len(MCAP_MAGIC))
            case records.Schema() | records.Channel():
                self._outside.append((offset, end))
                if isinstance(found, records.Channel):
                    self._outside_channels.add(found.id)
            case records.Statistics():
                self._statistics = found
            case records.ChunkIndex():
                chunk = indexed_chunk(found)
                self._named.append(chunk)
                stated = {name: getattr(chunk, name) for name in _STATED}
                self._stated[chunk.offset] = stated
            case records.DataEnd():
                self._data_end = offset
        if opcode == Opcode.MESSAGE_INDEX:
            self._take_index(offset, end)
        elif opcode in {Opcode.ATTACHMENT, Opcode.METADATA}:
            self.extras.append(Extra(opcode, offset, end - offset, self.source))
        return end

    def _checksum(self, chunk: Chunk, stored: memoryview) -> tuple[int, tuple[Loss, ...]]:
        """See `RecordLog._checksum`; a chunk that the end of the file cuts off has none."""
        head = bytes(stored[:CHUNK_HEAD_SIZE])
        opcode, length = RECORD_HEAD.unpack_from(head)
        record_end = chunk.offset + RECORD_HEAD.size + length
        if record_end > chunk.end == self.source.size:
            return 0, ()
        crc = CHUNK_HEAD.unpack_from(head, RECORD_HEAD.size)[3]
        own = chunk_at(chunk.offset, head)
        if opcode == Opcode.CHUNK and own is not None and _are_alike(own, chunk):
            return crc, ()
        what = (
            f"the header of the chunk at byte {chunk.offset} is damaged; it was read nevertheless"
        )
        return crc, (Loss(chunk.offset, what),)

    def _index_of(self, behind: memoryview) -> Index | None:
        return read_index(behind, _index_record, INDEX_ENTRY, itemgetter("log_time"))

    def _described_channels(self) -> Mapping[int, Channel]:
        schemas = {
            each.number: Schema(each.number, each.name, each.facts.encoding, each.facts.data)
            for each in self.descriptions.of_kind("schema")
        }
        return {
            each.id: Channel(
                each.id,
                each.topic,
                each.message_encoding,
                schemas.get(each.schema_id),
                each.metadata,
            )
            for _, _, _, each in self.descriptions.of_kind("channel")
        }

    def _without_schema(self) -> list[Loss]:
        """Return what to say of channels whose schema is nowhere described."""
        what = "schema {} of {} is nowhere described: its messages can be copied, but not read"
        return [
            Loss(0, what.format(schema, each.name[:LONGEST_NAME]))
            for each in self.descriptions.of_kind("channel")
            if (schema := each.facts.schema_id)
            and ("schema", schema) not in self.descriptions.first
        ]

    def _conclude(self) -> None:
        if not self._has_header:
            what = "the header is damaged, so that the log's profile is not known"
            self._losses.append(Loss(len(MCAP_MAGIC), what))
        self._losses += self._without_schema()
        if self._statistics is not None:
            self._compare_statistics(self._statistics)
        if self._data_end is not None:
            bare = any(not chunk.is_record for chunk in self.chunks)
            loss = check_data(self.source, self._data_end, thorough=bare)
            if loss is not None:
                # Outside chunks, a message may be lost without a trace.
                unknown = bare and self._statistics is None
                self._losses.append(loss._replace(messages=None) if unknown else loss)
        elif self._closed:
            what = "the record that ends the log's data is missing, and maybe others before it"
            self._losses.append(Loss(self.source.size, what, 0, None))

    def _compare_statistics(self, statistics: records.Statistics) -> None:
        stated, found = statistics.message_count, sum(self.counts.values())
        if stated != found:
            known_lost = lost_messages(self._losses)
            explained = known_lost is None or stated <= found + known_lost
            what = f"the summary counts {stated} messages, but {found} were found"
            self._losses.append(Loss(0, what, 0, 0 if explained else None))


def _index_record(behind: memoryview, offset: int) -> IndexRecord | None:
    start = offset + INDEX_HEAD.size
    head = bytes(behind[offset:start]).ljust(INDEX_HEAD.size, b"\0")
    opcode, length, channel, size = INDEX_HEAD.unpack(head)
    end = offset + RECORD_HEAD.size + length
    if opcode != Opcode.MESSAGE_INDEX or not start + size <= end <= len(behind):
        return None
    return channel, behind[start : start + size], end


def _are_alike(own: Chunk, chunk: Chunk) -> bool:
    """Tell whether a chunk's own header is as the chunk is known from elsewhere."""
    own_times, times = ((each.start_time, each.end_time) for each in (own, chunk))
    return (chunk.messages == 0 or own_times == times) and _LENGTHS(own) == _LENGTHS(chunk)


def open_log(source: ByteSource, distribution: str) -> RecordLog:
    """Open an MCAP file."""
    del distribution
    return open_records(McapLog, source)
