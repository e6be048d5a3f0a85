"""What an MCAP file's summary section tells, if there is a sound and complete one."""

import struct
import zlib
from dataclasses import dataclass, field
from typing import Final

from mcap import records
from mcap.opcode import Opcode

from dogbot_logtool.reader.log import Chunk, Contents, Extra, Loss, Schema
from dogbot_logtool.reader.mcap_chunk import CHUNK_HEAD_SIZE
from dogbot_logtool.reader.mcap_records import (
    MAGIC,
    RECORD_HEAD,
    channel_of,
    decode_record,
    records_in,
    schema_of,
)
from dogbot_logtool.reader.source import ByteSource

_FOOTER_SIZE: Final = RECORD_HEAD.size + 20


def read_summary(source: ByteSource) -> tuple[Contents | None, Loss | None]:
    """Read the summary section.

    Returns:
        the contents, or None where the summary is absent, damaged or does not tell all; and the
        damage, if any.
    """
    summary, problem = _read_section(source)
    return (None if summary is None else _contents(source, summary)), problem


@dataclass(slots=True)
class _Summary:
    data_end: int
    statistics: records.Statistics | None = None
    schemas: dict[int, Schema] = field(default_factory=dict)
    channels: list[records.Channel] = field(default_factory=list)
    chunks: list[records.ChunkIndex] = field(default_factory=list)
    extras: list[Extra] = field(default_factory=list)


def _read_section(source: ByteSource) -> tuple[_Summary | None, Loss | None]:
    """Read the summary section; a loss says why there is none that can be trusted."""
    footer_offset = source.size - len(MAGIC) - _FOOTER_SIZE
    tail = source.read(footer_offset, _FOOTER_SIZE + len(MAGIC))
    if len(tail) < _FOOTER_SIZE + len(MAGIC) or not tail.endswith(MAGIC):
        return None, Loss(source.size, "the file has no end: its recording was cut off")
    opcode, length = RECORD_HEAD.unpack_from(tail)
    footer = decode_record(records.Footer, tail[RECORD_HEAD.size : _FOOTER_SIZE])
    if opcode != Opcode.FOOTER or length != 20 or footer is None:
        return None, Loss(footer_offset, "the footer is damaged")
    if footer.summary_start == 0:
        return None, None
    section = source.read(footer.summary_start, footer_offset - footer.summary_start)
    if not section or (
        footer.summary_crc and zlib.crc32(section + tail[: _FOOTER_SIZE - 4]) != footer.summary_crc
    ):
        return None, Loss(footer.summary_start, "the summary is damaged; it was read without")
    return _parse_summary(section, footer.summary_start)


def _parse_summary(section: bytes, offset: int) -> tuple[_Summary | None, Loss | None]:
    summary = _Summary(data_end=offset)
    damaged = Loss(offset, "the summary is damaged; it was read without")
    for opcode, start, end in records_in(section):
        body = section[start:end]
        match opcode:
            case Opcode.SCHEMA:
                schema = decode_record(records.Schema, body)
                if schema is None:
                    return None, damaged
                summary.schemas[schema.id] = schema_of(schema)
            case Opcode.CHANNEL:
                channel = decode_record(records.Channel, body)
                if channel is None:
                    return None, damaged
                summary.channels.append(channel)
            case Opcode.STATISTICS:
                summary.statistics = decode_record(records.Statistics, body)
            case Opcode.CHUNK_INDEX:
                index = decode_record(records.ChunkIndex, body)
                if index is None:
                    return None, damaged
                summary.chunks.append(index)
            case Opcode.ATTACHMENT_INDEX | Opcode.METADATA_INDEX:
                place, size = struct.unpack_from("<QQ", body)
                kind = Opcode.ATTACHMENT if opcode == Opcode.ATTACHMENT_INDEX else Opcode.METADATA
                summary.extras.append(Extra(kind, place, size))
    return summary, None


def _contents(source: ByteSource, summary: _Summary) -> Contents | None:
    """Return the contents, or None where the summary does not tell all of them."""
    statistics = summary.statistics
    if statistics is None or statistics.chunk_count != len(summary.chunks):
        return None
    chunks = [_indexed_chunk(index) for index in summary.chunks]
    chunks.sort(key=lambda chunk: chunk.offset)
    counted = [chunk.messages for chunk in chunks if chunk.messages is not None]
    channels = {channel.id: channel_of(channel, summary.schemas) for channel in summary.channels}
    complete = (
        (len(counted) < len(chunks) or sum(counted) == statistics.message_count)
        and (chunks or not statistics.message_count)
        and set(statistics.channel_message_counts) <= set(channels)
        and all(c.offset > 0 and c.index_end <= summary.data_end for c in chunks)
        and all(c.schema_id == 0 or c.schema_id in summary.schemas for c in summary.channels)
        and sum(statistics.channel_message_counts.values()) == statistics.message_count
        and len(summary.extras) == statistics.attachment_count + statistics.metadata_count
        and all(e.offset > 0 and e.offset + e.size <= source.size for e in summary.extras)
    )
    if not complete:
        return None
    empty = statistics.message_count == 0
    return Contents(
        channels=channels,
        chunks=chunks,
        counts={**dict.fromkeys(channels, 0), **statistics.channel_message_counts},
        start_time=None if empty else statistics.message_start_time,
        end_time=None if empty else statistics.message_end_time,
        extras=sorted(summary.extras, key=lambda extra: extra.offset),
    )


def _indexed_chunk(index: records.ChunkIndex) -> Chunk:
    end = index.chunk_start_offset + index.chunk_length
    index_end = end + index.message_index_length
    counts = None
    if index.message_index_offsets:
        # Each message index record is 15 bytes and 16 for every message.
        places = sorted((place, channel) for channel, place in index.message_index_offsets.items())
        ends = [place for place, _ in places[1:]] + [index_end]
        counts = {
            channel: max(end - place - 15, 0) // 16
            for (place, channel), end in zip(places, ends, strict=True)
        }
    head = RECORD_HEAD.size + CHUNK_HEAD_SIZE + 4 + len(index.compression.encode()) + 8
    return Chunk(
        offset=index.chunk_start_offset,
        data_offset=index.chunk_start_offset + head,
        data_size=index.compressed_size,
        end=end,
        index_end=index_end,
        compression=index.compression,
        size=index.uncompressed_size,
        start_time=index.message_start_time,
        end_time=index.message_end_time,
        counts=counts,
    )
