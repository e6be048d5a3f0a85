"""Bags and MCAP files that are sound, as rosbags and the mcap library read them."""

import io
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

import lz4.frame
import pytest
from mcap.reader import make_reader
from rosbags.rosbag1 import Reader as BagReader

from tests.reader import bag_bytes, mcap_bytes
from tests.reader.bag_bytes import BagBytes, Connection, bag_header, small_bag
from tests.reader.cases import BAG, DESCRIBED, EXTRAS, SENDERS, Case, built, put
from tests.reader.mcap_bytes import McapBytes, small_mcap
from tests.reader.reading import Read, read_bytes

MCAP_OPTIONS: Final[dict[str, dict[str, Any]]] = {
    "as usual": {},
    "no summary": {"summary": False},
    "no statistics": {"statistics": False},
    "nothing repeated": {"repeated": False},
    "no message index": {"message_index": False},
    "no checksums": {"chunk_crc": False, "data_crc": False},
    "no chunks": {"chunked": False},
    "no chunks, no summary": {"chunked": False, "summary": False},
}
LZ4_FRAMES: Final[tuple[dict[str, Any], ...]] = (
    {"block_linked": True, "block_size": lz4.frame.BLOCKSIZE_MAX64KB},
    {"block_linked": False, "block_size": lz4.frame.BLOCKSIZE_MAX64KB},
    {"block_size": lz4.frame.BLOCKSIZE_MAX4MB, "content_checksum": True},
    {"store_size": True, "content_checksum": True},
    {"store_size": False, "block_size": lz4.frame.BLOCKSIZE_MAX64KB},
    {"store_size": False, "block_checksum": True},
)


def sound_logs() -> Iterator[Case]:
    for compression in mcap_bytes.CODECS:
        for name, options in MCAP_OPTIONS.items():
            log = small_mcap(compression)
            yield Case(f"mcap {compression}, {name}", *built(log, **options))
    for summary in (False, True):
        yield Case("extras", *built(small_mcap(), extras=EXTRAS, summary=summary))
    for opcode in (0x10, 0x7F, 0x80):
        later = {1: mcap_bytes.record(opcode, b"of a later version")}
        yield Case(f"opcode {opcode}", *built(small_mcap(), between=later))
    repeated = dict.fromkeys((0, 1, 2), DESCRIBED)
    yield Case("repeated", *built(small_mcap(), described_later=repeated, between=repeated))
    for compression in bag_bytes.CODECS:
        yield Case(f"bag {compression}", *built(small_bag(compression)))
    yield Case("connections in the index", *built(small_bag(), in_chunks=False))
    yield Case("no chunks", *built(BagBytes([], [Connection(0, "/left")])))
    messages = [[BAG(0, 1, b"one"), BAG(7, 2, b"two"), BAG(3, 3, b"three")]]
    yield Case("several senders", *built(BagBytes(messages, SENDERS)))
    for zeros in (1, 49, 4000):
        bag, data = built(small_bag(), zeros=zeros)
        head = bag_header(bag.index_place - zeros, 2, 3)
        for data_too in (data, put(data, 13, head)):
            yield Case(f"{zeros} zeros before the index", bag, data_too, whole=())
    for frame in LZ4_FRAMES:
        bag = small_bag("lz4", each=3000)
        bag.compress = lambda data, frame=frame: bytes(lz4.frame.compress(data, **frame))
        yield Case(f"lz4 {frame}", *built(bag))


def by_libraries(case: Case, path: Path) -> list[Read]:
    """Read a log with rosbags or the mcap library."""
    if isinstance(case.log, BagBytes):
        with BagReader(path) as reader:
            return [Read(c.topic, log_time, bytes(data)) for c, log_time, data in reader.messages()]
    messages = make_reader(io.BytesIO(case.data), validate_crcs=True).iter_messages()
    return [Read(channel.topic, message.log_time, message.data) for _, channel, message in messages]


@pytest.mark.parametrize("case", [*sound_logs()], ids=lambda case: case.name)
def test_a_sound_log(tmp_path: Path, case: Case) -> None:
    reading = read_bytes(tmp_path, case.data)
    assert list(reading.messages) == case.log.written
    assert not reading.losses
    mcap = case.log if isinstance(case.log, McapBytes) else None
    if case.whole is None:
        is_whole = mcap is None or (mcap.chunked and mcap.message_index)
        assert all(chunk.whole == is_whole for chunk in reading.chunks)
        if mcap is None or mcap.repeated:
            assert sorted(by_libraries(case, tmp_path / "log")) == sorted(reading.messages)
    times = [message.log_time for message in reading.messages]
    assert reading.times == ((min(times), max(times)) if times else (None, None))
    assert reading.profile == "ros1"
    assert +Counter(reading.counts) == Counter(message.topic for message in reading.messages)
    extras = [case.data[e.offset : e.offset + e.size] for e in reading.extras]
    assert extras == (list(mcap.extras) if mcap is not None else [])
    if isinstance(case.log, BagBytes):
        connections = {(c.topic, c.type_name, c.definition.encode()) for c in case.log.connections}
        assert {*reading.topics} == connections
