"""The output file, as the mcap library reads it from both ends."""

import zlib
from collections.abc import Iterator
from io import BytesIO
from typing import get_args

import numpy as np
import pytest
from mcap import records
from mcap.data_stream import ReadDataStream, RecordBuilder
from mcap.opcode import Opcode
from mcap.reader import make_reader
from mcap.stream_reader import StreamReader

from dogbot_logtool.writer.chunks import Compression, finish_chunks
from dogbot_logtool.writer.mcap_writer import MAGIC, McapWriter, metadata_record
from dogbot_logtool.writer.message_records import in_time_order
from tests.writer.stamping import stamped

COMPRESSIONS: tuple[Compression, ...] = get_args(Compression)
SCHEMAS = [records.Schema(1, b"text", "ros1msg", "a/B"), records.Schema(7, b"", "", "empty")]
CHANNELS = [
    records.Channel(3, "/one", "ros1", {"callerid": "/x"}, 1),
    records.Channel(4, "/two", "none", {}, 0),
    records.Channel(9, "/silent", "ros1", {}, 7),
]


def attachment(name: str, data: bytes) -> tuple[bytes, records.Attachment]:
    record = records.Attachment(
        create_time=11, log_time=12, name=name, media_type="text/plain", data=data
    )
    builder = RecordBuilder()
    record.write(builder)
    return bytes(builder.end()), record


def write(compression: Compression, batches: int = 3) -> tuple[bytes, list[tuple[int, int, bytes]]]:
    """Write a file of two channels, an attachment and metadata; return it and its messages."""
    sink = BytesIO()
    writer = McapWriter(sink, "ros1")
    for schema in SCHEMAS:
        writer.add_schema(schema)
    for channel in CHANNELS:
        writer.add_channel(channel)
    messages: list[tuple[int, int, bytes]] = []
    rng = np.random.default_rng(5)
    for batch in range(batches):
        parts = []
        for channel_id, size, count in ((3, 40, 900), (4, 3, 50)):
            times = np.sort(rng.integers(10**9, 2 * 10**9, count)) - batch * 1000
            payload = rng.integers(0, 256, (count, size), np.uint8)
            parts.append(stamped(channel_id, times, payload))
            rows = zip(times.tolist(), payload, strict=True)
            messages.extend((channel_id, time, row.tobytes()) for time, row in rows)
        for chunk in finish_chunks(in_time_order(parts), compression):
            writer.add_chunk(chunk)
    writer.copy_attachment(*attachment("notes", b"dear diary"))
    writer.add_metadata(metadata_record("made", {"z": "last", "a": "first"}))
    writer.copy_attachment(*attachment("empty", b""))
    writer.finish()
    return sink.getvalue(), messages


def all_records(data: bytes) -> list[records.McapRecord]:
    """Read from front to back; the library checks the checksums of chunks and of the data."""
    return list(StreamReader(BytesIO(data), validate_crcs=True).records)


def record_at(data: bytes, place: int) -> tuple[int, bytes]:
    size = int.from_bytes(data[place + 1 : place + 9], "little")
    return data[place], data[place : place + 9 + size]


@pytest.mark.parametrize("compression", COMPRESSIONS)
def test_statistics(compression: Compression) -> None:
    data, messages = write(compression)
    summary = make_reader(BytesIO(data)).get_summary()
    assert summary is not None
    statistics = summary.statistics
    assert statistics is not None
    assert statistics.message_count == len(messages)
    assert statistics.channel_message_counts == {3: 2700, 4: 150}
    assert statistics.message_start_time == min(time for _, time, _ in messages)
    assert statistics.message_end_time == max(time for _, time, _ in messages)
    assert (statistics.schema_count, statistics.channel_count) == (2, 3)
    assert (statistics.attachment_count, statistics.metadata_count) == (2, 1)
    assert statistics.chunk_count == len(summary.chunk_indexes) == 3
    assert summary.schemas == {schema.id: schema for schema in SCHEMAS}
    assert summary.channels == {channel.id: channel for channel in CHANNELS}


def test_offsets_point_at_what_they_say() -> None:
    data, _ = write("lz4")
    summary = make_reader(BytesIO(data)).get_summary()
    assert summary is not None
    for index in summary.chunk_indexes:
        opcode, record = record_at(data, index.chunk_start_offset)
        assert (opcode, len(record)) == (Opcode.CHUNK, index.chunk_length)
        chunk = records.Chunk.read(ReadDataStream(BytesIO(record[9:])))
        assert (index.compression, index.compressed_size) == (chunk.compression, len(chunk.data))
        assert index.uncompressed_size == chunk.uncompressed_size
        assert index.message_start_time == chunk.message_start_time
        assert index.message_end_time == chunk.message_end_time
        total = 0
        for channel, place in index.message_index_offsets.items():
            opcode, record = record_at(data, place)
            entries = records.MessageIndex.read(ReadDataStream(BytesIO(record[9:])))
            assert (opcode, entries.channel_id) == (Opcode.MESSAGE_INDEX, channel)
            total += len(record)
        assert total == index.message_index_length
    for attached in summary.attachment_indexes:
        opcode, record = record_at(data, attached.offset)
        assert (opcode, len(record)) == (Opcode.ATTACHMENT, attached.length)
        read = records.Attachment.read(ReadDataStream(BytesIO(record[9:])))
        assert (attached.name, attached.data_size) == (read.name, len(read.data))
        assert (attached.log_time, attached.create_time) == (read.log_time, read.create_time)
        assert attached.media_type == read.media_type
    for described in summary.metadata_indexes:
        opcode, record = record_at(data, described.offset)
        assert (opcode, len(record)) == (Opcode.METADATA, described.length)
        assert described.name == "made"


def sections(data: bytes) -> tuple[records.Footer, records.DataEnd]:
    footer = records.Footer.read(ReadDataStream(BytesIO(data[-8 - 20 : -8])))
    place = footer.summary_start - 9 - 4
    assert data[place] == Opcode.DATA_END
    return footer, records.DataEnd.read(ReadDataStream(BytesIO(data[place + 9 :])))


@pytest.mark.parametrize("compression", COMPRESSIONS)
def test_checksums(compression: Compression) -> None:
    data, _ = write(compression)
    footer, data_end = sections(data)
    assert data_end.data_section_crc == zlib.crc32(data[: footer.summary_start - 13])
    assert footer.summary_crc == zlib.crc32(data[footer.summary_start : -8 - 4])
    assert (data[:8], data[-8:]) == (MAGIC, MAGIC)


def summary_offsets(data: bytes) -> Iterator[records.SummaryOffset]:
    for record in all_records(data):
        if isinstance(record, records.SummaryOffset):
            yield record


def test_summary_offsets_tile_the_summary() -> None:
    data, _ = write("zstd")
    footer, _ = sections(data)
    place = footer.summary_start
    opcodes: list[int] = []
    for offset in summary_offsets(data):
        assert offset.group_start == place
        end = place + offset.group_length
        while place < end:
            opcode, record = record_at(data, place)
            assert opcode == offset.group_opcode
            place += len(record)
        assert place == end
        opcodes.append(offset.group_opcode)
    assert place == footer.summary_offset_start
    assert len(set(opcodes)) == len(opcodes) == 6


def test_attachments_and_metadata() -> None:
    reader = make_reader(BytesIO(write("zstd")[0]), validate_crcs=True)
    assert [(a.name, a.data) for a in reader.iter_attachments()] == [
        ("notes", b"dear diary"),
        ("empty", b""),
    ]
    (metadata,) = reader.iter_metadata()
    assert (metadata.name, list(metadata.metadata.items())) == (
        "made",
        [("a", "first"), ("z", "last")],
    )


def test_empty_file() -> None:
    sink = BytesIO()
    McapWriter(sink, "").finish()
    data = sink.getvalue()
    summary = make_reader(BytesIO(data)).get_summary()
    assert summary is not None
    assert summary.statistics is not None
    assert summary.statistics.message_count == 0
    assert summary.statistics.chunk_count == 0
    assert (summary.schemas, summary.channels, summary.chunk_indexes) == ({}, {}, [])
    assert list(make_reader(BytesIO(data), validate_crcs=True).iter_messages()) == []
    kinds = [type(record) for record in all_records(data)]
    assert kinds == [
        records.Header,
        records.DataEnd,
        records.Statistics,
        records.SummaryOffset,
        records.Footer,
    ]
    (offset,) = summary_offsets(data)
    assert offset.group_opcode == Opcode.STATISTICS


def test_a_message_at_time_zero_starts_the_file() -> None:
    sink = BytesIO()
    writer = McapWriter(sink, "")
    writer.add_channel(CHANNELS[1])
    for times in ([5, 6], [0], [7]):
        payload = np.zeros((len(times), 1), np.uint8)
        records_ = stamped(4, np.array(times, np.int64), payload)
        for chunk in finish_chunks(in_time_order([records_]), "none"):
            writer.add_chunk(chunk)
    writer.finish()
    summary = make_reader(BytesIO(sink.getvalue())).get_summary()
    assert summary is not None
    assert summary.statistics is not None
    assert summary.statistics.message_start_time == 0
    assert summary.statistics.message_end_time == 7
