"""MCAP files, sound and harmed; the sound ones against the mcap library."""

import io
import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from mcap.reader import make_reader
from mcap.writer import CompressionType, IndexType
from mcap.writer import Writer as McapWriter

from tests.reader import mcap_bytes
from tests.reader.mcap_bytes import (
    CODECS,
    MAGIC,
    McapBytes,
    Message,
    record,
    resealed,
    small_mcap,
)
from tests.reader.reading import Read, Reading, read_bytes, written_mcap

OPTIONS: dict[str, dict[str, Any]] = {
    "as usual": {},
    "no summary": {"summary": False},
    "no statistics": {"statistics": False},
    "nothing repeated": {"repeated": False},
    "no message index": {"message_index": False},
    "no checksums": {"chunk_crc": False, "data_crc": False},
    "no chunks": {"chunked": False},
    "no chunks, no summary": {"chunked": False, "summary": False},
}


def by_mcap(data: bytes) -> list[Read]:
    reader = make_reader(io.BytesIO(data), validate_crcs=True)
    return [
        Read(channel.topic, message.log_time, message.data)
        for _, channel, message in reader.iter_messages(log_time_order=False)
    ]


def assert_all_there(reading: Reading, mcap: McapBytes) -> None:
    assert list(reading.messages) == written_mcap(mcap)
    assert sum(reading.counts.values()) == len(reading.messages)


@pytest.mark.parametrize("compression", CODECS)
@pytest.mark.parametrize("name", OPTIONS)
def test_an_mcap_by_hand(tmp_path: Path, compression: str, name: str) -> None:
    mcap = small_mcap(compression)
    for option, value in OPTIONS[name].items():
        setattr(mcap, option, value)
    data = mcap.build()
    reading = read_bytes(tmp_path, data)
    assert_all_there(reading, mcap)
    assert not reading.losses
    assert reading.profile == "ros1"
    times = [message.log_time for message in reading.messages]
    assert reading.times == (min(times), max(times))
    if mcap.chunked:
        assert all(chunk.whole for chunk in reading.chunks)
        assert all(chunk.indexed == mcap.message_index for chunk in reading.chunks)
    if mcap.repeated:
        assert sorted(by_mcap(data)) == sorted(reading.messages)


@pytest.mark.parametrize("compression", CompressionType)
@pytest.mark.parametrize("chunked", [False, True])
@pytest.mark.parametrize("index_types", [IndexType.ALL, IndexType.NONE, IndexType.CHUNK])
@pytest.mark.parametrize("repeat", [False, True])
def test_an_mcap_by_the_library(
    tmp_path: Path,
    compression: CompressionType,
    index_types: IndexType,
    *,
    chunked: bool,
    repeat: bool,
) -> None:
    stream = io.BytesIO()
    writer = McapWriter(
        stream,
        chunk_size=500,
        compression=compression,
        index_types=index_types,
        use_chunking=chunked,
        repeat_channels=repeat,
        repeat_schemas=repeat,
        enable_data_crcs=True,
    )
    writer.start(profile="ros2")
    schema = writer.register_schema("std_msgs/msg/String", "ros2msg", b"string data")
    channels = [writer.register_channel(topic, "cdr", schema) for topic in ("/a", "/b")]
    for row in range(100):
        writer.add_message(channels[row % 2], row * 10, bytes([row] * 9), row * 10 + 1, row)
    writer.add_attachment(1, 2, "notes", "text/plain", b"muddy ground")
    writer.add_metadata("robot", {"name": "dogbot"})
    writer.finish()
    reading = read_bytes(tmp_path, stream.getvalue())
    assert not reading.losses
    assert [m.payload[0] for m in reading.messages] == list(range(100))
    assert reading.counts == {"/a": 50, "/b": 50}
    assert [extra.opcode for extra in reading.extras] == [9, 12]
    assert reading.profile == "ros2"


def test_messages_in_and_outside_chunks(tmp_path: Path) -> None:
    mcap = small_mcap()
    bare = Message(1, 7, b"bare")
    for place in ("before", "between", "behind"):
        data = mcap_with(mcap, place, bare.record())
        reading = read_bytes(tmp_path, data)
        expected = [*written_mcap(mcap), Read("/left", 7, b"bare")]
        assert sorted(reading.messages) == sorted(expected)
        mcap = small_mcap()


def mcap_with(mcap: McapBytes, where: str, extra: bytes) -> bytes:
    """Return the file without a summary, and with more bytes in its data section."""
    mcap.summary = mcap.data_crc = False
    data = mcap.build()
    place = {
        "before": mcap.chunk_starts[0],
        "between": mcap.chunk_starts[1],
        "behind": mcap.data_end,
    }[where]
    return data[:place] + extra + data[place:]


def test_times_beyond_63_bits_are_left_out_and_counted(tmp_path: Path) -> None:
    for chunked in (True, False):
        mcap = McapBytes([[Message(1, 5, b"a"), Message(1, 2**64 - 1, b"b"), Message(2, 9, b"c")]])
        mcap.chunked = chunked
        reading = read_bytes(tmp_path, mcap.build())
        assert [message.payload for message in reading.messages] == [b"a", b"c"]
        assert reading.lost == 1
        assert "after the year 2262" in reading.sentences
        assert reading.times == (5, 9)
        assert not any(chunk.whole for chunk in reading.chunks)


def test_attachments_and_metadata_are_found(tmp_path: Path) -> None:
    extras = [
        mcap_bytes.attachment("notes", b"x" * 1000),
        mcap_bytes.metadata("robot", {"name": "dogbot"}),
    ]
    for summary in (False, True):
        mcap = small_mcap()
        mcap.extras, mcap.summary = extras, summary
        data = mcap.build()
        reading = read_bytes(tmp_path, data)
        assert not reading.losses
        found = [data[e.offset : e.offset + e.size] for e in reading.extras]
        assert found == extras


@pytest.mark.parametrize("compression", CODECS)
@pytest.mark.parametrize("summary", [False, True])
def test_a_chunk_whose_checksum_does_not_hold_is_left_out_whole(
    tmp_path: Path, compression: str, *, summary: bool
) -> None:
    mcap = small_mcap(compression)
    mcap.summary, mcap.data_crc = summary, False
    data = bytearray(mcap.build())
    data[mcap.chunk_starts[1] + 9 + 24] ^= 1  # the checksum itself
    reading = read_bytes(tmp_path, bytes(data))
    written = written_mcap(mcap)
    assert list(reading.messages) == written[:4] + written[8:]
    assert [loss.what for loss in reading.losses] == [
        f"the chunk at byte {mcap.chunk_starts[1]} was left out: its checksum does not hold"
    ]
    assert reading.lost == 4
    assert 0 < reading.losses[0].bytes < mcap.chunk_ends[1] - mcap.chunk_starts[1]


def test_a_payload_flipped_in_an_uncompressed_chunk_is_seen(tmp_path: Path) -> None:
    mcap = small_mcap("")
    mcap.data_crc = False
    data = mcap.build().replace(b"payload12", b"payload92")
    reading = read_bytes(tmp_path, data)
    assert len(reading.messages) == 8
    assert reading.lost == 4


@pytest.mark.parametrize("shift", [-1, 1, 20, 1 << 40])
def test_wrong_offsets_in_a_summary_whose_checksum_holds(tmp_path: Path, shift: int) -> None:
    mcap = small_mcap()
    data = mcap.build()
    for number, place in enumerate(mcap.chunk_starts):
        old = struct.pack("<Q", place)
        at = data.rindex(old)
        assert at > mcap.summary_start, number
        data = data[:at] + struct.pack("<Q", place + shift) + data[at + 8 :]
    reading = read_bytes(tmp_path, resealed(data, mcap))
    assert_all_there(reading, mcap)
    assert "the summary contradicts itself or the chunks" in reading.sentences
    assert reading.lost == 0


def test_a_chunk_that_the_summary_does_not_name(tmp_path: Path) -> None:
    mcap = small_mcap()
    data = mcap.build()
    short = small_mcap(chunks=2)
    short.build()
    short_data = short.build()
    # The summary of a file with two chunks, at the end of one with three.
    summary = short_data[short.summary_start :]
    moved = struct.pack("<Q", short.summary_start)
    at = summary.rindex(moved)
    summary = summary[:at] + struct.pack("<Q", mcap.summary_start) + summary[at + 8 :]
    reading = read_bytes(tmp_path, resealed(data[: mcap.summary_start] + summary, mcap))
    assert_all_there(reading, mcap)
    assert reading.losses


@pytest.mark.parametrize("compression", CODECS)
@pytest.mark.parametrize("field", [0, 1, 9, 17, 25, 37])
def test_a_damaged_chunk_header_costs_nothing_with_a_summary(
    tmp_path: Path, compression: str, field: int
) -> None:
    mcap = small_mcap(compression)
    mcap.data_crc = False
    data = bytearray(mcap.build())
    data[mcap.chunk_starts[1] + field] ^= 2
    reading = read_bytes(tmp_path, bytes(data))
    assert_all_there(reading, mcap)
    assert f"the header of the chunk at byte {mcap.chunk_starts[1]}" in reading.sentences
    assert [chunk.whole for chunk in reading.chunks] == [True, False, True]


@pytest.mark.parametrize("compression", CODECS)
@pytest.mark.parametrize("place", [0, 1, 3])
def test_a_damaged_record_head_leaves_the_other_chunks(
    tmp_path: Path, compression: str, place: int
) -> None:
    mcap = small_mcap(compression)
    mcap.summary = mcap.data_crc = False
    data = bytearray(mcap.build())
    data[mcap.chunk_starts[1] + place] ^= 0x11
    reading = read_bytes(tmp_path, bytes(data))
    written = written_mcap(mcap)
    assert list(reading.messages) in (written, written[:4] + written[8:])
    assert reading.losses or list(reading.messages) == written


@pytest.mark.parametrize("rubbish", [b"\0" * 9000, b"\xff" * 300, b"\x05\x16\0\0\0" * 400])
@pytest.mark.parametrize("compression", CODECS)
def test_rubbish_between_chunks(tmp_path: Path, compression: str, rubbish: bytes) -> None:
    mcap = small_mcap(compression)
    data = mcap_with(mcap, "between", rubbish)
    reading = read_bytes(tmp_path, data)
    assert list(reading.messages) == written_mcap(mcap)
    place = mcap.chunk_starts[1]
    assert reading.sentences == f"the {len(rubbish)} bytes from byte {place} on are no record"
    assert reading.losses[0].bytes == len(rubbish)


@pytest.mark.parametrize("by", [-3, 4, 60, 1 << 20, 1 << 62])
def test_a_wrong_length_outside_chunks_costs_one_message(tmp_path: Path, by: int) -> None:
    mcap = small_mcap()
    mcap.chunked = mcap.summary = mcap.data_crc = False
    data = mcap.build()
    written_record = mcap.chunks[1][2].record()
    place = data.index(written_record)
    length = struct.pack("<Q", len(written_record) - 9 + by)
    reading = read_bytes(tmp_path, data[: place + 1] + length + data[place + 9 :])
    written = written_mcap(mcap)
    del written[6]
    assert list(reading.messages) == written
    assert sum(loss.bytes for loss in reading.losses) == len(written_record)


def test_a_wrong_message_index_is_said_and_not_believed(tmp_path: Path) -> None:
    mcap = small_mcap()
    mcap.data_crc = False
    data = bytearray(mcap.build())
    data[mcap.chunk_ends[1] + 9 + 6] ^= 1  # the first entry's time
    reading = read_bytes(tmp_path, bytes(data))
    assert_all_there(reading, mcap)
    assert reading.sentences == (
        f"the index of the chunk at byte {mcap.chunk_starts[1]} is wrong; it was read without it"
    )
    assert [chunk.whole for chunk in reading.chunks] == [True, False, True]


@pytest.mark.parametrize("offset", [10**6, 2**63 - 1, 2**63, 2**64 - 1])
def test_a_message_index_that_points_out_of_its_chunk(tmp_path: Path, offset: int) -> None:
    mcap = small_mcap()
    mcap.data_crc = False
    data = bytearray(mcap.build())
    struct.pack_into("<Q", data, mcap.chunk_ends[1] + 9 + 6 + 8, offset)
    reading = read_bytes(tmp_path, bytes(data))
    assert_all_there(reading, mcap)
    assert "is wrong; it was read without it" in reading.sentences


def test_messages_of_channels_that_are_nowhere_described(tmp_path: Path) -> None:
    lone = McapBytes([[Message(1, 5, b"a"), Message(77, 6, b"bb"), Message(2, 7, b"c")]])
    lone.summary = False
    reading = read_bytes(tmp_path, lone.build())
    assert [message.payload for message in reading.messages] == [b"a", b"c"]
    assert reading.lost == 1
    assert reading.losses[0].bytes == 2
    assert "nowhere described" in reading.sentences


@pytest.mark.parametrize("name", [b"/\xff\xfe", b"/a\0b", b"", b"/" + b"long" * 10_000])
def test_names_that_are_no_text(tmp_path: Path, name: bytes) -> None:
    described = mcap_bytes.schema(1) + mcap_bytes.channel(1, name)
    data = MAGIC + mcap_bytes.file_header() + described + Message(1, 5, b"payload").record()
    data += record(mcap_bytes.DATA_END, bytes(4))
    data += struct.pack("<BQQQI", mcap_bytes.FOOTER, 20, 0, 0, 0) + MAGIC
    reading = read_bytes(tmp_path, data)
    assert [message.payload for message in reading.messages] == [b"payload"]
    assert not reading.losses


def test_a_channel_described_in_two_ways_is_said(tmp_path: Path) -> None:
    mcap = small_mcap()
    data = mcap_with(mcap, "behind", mcap_bytes.channel(1, "/other"))
    reading = read_bytes(tmp_path, data)
    assert list(reading.messages) == written_mcap(mcap)
    assert "channel 1 is described in two ways" in reading.sentences


HARMS: dict[str, Callable[[bytes], bytes]] = {
    "no end": lambda data: data[:-1],
    "no footer": lambda data: data[:-37],
    "damaged footer": lambda data: data[:-30] + b"\xff" + data[-29:],
    "damaged header": lambda data: data[:9] + b"\xff" + data[10:],
    "bytes behind the end": lambda data: data + b"rubbish",
    "another file behind the end": lambda data: data + small_mcap(chunks=1).build(),
}


@pytest.mark.parametrize("harm", HARMS)
@pytest.mark.parametrize("compression", CODECS)
def test_damage_of_the_file_as_such_costs_no_message(
    tmp_path: Path, compression: str, harm: str
) -> None:
    mcap = small_mcap(compression)
    reading = read_bytes(tmp_path, HARMS[harm](mcap.build()))
    assert_all_there(reading, mcap)
    assert reading.losses


@pytest.mark.parametrize("size", range(8, 40))
def test_a_file_with_hardly_anything_in_it(tmp_path: Path, size: int) -> None:
    reading = read_bytes(tmp_path, small_mcap().build()[:size])
    assert not reading.messages
    assert reading.losses


def unchunked(*records: bytes) -> bytes:
    """Return a file without chunks and summary, whose recording was closed."""
    ending = record(mcap_bytes.DATA_END, bytes(4)) + record(mcap_bytes.FOOTER, bytes(20))
    described = mcap_bytes.schema(1) + mcap_bytes.channel(1, "/left")
    return b"".join([MAGIC, mcap_bytes.file_header(), described, *records, ending, MAGIC])


@pytest.mark.parametrize("opcode", [0x10, 0x7F, 0x80])
def test_a_record_of_an_unknown_kind_costs_no_message(tmp_path: Path, opcode: int) -> None:
    messages = [Message(1, 10**9 + number, b"x" * number) for number in range(10)]
    records = [message.record() for message in messages]
    records.insert(5, record(opcode, b"\xff" * 30))
    reading = read_bytes(tmp_path, unchunked(*records))
    assert list(reading.messages) == [Read("/left", m.log_time, m.payload) for m in messages]
    # One of an application is passed over; one that no version of MCAP has may be damage.
    assert bool(reading.losses) == (opcode < 0x80)


@pytest.mark.parametrize("described", [True, False])
def test_messages_in_front_of_their_channels_description(
    tmp_path: Path, *, described: bool
) -> None:
    left, right = (
        [Message(number, 10**9 + row, b"x" * row) for row in range(10)] for number in (1, 2)
    )
    records = [message.record() for message in left]
    records += [mcap_bytes.metadata("between", {}), *(message.record() for message in right)]
    records += [mcap_bytes.channel(2, "/right")] if described else []
    reading = read_bytes(tmp_path, unchunked(*records))
    expected = [Read("/left", m.log_time, m.payload) for m in left]
    expected += [Read("/right", m.log_time, m.payload) for m in right] if described else []
    assert list(reading.messages) == expected
    assert reading.lost == 20 - len(expected)
    assert ("10 messages of channels that are nowhere described" in reading.sentences) != described


def test_a_schema_that_is_nowhere_described_is_said(tmp_path: Path) -> None:
    message = Message(2, 5, b"a")
    reading = read_bytes(tmp_path, unchunked(mcap_bytes.channel(2, "/right", 7), message.record()))
    assert list(reading.messages) == [Read("/right", 5, b"a")]
    assert reading.sentences.startswith("schema 7 of /right is nowhere described")
    assert reading.lost == 0
