"""Decompression into memory that is set aside beforehand."""

import bz2
from typing import Any

import lz4.frame
import numpy as np
import pytest
import zstandard

from dogbot_logtool.reader.containers.compression import (
    MAX_CHUNK_SIZE,
    check_claimed_size,
    decompress_into,
)
from dogbot_logtool.reader.containers.salvage.content import ChunkDamage
from tests.reader.bag_bytes import lz4_as_rosbag

CONTENT = np.random.default_rng(0).bytes(100_000) + b"gait " * 60_000

LZ4_FRAMES: dict[str, dict[str, Any]] = {
    "linked blocks": {"block_linked": True, "block_size": lz4.frame.BLOCKSIZE_MAX64KB},
    "independent blocks": {"block_linked": False, "block_size": lz4.frame.BLOCKSIZE_MAX64KB},
    "content checksum": {"content_checksum": True},
    "block checksums": {"block_checksum": True},
    "no content size": {"store_size": False},
    "no content size, blocks": {"store_size": False, "block_size": lz4.frame.BLOCKSIZE_MAX64KB},
    "one block": {"block_size": lz4.frame.BLOCKSIZE_MAX4MB, "content_checksum": True},
}


def decompress(data: bytes, compression: str, size: int = len(CONTENT)) -> bytes:
    target = np.empty(size, np.uint8)
    got = decompress_into(target, memoryview(data), compression)
    return target[:got].tobytes()


@pytest.mark.parametrize("name", LZ4_FRAMES)
def test_any_lz4_frame(name: str) -> None:
    assert decompress(lz4.frame.compress(CONTENT, **LZ4_FRAMES[name]), "lz4") == CONTENT


COMPRESSED = {
    "none": CONTENT,
    "bz2": bz2.compress(CONTENT),
    "lz4": lz4_as_rosbag(CONTENT),
    "zstd": zstandard.ZstdCompressor(write_checksum=True).compress(CONTENT),
}


@pytest.mark.parametrize("compression", COMPRESSED)
@pytest.mark.parametrize("wrong", [-1, 1])
def test_another_size_than_claimed_is_damage(compression: str, wrong: int) -> None:
    with pytest.raises(ChunkDamage):
        decompress(COMPRESSED[compression], compression, len(CONTENT) + wrong)


@pytest.mark.parametrize("compression", ["bz2", "lz4", "zstd"])
@pytest.mark.parametrize("place", [0.01, 0.3, 0.9])
def test_damage_within_is_seen(compression: str, place: float) -> None:
    data = bytearray(COMPRESSED[compression])
    data[int(place * len(data))] ^= 0x10
    with pytest.raises(ChunkDamage, match="damaged"):
        decompress(bytes(data), compression)


@pytest.mark.parametrize(
    ("compression", "missing"),
    [
        *(("lz4", missing) for missing in (1, 3, 5, 1000, 90_000)),
        # Of zstd's own checksum nothing needs to be there: MCAP's chunks have another.
        *(("zstd", missing) for missing in (5, 1000, 90_000)),
    ],
)
def test_a_cut_frame_without_block_checksums_gives_nothing(compression: str, missing: int) -> None:
    with pytest.raises(ChunkDamage):
        decompress(COMPRESSED[compression][:-missing], compression)


def test_a_cut_lz4_frame_with_block_checksums_gives_its_whole_blocks() -> None:
    data = lz4.frame.compress(CONTENT, block_checksum=True, block_size=lz4.frame.BLOCKSIZE_MAX64KB)
    got = decompress(data[: len(data) // 2], "lz4")
    assert got
    assert CONTENT.startswith(got)
    assert len(got) < len(CONTENT)


def test_claims_are_bounded_before_anything_is_set_aside() -> None:
    check_claimed_size(30 << 20, 1000)
    check_claimed_size(200 << 20, 10 << 20)
    for claimed, compressed in [(MAX_CHUNK_SIZE + 1, MAX_CHUNK_SIZE), (100 << 20, 1 << 20)]:
        with pytest.raises(ChunkDamage, match="claims to hold"):
            check_claimed_size(claimed, compressed)
