"""Files of up to 1 MB that claim too much: memory and time stay bounded, a sentence comes out."""

import struct
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.forked_cli import run
from tests.reader import bag_bytes, mcap_bytes
from tests.reader.bag_bytes import U32
from tests.reader.mcap_bytes import MAGIC, channel, chunk, file_header, record, schema, statistics
from tests.reader.reading import read_bytes

SIZE = 1 << 20
MOST_MEMORY_MB = 500
MOST_SECONDS = 60
"""On a busy machine; mostly it is below ten."""


def mcap_of(*records: bytes) -> bytes:
    return MAGIC + file_header() + schema(1) + channel(1, "/a") + b"".join(records)


def bomb_of_channels() -> bytes:
    inside = b"".join(channel(number % 65536, f"/t{number}") for number in range(500_000))
    return mcap_of(*[chunk(inside, "zstd")] * 2)[:SIZE]


def bomb_of_definitions() -> bytes:
    chunks = [
        chunk(
            b"".join(schema(1 + (10 * row + n) % 65535, data=bytes(3 << 20)) for n in range(10)),
            "zstd",
        )
        for row in range(15)
    ]
    return mcap_of(*chunks)[:SIZE]


def summary_that_repeats_a_chunk() -> bytes:
    mcap = mcap_bytes.McapBytes([[mcap_bytes.Message(1, 1, b"")] * 9_000])
    data = mcap.build()
    start = data.index(struct.pack("<Q", mcap.chunk_starts[0]), mcap.summary_start) - 25
    length = 9 + int.from_bytes(data[start + 1 : start + 9], "little")
    index = data[start : start + length]
    body = data[: mcap.summary_start]
    section = schema(1) + channel(1, "/left") + index * 5000
    section += statistics({1: 9_000 * 5000}, [1], 5000)
    footer = struct.pack("<BQQQI", mcap_bytes.FOOTER, 20, len(body), 0, 0)
    return body + section + footer + MAGIC


def absurd_lengths() -> bytes:
    parts = [
        record(opcode, struct.pack("<Q", 1 << 62) * 8 + b"\xff" * 40)
        for opcode in range(1, 16)
        for _ in range(400)
    ]
    return mcap_of(*parts)[:SIZE]


def bag_of(*records: bytes) -> bytes:
    return bag_bytes.MAGIC + bag_bytes.bag_header(0, 0, 0) + b"".join(records)


ONE_OF_MCAP = mcap_bytes.Message(1, 1, b"").record()
NESTED = struct.pack("<BQHIQQ", 5, 600_000, 1, 1, 1, 1)
"""The head of a message that claims to be long."""
ONE_OF_BAG = bag_bytes.Message(0, 1, b"").record()
LONG = ONE_OF_BAG[:-4] + U32.pack(1 << 30)
INDEX = bag_bytes.record(
    b"", op=b"\x04", ver=U32.pack(1), conn=U32.pack(0), count=U32.pack(0xFFFFFFFF)
)


def bag_bomb() -> bytes:
    content = bag_bytes.Connection(0, "/a").record() + ONE_OF_BAG * ((31 << 20) // len(ONE_OF_BAG))
    return bag_of(*[bag_bytes.chunk(content, "lz4")] * 2)[:SIZE]


def zstd_file_of_equal_bytes() -> bytes:
    """Return a frame whose four-byte blocks are 128 kB each."""
    block = (128 << 10 << 3 | 1 << 1).to_bytes(3, "little") + b"x"
    return b"\x28\xb5\x2f\xfd\x00\x38" + block * (SIZE // 8)


FILES: dict[str, Callable[[], bytes]] = {
    "zstd bomb": lambda: mcap_of(*[chunk(ONE_OF_MCAP * 1_000_000, "zstd")] * 2)[:SIZE],
    "zstd file of equal bytes": zstd_file_of_equal_bytes,
    "zstd bomb beyond the limit": lambda: mcap_of(chunk(bytes(900 << 20), "zstd")),
    "chunks that claim 2 GB": lambda: mcap_of(chunk(b"abc", "zstd", claimed=2 << 30) * 1000),
    "bomb of channels": bomb_of_channels,
    "bomb of definitions": bomb_of_definitions,
    "messages within messages": lambda: mcap_of(NESTED * 33_000)[:SIZE],
    "a chunk indexed 5000 times": summary_that_repeats_a_chunk,
    "absurd lengths": absurd_lengths,
    "bag lz4 bomb": bag_bomb,
    "bag of heads": lambda: bag_of(LONG * 20_000)[:SIZE],
    "bag index of everything": lambda: bag_of(bag_bytes.chunk(b"", "none"), INDEX * 15_000)[:SIZE],
    "bag of op fields": lambda: bag_of(b"\x08\0\0\0\x04\0\0\0op=\x05" * 70_000)[:SIZE],
}


QUICK = {"chunks that claim 2 GB", "absurd lengths", "bag index of everything", "bag of heads"}


@pytest.mark.parametrize(
    "name",
    [each if each in QUICK else pytest.param(each, marks=pytest.mark.slow) for each in FILES],
)
def test_a_hostile_file_stays_within_bounds(tmp_path: Path, name: str) -> None:
    data = FILES[name]()
    assert len(data) <= SIZE
    path = tmp_path / "log"
    path.write_bytes(data)
    done = run("compare", path, path, timeout=MOST_SECONDS)
    assert done.returncode in {1, 3}, done.stderr
    assert done.peak_mb < MOST_MEMORY_MB


def test_a_chunk_that_is_indexed_often_counts_once(tmp_path: Path) -> None:
    reading = read_bytes(tmp_path, summary_that_repeats_a_chunk())
    assert len(reading.messages) == 9_000
    assert reading.counts == {"/left": 9_000, "/right": 0}
    assert "the summary is damaged or wrong" in reading.sentences
