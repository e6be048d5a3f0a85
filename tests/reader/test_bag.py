"""ROS 1 bags that are sound, against rosbags, message by message."""

import struct
from pathlib import Path

import lz4.frame
import pytest
from rosbags.rosbag1 import Reader as BagReader
from rosbags.rosbag1 import Writer as BagWriter
from rosbags.typesys import Stores, get_typestore

from tests.reader.bag_bytes import (
    CODECS,
    MAGIC,
    TYPE,
    BagBytes,
    Connection,
    Message,
    bag_header,
    small_bag,
)
from tests.reader.reading import Read, assert_all_there, read_built, read_bytes, read_file


def by_rosbags(path: Path) -> list[Read]:
    with BagReader(path) as reader:
        return [
            Read(connection.topic, time, bytes(data))
            for connection, time, data in reader.messages()
        ]


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
