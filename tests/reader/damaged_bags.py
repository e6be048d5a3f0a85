"""Bags that are harmed in one place each."""

import struct
from collections.abc import Iterator
from typing import Final

from tests.reader import bag_bytes
from tests.reader.bag_bytes import SECOND, U32, BagBytes, Connection, bag_header, small_bag, time
from tests.reader.cases import ANY, BAG, RUBBISH, SECOND_CHUNK, Case, built, flipped, put


def bags_with_a_wrong_index() -> Iterator[Case]:
    bag, data = built(small_bag())
    second, start = bag.chunks[1][1], bag.chunk_starts[1]
    for place in (1, 4096, 5000, 1 << 20, 1 << 62):
        head = bag_header(place, 2, 3)
        yield Case(f"index at {place}", bag, put(data, 13, head), "index is damaged")
    for counts in ((2, 2), (2, 4), (2, 0xFFFFFFFF)):
        head = bag_header(bag.index_place, *counts)
        yield Case(f"{counts} chunks", bag, put(data, 13, head), "index is damaged")
    yield Case("bag's header", bag, put(data, 13, b"\xff" * 40), ANY, number=None)
    place = data.rindex(U32.pack(0) + U32.pack(2))  # the last chunk's: connection 0, two messages
    what = "the log's statistics count 13 messages of /left, but 6 were found"
    wrong = put(data, place + 4, U32.pack(9))
    yield Case("count in the index", bag, wrong, what, index_is_true=False)
    yield Case("connection in the index", bag, put(data, place, U32.pack(9)), "index is damaged")
    cut = put(data[: data.rindex(b"ver=") - 16], 13, bag_header(bag.index_place, 2, 2))
    yield Case("unnamed chunk", bag, cut, "index is damaged")
    what, lost = "its header counts 2 more chunks", tuple(range(4, 12))
    yield Case("cut between chunks", bag, data[:start], what, lost, number=None)
    what = f"the index of the chunk at byte {start} is wrong"
    wrong = put(data, bag.chunk_ends[1] + 55 + 8, U32.pack(3))  # the first entry's offset
    yield Case("offset in an index", bag, wrong, what, whole=(True, False, True))
    at = data.index(time(second.log_time))
    what = "the index tells another time or channel"
    yield Case("time", bag, put(data, at, time(second.log_time + 1)), what, (5,))
    shifted = data
    for message in bag.chunks[1]:
        at_index = data.index(time(message.log_time), bag.chunk_ends[1])
        shifted = put(shifted, at_index, time(message.log_time + SECOND))
    what = f"the index of the chunk at byte {start} is wrong"
    yield Case("all times of an index", bag, shifted, what)
    early = put(data, at, struct.pack("<II", 5, 5))
    yield Case("early", bag, early, ANY, (5,))
    # The chunks' own index records are gone; the index section still knows their times.
    yield Case("early, no index", bag, early.replace(b"op=\x04", b"op=\x14"), ANY, (5,))
    wrong = put(data, data.rindex(time(bag.chunks[2][-1].log_time)), struct.pack("<II", 1, 1))
    yield Case("range of times", bag, wrong, "range of times")
    for chunk, field in ((0, "start_time"), (2, "end_time")):
        true = bag.chunks[chunk][0 if chunk == 0 else -1].log_time
        for shift in (-SECOND, SECOND):
            name = field.encode() + b"="
            wrong = data.replace(name + time(true), name + time(true + shift))
            yield Case(f"{field} {shift}", bag, wrong, ANY)
    behind = BagBytes([[BAG(0, 5, b"other")]], [Connection(0, "/other")]).build()
    what = f"the {len(behind)} bytes behind the end of the recording"
    yield Case("second bag", bag, data + behind, what, number=None)


def bags_with_damaged_records() -> Iterator[Case]:
    for indexed in (False, True):
        bag, data = built(small_bag(), indexed=indexed)
        message = bag.chunks[1][2]
        whole = message.record()
        at = data.index(whole)
        for field, new in ((b"conn=", b"cann="), (b"op=\x02", b"op=\x42")):
            harmed = put(data, at + whole.index(field), new)
            yield Case("header", bag, harmed, "no record", (6,), bytes=len(whole))
        for by in (-3, 4, 60, 1 << 20):
            length = U32.pack(len(message.payload) + by)
            place = at + len(whole) - len(message.payload) - 4
            yield Case(f"length {by}", bag, put(data, place, length), ANY, (6,))
        for later in (
            Connection(0, "/other"),
            Connection(0, "/left", "std_msgs/Empty"),
            Connection(0, "/left", definition="string data\nbool more\n"),
        ):
            case = built(small_bag(), described_later={2: later.record()}, indexed=indexed)
            what = "connection 0 is described in two ways: as /left of type"
            yield Case("connection", *case, what)
            described = [Connection(0, "/left"), Connection(1, "/right"), later]
            case = built(small_bag(), in_index_section=described)
            yield Case("connection in index", *case, "index is damaged")


def bags_with_damaged_chunks() -> Iterator[Case]:
    swapped = [Connection(0, "/right"), Connection(1, "/left")]
    for compression in bag_bytes.CODECS:
        bag, data = built(small_bag(compression))
        start = bag.chunk_starts[1]
        for field in (b"compression=", b"size=", b"op="):
            harmed = put(data, data.index(field, start), b"?")
            yield Case(f"{field!r}", bag, harmed, ANY, SECOND_CHUNK, either=True, number=None)
        for rubbish in RUBBISH:
            what = f"the {len(rubbish)} bytes from byte {start} on are no record"
            harmed = data[:start] + rubbish + data[start:]
            yield Case("rubbish", bag, harmed, what, number=None, bytes=len(rubbish))
        gone, what = (
            data[:start] + data[bag.chunk_starts[2] :],
            "counts 12 messages, but 8 were found",
        )
        yield Case("a chunk is gone", bag, gone, what, SECOND_CHUNK, number=None)
        case = built(small_bag(compression), indexed=False)
        yield Case(f"{compression} without index", *case, "has no index")
        for indexed in (False, True) if compression != "none" else ():
            bag, data = built(small_bag(compression), indexed=indexed)
            what = f"the chunk at byte {bag.chunk_starts[1]} was left out: its {compression}"
            for place in (20, 1):
                harmed = flipped(data, bag.chunk_ends[1] - place, 0xFF)
                yield Case("data", bag, harmed, what, SECOND_CHUNK)
        case = built(small_bag(compression), in_index_section=swapped)
        start = case[0].chunk_starts[0]
        what = "connection 0 is described in two ways: as /right of type std_msgs/String and, at "
        what += f"byte {start}, as /left of type std_msgs/String; the former was used"
        yield Case("swapped", *case, what, tuple(range(12)), either=True, number=0)
    bag, data = built(small_bag())
    at = bag.chunk_starts[1] + 41  # in the chunk's header
    what = f"the 52 bytes from byte {bag.chunk_starts[1]} on are no record"
    yield Case("bytes in a head", bag, data[:at] + b"abc" + data[at:], what, number=None, bytes=52)
    lone = built(small_bag(), in_chunks=False, indexed=False)
    yield Case("undescribed", *lone, "nowhere described", tuple(range(12)), bytes=12 * 13)


DAMAGED: Final = (
    *bags_with_a_wrong_index(),
    *bags_with_damaged_records(),
    *bags_with_damaged_chunks(),
)
