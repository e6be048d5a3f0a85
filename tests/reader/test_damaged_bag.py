"""ROS 1 bags with damaged indexes, headers, lengths and chunks: what is lost, and what is said."""

import struct
from pathlib import Path

import numpy as np
import pytest

from tests.reader.bag_bytes import (
    CODECS,
    MAGIC,
    SECOND,
    U32,
    BagBytes,
    Connection,
    Message,
    bag_header,
    small_bag,
)
from tests.reader.reading import assert_all_there, read_built, read_bytes, written_bag

START = len(MAGIC) + 4096
"""Where the first chunk begins."""


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
