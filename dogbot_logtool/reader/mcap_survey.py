"""A walk over all records of an MCAP file, for what its summary should have told."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Final

from mcap import records
from mcap.opcode import Opcode

from dogbot_logtool.reader.columns import Bytes
from dogbot_logtool.reader.log import (
    Chunk,
    ChunkContent,
    ChunkDamage,
    Contents,
    Extra,
    Loss,
)
from dogbot_logtool.reader.mcap_chunk import check_chunk, chunk_at, parse_chunk
from dogbot_logtool.reader.mcap_data_crc import check_data
from dogbot_logtool.reader.mcap_format import McapFormat
from dogbot_logtool.reader.mcap_records import (
    MAGIC,
    RECORD_HEAD,
    WHOLE_SMALL_RECORD,
    channel_of,
    decode_record,
    schema_of,
)
from dogbot_logtool.reader.mcap_summary import indexed_chunk
from dogbot_logtool.reader.source import ByteSource
from dogbot_logtool.reader.survey import MOST_DESCRIPTIONS, Stated, Survey

_FIRST_PRIVATE: Final = 0x80
"""Opcodes from here on belong to applications, and are passed over."""


class McapSurvey(Survey):
    """Finds chunks, bare messages, descriptions and extra records."""

    def __init__(self, source: ByteSource) -> None:
        self._schemas: dict[int, records.Schema] = {}
        self._channels: dict[int, records.Channel] = {}
        self._mcap_format = McapFormat(self._channels)
        super().__init__(source, self._mcap_format)
        self._extras: list[Extra] = []
        self._statistics: records.Statistics | None = None
        self._contradictions: set[str] = set()
        self._repetitions = 0
        self._data_end: int | None = None

    def contents(self, problem: Loss | None) -> Contents:
        """Walk the file."""
        contents = self._contents(len(MAGIC), problem)
        schemas = {schema.id: schema_of(schema) for schema in self._schemas.values()}
        channels = {c.id: channel_of(c, schemas) for c in self._channels.values()}
        self._compare_statistics(contents.counts)
        if self._data_end is not None:
            bare = any(not chunk.is_record for chunk in self._chunks)
            loss = check_data(self._source, self._data_end, thorough=bare)
            if loss is not None:
                self._losses.add(loss)
        return replace(
            contents,
            channels=channels,
            counts={**dict.fromkeys(channels, 0), **contents.counts},
            extras=self._extras,
            losses=self._losses.told(),
        )

    def _step(self, place: int) -> int | None:
        size = self._source.size
        head = self._source.read(place, RECORD_HEAD.size)
        if len(head) < RECORD_HEAD.size:
            return size if head == MAGIC else None
        opcode, length = RECORD_HEAD.unpack(head)
        content, end = place + RECORD_HEAD.size, place + RECORD_HEAD.size + length
        if opcode == Opcode.CHUNK:
            return self._chunk_record(place)
        if end > size or not (1 <= opcode <= max(Opcode) or opcode >= _FIRST_PRIVATE):
            return None
        if opcode == Opcode.MESSAGE:
            return self._bare(place, end)
        if opcode == Opcode.FOOTER and self._source.read(end, len(MAGIC)) == MAGIC:
            return self._end(end + len(MAGIC))
        return self._record(opcode, place, content, end)

    def _record(self, opcode: int, place: int, content: int, end: int) -> int | None:
        match opcode:
            case Opcode.SCHEMA | Opcode.CHANNEL | Opcode.STATISTICS | Opcode.CHUNK_INDEX:
                if end - content > WHOLE_SMALL_RECORD:
                    return None
                if not self._take(opcode, self._source.read(content, end - content)):
                    return None
            case Opcode.MESSAGE_INDEX:
                if self._chunks and self._chunks[-1].index_end == place:
                    self._chunks[-1] = replace(self._chunks[-1], index_end=end)
            case Opcode.ATTACHMENT | Opcode.METADATA:
                self._extras.append(Extra(opcode, place, end - place))
            case Opcode.DATA_END:
                if end - content != 4:
                    return None
                self._data_end = place
            case _:
                return end
        self._searched = False
        return end

    def _chunk_record(self, place: int) -> int | None:
        try:
            chunk = chunk_at(self._source, place)
        except ChunkDamage:
            return None
        return self._chunk(chunk, chunk.data_offset + chunk.data_size)

    def _end(self, end: int) -> int:
        rest = self._source.size - end
        if rest:
            what = f"the {rest} bytes behind the end of the recording were left out"
            self._losses.add(Loss(end, what, rest, None))
        return self._source.size

    def _parse(self, chunk: Chunk, stored: memoryview, target: Bytes) -> ChunkContent:
        return parse_chunk(chunk, stored, target, self._mcap_format)

    def _check(self, chunk: Chunk) -> None:
        check_chunk(chunk, self._source.size)

    def _describe(self, op: int, record: Bytes) -> None:
        if op in {Opcode.SCHEMA, Opcode.CHANNEL}:
            content = record[RECORD_HEAD.size :]
            number = int.from_bytes(content[:2].tobytes(), "little")
            known = self._schemas if op == Opcode.SCHEMA else self._channels
            # A million repetitions of what is known are not worth decoding.
            self._repetitions += number in known
            if number not in known or self._repetitions < MOST_DESCRIPTIONS:
                self._take(op, content.tobytes())

    def _ids(self) -> Mapping[int, int]:
        return {number: number for number in self._channels}

    def _take(self, opcode: int, body: bytes) -> bool:
        """Take a record that tells something; false if it is malformed."""
        match opcode:
            case Opcode.SCHEMA:
                schema = decode_record(records.Schema, body)
                if schema is not None and self._is_new(self._schemas.get(schema.id), schema, body):
                    self._schemas[schema.id] = schema
                return schema is not None
            case Opcode.CHANNEL:
                channel = decode_record(records.Channel, body)
                if channel is not None and self._is_new(
                    self._channels.get(channel.id), channel, body
                ):
                    self._channels[channel.id] = channel
                return channel is not None
            case Opcode.STATISTICS:
                self._statistics = decode_record(records.Statistics, body)
                return self._statistics is not None
            case _:
                index = decode_record(records.ChunkIndex, body)
                if index is not None:
                    chunk = indexed_chunk(index)
                    self._stated[chunk.offset] = Stated(
                        chunk.start_time, chunk.end_time, chunk.counts
                    )
                return index is not None

    def _is_new(
        self,
        known: records.Schema | records.Channel | None,
        found: records.Schema | records.Channel,
        body: bytes,
    ) -> bool:
        if known is None:
            return self._may_describe(len(self._channels), len(body))
        kind = type(found).__name__.lower()
        if known != found and kind not in self._contradictions:
            self._contradictions.add(kind)
            what = f"{kind} {found.id} is described in two ways; the first description was used"
            self._losses.add(Loss(0, what))
        return False

    def _compare_statistics(self, counts: Mapping[int, int]) -> None:
        statistics = self._statistics
        found = sum(counts.values())
        if statistics is not None and statistics.message_count != found:
            what = f"the summary counts {statistics.message_count} messages, but {found} were found"
            self._losses.add(Loss(0, what))
