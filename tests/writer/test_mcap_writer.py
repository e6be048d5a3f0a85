"""The output file, as the mcap library reads it from both ends."""

import zlib
from collections import Counter
from collections.abc import Iterator
from io import BytesIO
from pathlib import Path
from typing import get_args

import pytest
from mcap import records
from mcap.data_stream import ReadDataStream, RecordBuilder
from mcap.opcode import Opcode
from mcap.reader import make_reader
from mcap.stream_reader import StreamReader, breakup_chunk

from dogbot_logtool.commands.convert import convert
from dogbot_logtool.options.convert import ConvertOptions
from dogbot_logtool.writer.chunks import Compression
from dogbot_logtool.writer.mcap_writer import MAGIC
from tests.oracles.ros1_logs import small_walk, write_ros1_mcap

COMPRESSIONS: tuple[Compression, ...] = get_args(Compression)


@pytest.fixture(scope="module")
def source(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("source") / "log.mcap"
    return write_ros1_mcap(path, small_walk(0.5), extras=True)


@pytest.fixture(scope="module", params=COMPRESSIONS)
def data(
    source: Path, tmp_path_factory: pytest.TempPathFactory, request: pytest.FixtureRequest
) -> bytes:
    """A converted log of some chunks, with attachments and metadata."""
    target = tmp_path_factory.mktemp("out") / "out.mcap"
    convert(source, target, ConvertOptions(compression=request.param))
    return target.read_bytes()


def all_records(data: bytes) -> list[records.McapRecord]:
    """Read from front to back; the library checks the checksums of chunks and of the data."""
    return list(StreamReader(BytesIO(data), validate_crcs=True).records)


def record_at(data: bytes, place: int) -> tuple[int, bytes]:
    size = int.from_bytes(data[place + 1 : place + 9], "little")
    return data[place], data[place : place + 9 + size]


def test_statistics(data: bytes) -> None:
    summary = make_reader(BytesIO(data)).get_summary()
    assert summary is not None
    statistics = summary.statistics
    assert statistics is not None
    found = Counter(type(record) for record in all_records(data))
    messages = [record for record in all_records(data) if isinstance(record, records.Message)]
    assert statistics.message_count == len(messages)
    counts = Counter(message.channel_id for message in messages)
    assert statistics.channel_message_counts == dict(counts)
    times = [message.log_time for message in messages]
    assert statistics.message_start_time == min(times)
    assert statistics.message_end_time == max(times)
    assert statistics.schema_count == len(summary.schemas)
    assert statistics.channel_count == len(summary.channels)
    assert statistics.attachment_count == found[records.Attachment] == 2
    assert statistics.metadata_count == found[records.Metadata] == 3
    assert statistics.chunk_count == len(summary.chunk_indexes)


def messages_of(chunk: records.Chunk) -> dict[int, records.Message]:
    """Return messages by the offset of their record."""
    found: dict[int, records.Message] = {}
    offset = 0
    for record in breakup_chunk(chunk, validate_crc=True):
        builder = RecordBuilder()
        record.write(builder)
        if isinstance(record, records.Message):
            found[offset] = record
        offset += len(builder.end())
    assert offset == chunk.uncompressed_size
    return found


def test_offsets_point_at_what_they_say(data: bytes) -> None:
    summary = make_reader(BytesIO(data)).get_summary()
    assert summary is not None
    for index in summary.chunk_indexes:
        opcode, record = record_at(data, index.chunk_start_offset)
        assert (opcode, len(record)) == (Opcode.CHUNK, index.chunk_length)
        chunk = records.Chunk.read(ReadDataStream(BytesIO(record[9:])))
        assert (index.compression, index.compressed_size) == (chunk.compression, len(chunk.data))
        assert index.uncompressed_size == chunk.uncompressed_size
        messages = messages_of(chunk)
        times = [message.log_time for message in messages.values()]
        for one in (index, chunk):
            assert (one.message_start_time, one.message_end_time) == (min(times), max(times))
        total = 0
        listed: list[int] = []
        for channel, place in index.message_index_offsets.items():
            opcode, record = record_at(data, place)
            entries = records.MessageIndex.read(ReadDataStream(BytesIO(record[9:])))
            assert (opcode, entries.channel_id) == (Opcode.MESSAGE_INDEX, channel)
            for time, offset in entries.records:
                assert (messages[offset].log_time, messages[offset].channel_id) == (time, channel)
                listed.append(offset)
            total += len(record)
        assert sorted(listed) == sorted(messages)
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
        assert described.name in {"weather", "nothing", "dogbot_logtool"}


def sections(data: bytes) -> tuple[records.Footer, records.DataEnd]:
    footer = records.Footer.read(ReadDataStream(BytesIO(data[-8 - 20 : -8])))
    place = footer.summary_start - 9 - 4
    assert data[place] == Opcode.DATA_END
    return footer, records.DataEnd.read(ReadDataStream(BytesIO(data[place + 9 :])))


def test_checksums(data: bytes) -> None:
    footer, data_end = sections(data)
    assert data_end.data_section_crc == zlib.crc32(data[: footer.summary_start - 13])
    assert footer.summary_crc == zlib.crc32(data[footer.summary_start : -8 - 4])
    assert (data[:8], data[-8:]) == (MAGIC, MAGIC)


def summary_offsets(data: bytes) -> Iterator[records.SummaryOffset]:
    for record in all_records(data):
        if isinstance(record, records.SummaryOffset):
            yield record


def test_summary_offsets_tile_the_summary(data: bytes) -> None:
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
