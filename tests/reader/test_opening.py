"""What a file is, is told by its first bytes."""

import bz2
import gzip
import lzma
import re
from pathlib import Path

import lz4.frame
import numpy as np
import pytest
import zstandard

from dogbot_logtool.errors import LogError
from dogbot_logtool.reader.opening import open_log
from tests.reader.bag_bytes import BagBytes, Connection, small_bag
from tests.reader.bag_bytes import Message as BagMessage
from tests.reader.cases import flipped
from tests.reader.mcap_bytes import small_mcap
from tests.reader.reading import read_bytes


@pytest.mark.parametrize("place", range(13))
def test_a_damaged_magic_is_said(tmp_path: Path, place: int) -> None:
    for log, size in ((small_bag(), 13), (small_mcap(), 8)):
        reading = read_bytes(tmp_path, flipped(log.build(), place % size, 0x40))
        assert list(reading.messages) == log.written
        assert reading.losses[0].what == "the file's first bytes are damaged"


BAG, MCAP = small_bag().build(), small_mcap().build()
CHECKED_BY = zstandard.ZstdCompressor(write_checksum=True)
CHECKED = CHECKED_BY.compress(MCAP)
TAKEN_FOR_TEXT = (
    *(MCAP.replace(b"\r\n", end) for end in (b"\n", b"\r")),
    *(log.replace(b"\n", b"\r\n") for log in (MCAP, BAG)),
    *(b"\xef\xbb\xbf" + log for log in (MCAP, BAG)),
    *(MCAP.decode("utf-8", errors).encode() for errors in ("replace", "ignore")),
    MCAP.decode("latin-1").encode(),
    MCAP.decode("ascii", "replace").encode("ascii", "replace"),
)
PACKED = (
    *(pack(BAG) for pack in (bz2.compress, lzma.compress, lz4.frame.compress, gzip.compress)),
    zstandard.compress(zstandard.compress(BAG)),
    b"PK\3\4" + BAG,
    zstandard.compress(bytes(257) + b"ustar" + BAG),
)


@pytest.mark.parametrize(
    ("data", "says"),
    [
        (b"version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\n", "is a pointer to the"),
        (b"/annex/objects/SHA256E-s1--a.bag\n", "is a pointer to the"),
        (b"outs:\n- md5: 4d7a\n  size: 5\n  path: walk.bag\n", "is a pointer to the"),
        *((text, "took it for text") for text in TAKEN_FOR_TEXT),
        *((packed, "unpack it first") for packed in PACKED),
        (b"\xef\xbb\xbf\r\n <HTML lang='en'>", "a web page, XML or JSON"),
        (b'{"message": "Not Found", "documentation_url": "https', "a web page, XML or JSON"),
        (b"", "is empty"),
        (b"#", "breaks off after 1 bytes"),
        (zstandard.compress(b"hello, world, this is"), "neither a ROS 1 bag"),
        (b"#ROSBAG V1.2\n" + bytes(100), "older format"),
        (bytes(1 << 20), "begins with zeros"),
        (CHECKED[:9], r"its zstd data is damaged behind byte 9 \(it is cut off\)"),
        (CHECKED[:-1] + b"?", r"its zstd data is damaged behind byte 0 \(.*checksum"),
        (b"rosbag2_bagfile_information:\n  version: 9\n", "name the directory"),
    ],
)
def test_common_accidents_have_their_names(tmp_path: Path, data: bytes, says: str) -> None:
    path = tmp_path / "walk.bag"
    path.write_bytes(data)
    with pytest.raises(LogError, match=says) as caught:
        open_log(path)
    assert str(caught.value).startswith(f"{path}: ")
    assert "\n" not in str(caught.value)


FRAME = zstandard.compress(MCAP)


@pytest.mark.parametrize(
    ("packed", "says"),
    [
        (zstandard.compress(MCAP[:50]) + zstandard.compress(MCAP[50:]), ""),
        (b"\x50\x2a\x4d\x18\4\0\0\0size" + FRAME, ""),
        (FRAME + b"\x5f\x2a\x4d\x18\0\0\0\0", ""),
        (FRAME + bytes(3), ""),
        (FRAME + bytes(3000), ""),
        (CHECKED[:-1], r"behind byte \d+ \(it is cut off\)"),
        (FRAME + zstandard.compress(b"more")[:-2], r"behind byte \d+ \(it is cut off\)"),
        (FRAME + b"more", r"behind byte \d+ \(what follows is no zstd data\)"),
        (FRAME + bytes(5000) + b"more", "what follows is no zstd data"),
        (FRAME + b"\x28\xb5\x2f\xfd" + b"\xff" * 40, "its zstd data is damaged behind byte"),
    ],
)
def test_all_frames_of_a_compressed_log_are_read_up_to_damage(
    tmp_path: Path, packed: bytes, says: str
) -> None:
    reading = read_bytes(tmp_path, packed)
    assert list(reading.messages) == small_mcap().written
    assert reading.lost == (None if says else 0)
    assert re.search(says or "^$", reading.sentences)


def test_a_compressed_log_is_read_up_to_a_damaged_piece(tmp_path: Path) -> None:
    chance = np.random.default_rng(1)
    large = [
        [BagMessage(0, n, chance.integers(0, 4, 200_000, np.uint8).tobytes()) for n in range(1, 6)]
    ]
    log = BagBytes(large, [Connection(0, "/a")])
    packed = bytearray(CHECKED_BY.compress(log.build()))
    middle = len(packed) // 2
    packed[middle : middle + 3000] = b"\xff" * 3000
    reading = read_bytes(tmp_path, bytes(packed))
    assert 1 <= len(reading.messages) < 4
    assert list(reading.messages) == log.written[: len(reading.messages)]
    assert reading.lost is None


def test_a_copy_that_cannot_be_kept_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "absent"))
    with pytest.raises(LogError, match=r"all of it cannot be kept in .*absent: No such file"):
        read_bytes(tmp_path, CHECKED)
