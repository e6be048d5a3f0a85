"""ROS 1 bags, sound and harmed; the sound ones against rosbags, message by message."""

import struct
from pathlib import Path

import lz4.frame
import numpy as np
import pytest
from rosbags.rosbag1 import Reader as BagReader
from rosbags.rosbag1 import Writer as BagWriter
from rosbags.typesys import Stores, get_typestore

from tests.reader.bag_bytes import (
    CODECS,
    MAGIC,
    SECOND,
    TYPE,
    U32,
    BagBytes,
    Connection,
    Message,
    bag_header,
    small_bag,
)
from tests.reader.reading import Read, Reading, read_bytes, read_file, written_bag

START = len(MAGIC) + 4096
"""Where the first chunk begins."""


def by_rosbags(path: Path) -> list[Read]:
    with BagReader(path) as reader:
        return [
            Read(connection.topic, time, bytes(data))
            for connection, time, data in reader.messages()
        ]


def read_built(folder: Path, bag: BagBytes) -> Reading:
    return read_bytes(folder, bag.build())


def assert_all_there(reading: Reading, bag: BagBytes) -> None:
    assert list(reading.messages) == written_bag(bag)
    assert sum(reading.counts.values()) == len(reading.messages)


@pytest.mark.parametrize("compression", CODECS)
def test_a_bag_by_hand_is_read_as_rosbags_reads_it(tmp_path: Path, compression: str) -> None:
    bag = small_bag(compression)
    path = tmp_path / "log.bag"
    path.write_bytes(bag.build())
    reading = read_file(path)
    assert_all_there(reading, bag)
    assert not reading.losses
    assert all(chunk.whole and chunk.indexed for chunk in reading.chunks)
    assert sorted(reading.messages) == sorted(by_rosbags(path))
    times = [message.log_time for message in reading.messages]
    assert reading.times == (min(times), max(times))
    assert reading.topics == (
        ("/left", TYPE, b"string data\n"),
        ("/right", TYPE, b"string data\n"),
    )


@pytest.mark.parametrize("compression", [None, *BagWriter.CompressionFormat])
def test_a_bag_by_rosbags_is_read_as_rosbags_reads_it(
    tmp_path: Path, compression: BagWriter.CompressionFormat | None
) -> None:
    path = tmp_path / "log.bag"
    store = get_typestore(Stores.ROS1_NOETIC)
    writer = BagWriter(path)
    writer.chunk_threshold = 2000
    if compression is not None:
        writer.set_compression(compression)
    with writer:
        connections = [
            writer.add_connection(topic, "std_msgs/msg/String", typestore=store, callerid=caller)
            for topic, caller in [("/a", "/one"), ("/a", "/two"), ("/b", None)]
        ]
        for row in range(500):
            data = struct.pack("<I", 6) + f"row{row:03}".encode()
            writer.write(connections[row % 3], row * 7_000_000, data)
    reading = read_file(path)
    assert sorted(reading.messages) == sorted(by_rosbags(path))
    assert len(reading.chunks) > 3
    assert not reading.losses
    assert reading.counts == {"/a": 334, "/b": 166}


def test_connections_of_one_topic_keep_their_own_definitions(tmp_path: Path) -> None:
    bag = BagBytes(
        [[Message(0, 1, b"one"), Message(7, 2, b"two"), Message(3, 3, b"three")]],
        [
            Connection(0, "/foot", extra={"callerid": b"/first"}),
            Connection(7, "/foot", extra={"callerid": b"/second", "latching": b"1"}),
            Connection(3, "/foot", "other_msgs/String", "string text\n"),
        ],
    )
    reading = read_built(tmp_path, bag)
    assert_all_there(reading, bag)
    assert [topic for topic, _, _ in reading.topics] == ["/foot"] * 3
    assert {kind for _, kind, _ in reading.topics} == {TYPE, "other_msgs/String"}


@pytest.mark.parametrize("compression", CODECS)
def test_connections_only_in_chunks(tmp_path: Path, compression: str) -> None:
    bag = small_bag(compression)
    bag.indexed = False
    reading = read_built(tmp_path, bag)
    assert_all_there(reading, bag)
    assert "has no index" in reading.sentences
    assert reading.lost == 0


def test_connections_only_in_the_index(tmp_path: Path) -> None:
    bag = small_bag()
    bag.in_chunks = False
    reading = read_built(tmp_path, bag)
    assert_all_there(reading, bag)
    assert not reading.losses


@pytest.mark.parametrize("zeros", [1, 49, 4000])
@pytest.mark.parametrize("counted", [False, True])
def test_zero_bytes_before_the_index(tmp_path: Path, zeros: int, *, counted: bool) -> None:
    bag = small_bag()
    bag.zeros = zeros
    data = bytearray(bag.build())
    if not counted:
        head = bag_header(bag.index_place - zeros, 2, 3)
        data[len(MAGIC) : len(MAGIC) + len(head)] = head
    reading = read_bytes(tmp_path, bytes(data))
    assert_all_there(reading, bag)
    assert not reading.losses


@pytest.mark.parametrize(
    "options",
    [
        {"block_linked": True, "block_size": lz4.frame.BLOCKSIZE_MAX64KB},
        {"store_size": True, "content_checksum": True},
        {"store_size": False, "block_checksum": True},
    ],
)
def test_lz4_frames_of_other_kinds(tmp_path: Path, options: dict[str, object]) -> None:
    bag = small_bag("lz4", each=3000)
    bag.compress = lambda data: bytes(lz4.frame.compress(data, **options))
    reading = read_built(tmp_path, bag)
    assert_all_there(reading, bag)
    assert not reading.losses


def test_a_bag_without_chunks_is_an_empty_log(tmp_path: Path) -> None:
    bag = BagBytes([], [Connection(0, "/left")])
    reading = read_built(tmp_path, bag)
    assert not reading.messages
    assert not reading.losses
    assert reading.times == (None, None)


def harm(data: bytes, place: int, new: bytes) -> bytes:
    return data[:place] + new + data[place + len(new) :]


def insert_before(data: bytes, marker: bytes, new: bytes, nth: int = 0) -> tuple[bytes, int]:
    place = -1
    for _ in range(nth + 1):
        place = data.index(marker, place + 1)
    return harm(data, place, new), place


@pytest.mark.parametrize("index_place", [1, 4096, 5000, 1 << 20, 1 << 62])
def test_an_index_that_is_not_there(tmp_path: Path, index_place: int) -> None:
    bag = small_bag()
    data = harm(bag.build(), len(MAGIC), bag_header(index_place, 2, 3))
    reading = read_bytes(tmp_path, data)
    assert_all_there(reading, bag)
    assert "index is damaged" in reading.sentences
    assert reading.lost == 0


@pytest.mark.parametrize("counts", [(2, 2), (2, 4), (2, 0xFFFFFFFF)])
def test_a_wrong_number_of_chunks(tmp_path: Path, counts: tuple[int, int]) -> None:
    bag = small_bag()
    bag.build()
    data = harm(small_bag().build(), len(MAGIC), bag_header(bag.index_place, *counts))
    reading = read_bytes(tmp_path, data)
    assert_all_there(reading, bag)
    assert "another number of chunks" in reading.sentences


def test_a_wrong_number_of_messages_in_the_index_is_said_once(tmp_path: Path) -> None:
    bag = small_bag()
    data = bag.build()
    place = data.rindex(U32.pack(0) + U32.pack(2))  # the last chunk's: connection 0, two messages
    reading = read_bytes(tmp_path, harm(data, place + 4, U32.pack(9)))
    assert list(reading.messages) == written_bag(bag)
    what = f"the chunk at byte {bag.chunk_starts[2]} holds 4 messages where the log's index names"
    assert [loss.what.startswith(what) for loss in reading.losses] == [True]


def test_a_chunk_that_the_index_does_not_name(tmp_path: Path) -> None:
    bag = small_bag()
    data = bag.build()
    last_info = data.rindex(b"ver=") - 16
    head = bag_header(bag.index_place, 2, 2)
    reading = read_bytes(tmp_path, harm(data[:last_info], len(MAGIC), head))
    assert_all_there(reading, bag)
    assert "contradicts the chunks" in reading.sentences


def test_a_wrong_index_of_one_chunk(tmp_path: Path) -> None:
    bag = small_bag()
    data = bag.build()
    place = bag.chunk_ends[1] + 55  # the first entry's time
    reading = read_bytes(tmp_path, harm(data, place + 8, U32.pack(3)))  # its offset
    assert_all_there(reading, bag)
    assert f"the index of the chunk at byte {bag.chunk_starts[1]} is wrong" in reading.sentences
    assert reading.lost == 0
    assert [chunk.whole for chunk in reading.chunks] == [True, False, True]


def test_a_time_that_the_index_tells_otherwise_costs_the_message(tmp_path: Path) -> None:
    bag = small_bag()
    data = bag.build()
    second = bag.chunks[1][1]
    harmed, _ = insert_before(
        data,
        struct.pack("<II", *divmod(second.log_time, SECOND)),
        struct.pack("<II", *divmod(second.log_time + 1, SECOND)),
    )
    reading = read_bytes(tmp_path, harmed)
    written = written_bag(bag)
    del written[5]
    assert list(reading.messages) == written
    assert "the index tells another time or channel" in reading.sentences
    assert reading.lost == 1


@pytest.mark.parametrize("indexed", [False, True])
def test_a_time_outside_the_chunks_range_costs_the_message(
    tmp_path: Path, *, indexed: bool
) -> None:
    bag = small_bag()
    data = bag.build()
    second = bag.chunks[1][1]
    harmed, _ = insert_before(
        data,
        struct.pack("<II", *divmod(second.log_time, SECOND)),
        struct.pack("<II", 5, 5),
    )
    if not indexed:
        # The chunks' own index records are gone; the index section still knows their times.
        harmed = harmed.replace(b"op=\x04", b"op=\x14")
    reading = read_bytes(tmp_path, harmed)
    written = written_bag(bag)
    del written[5]
    assert list(reading.messages) == written
    assert sum(loss.messages or 0 for loss in reading.losses) == 1


def test_a_range_of_times_that_all_messages_deny(tmp_path: Path) -> None:
    bag = small_bag()
    data = bag.build()
    times = [struct.pack("<II", *divmod(m.log_time, SECOND)) for m in bag.chunks[2]]
    place = data.rindex(times[-1])
    reading = read_bytes(tmp_path, harm(data, place, struct.pack("<II", 1, 1)))
    assert_all_there(reading, bag)
    assert "range of times" in reading.sentences
    assert reading.lost == 0


@pytest.mark.parametrize("indexed", [False, True])
@pytest.mark.parametrize(("field", "new"), [(b"conn=", b"cann="), (b"op=\x02", b"op=\x42")])
def test_a_damaged_header_costs_one_message(
    tmp_path: Path, field: bytes, new: bytes, *, indexed: bool
) -> None:
    bag = small_bag()
    bag.indexed = indexed
    data = bag.build()
    record = bag.chunks[1][2].record()
    place = data.index(record) + record.index(field)
    reading = read_bytes(tmp_path, harm(data, place, new))
    written = written_bag(bag)
    del written[6]
    assert list(reading.messages) == written
    assert reading.lost == 1
    assert "is no record" in reading.sentences or "are no record" in reading.sentences
    loss = next(loss for loss in reading.losses if loss.bytes)
    assert loss.offset == data.index(record)
    assert loss.bytes == len(record)


@pytest.mark.parametrize("indexed", [False, True])
@pytest.mark.parametrize("by", [-3, 4, 60, 1 << 20])
def test_a_wrong_length_costs_one_message(tmp_path: Path, by: int, *, indexed: bool) -> None:
    bag = small_bag()
    bag.indexed = indexed
    data = bag.build()
    message = bag.chunks[1][2]
    record = message.record()
    place = data.index(record) + len(record) - len(message.payload) - 4
    length = U32.pack(len(message.payload) + by)
    reading = read_bytes(tmp_path, harm(data, place, length))
    written = written_bag(bag)
    del written[6]
    assert list(reading.messages) == written
    assert reading.lost == 1


@pytest.mark.parametrize("indexed", [False, True])
@pytest.mark.parametrize("compression", ["bz2", "lz4"])
def test_a_damaged_compressed_chunk_is_counted_from_its_index(
    tmp_path: Path, compression: str, *, indexed: bool
) -> None:
    bag = small_bag(compression)
    bag.indexed = indexed
    data = bytearray(bag.build())
    data[bag.chunk_ends[1] - 20] ^= 0xFF
    reading = read_bytes(tmp_path, bytes(data))
    written = written_bag(bag)
    assert list(reading.messages) == written[:4] + written[8:]
    assert reading.lost == 4
    loss = next(loss for loss in reading.losses if loss.messages)
    assert loss.offset == bag.chunk_starts[1]
    assert loss.what.startswith(f"the chunk at byte {loss.offset} was left out: its {compression}")
    assert 0 < loss.bytes < bag.chunk_ends[1] - bag.chunk_starts[1]


@pytest.mark.parametrize("compression", CODECS)
@pytest.mark.parametrize("field", [b"compression=", b"size=", b"op="])
def test_a_chunk_whose_header_is_damaged_leaves_the_others(
    tmp_path: Path, compression: str, field: bytes
) -> None:
    bag = small_bag(compression)
    data = bag.build()
    place = data.index(field, bag.chunk_starts[1])
    reading = read_bytes(tmp_path, harm(data, place, b"?"))
    written = written_bag(bag)
    got = set(reading.messages)
    assert {*written[:4], *written[8:]} <= got <= set(written)
    assert reading.losses or got == set(written)


def test_a_damaged_header_of_an_uncompressed_chunk_costs_nothing(tmp_path: Path) -> None:
    bag = small_bag()
    data = bag.build()
    place = data.index(b"compression=", bag.chunk_starts[1])
    reading = read_bytes(tmp_path, harm(data, place, b"?"))
    assert list(reading.messages) == written_bag(bag)


@pytest.mark.parametrize("rubbish", [b"\0" * 9000, b"\xff" * 300, b"op=\x05" * 500])
@pytest.mark.parametrize("compression", CODECS)
def test_rubbish_between_chunks(tmp_path: Path, compression: str, rubbish: bytes) -> None:
    bag = small_bag(compression)
    data = bag.build()
    place = bag.chunk_starts[1]
    reading = read_bytes(tmp_path, data[:place] + rubbish + data[place:])
    assert list(reading.messages) == written_bag(bag)
    assert f"the {len(rubbish)} bytes from byte {place} on are no record" in reading.sentences
    assert sum(loss.bytes for loss in reading.losses) == len(rubbish)


def test_messages_of_connections_that_are_nowhere_described(tmp_path: Path) -> None:
    bag = small_bag()
    bag.in_chunks = False
    bag.indexed = False
    reading = read_built(tmp_path, bag)
    assert not reading.messages
    assert reading.lost == 12
    assert "nowhere described" in reading.sentences
    assert sum(loss.bytes for loss in reading.losses) == 12 * 13


def test_names_that_are_no_text(tmp_path: Path) -> None:
    bag = small_bag()
    data = bag.build().replace(b"/left", b"/\xff\0\nt")
    reading = read_bytes(tmp_path, data)
    assert sorted(reading.counts.values()) == [6, 6]
    assert not reading.losses


def test_the_header_record_is_damaged(tmp_path: Path) -> None:
    bag = small_bag()
    data = harm(bag.build(), len(MAGIC), b"\xff" * 40)
    reading = read_bytes(tmp_path, data)
    assert list(reading.messages) == written_bag(bag)
    assert reading.losses


def test_a_second_bag_behind_the_first_is_left_out(tmp_path: Path) -> None:
    """Its connections have the same numbers, but are others."""
    bag = small_bag()
    data = bag.build()
    other = BagBytes([[Message(0, 5, b"other")]], [Connection(0, "/other")]).build()
    reading = read_bytes(tmp_path, data + other)
    assert_all_there(reading, bag)
    assert f"the {len(other)} bytes behind the end of the recording" in reading.sentences


def test_a_cut_bz2_chunk_gives_its_whole_blocks(tmp_path: Path) -> None:
    bag = BagBytes(
        [[Message(0, row + 1, np.random.default_rng(row).bytes(50_000)) for row in range(60)]],
        [Connection(0, "/left")],
        "bz2",
    )
    data = bag.build()[: bag.chunk_ends[0] - 100]
    reading = read_bytes(tmp_path, data)
    written = written_bag(bag)
    assert list(reading.messages) == written[: len(reading.messages)]
    assert len(reading.messages) > 50
    assert "are damaged or cut off" in reading.sentences
