"""What a file is, is told by its first bytes."""

import gzip
import sqlite3
from pathlib import Path

import pytest
import zstandard

from dogbot_logtool.errors import CallError, LogError
from dogbot_logtool.reader.opening import open_log
from tests.reader.bag_bytes import small_bag
from tests.reader.mcap_bytes import small_mcap
from tests.reader.reading import read_bytes, written_bag, written_mcap


def test_the_suffix_does_not_matter(tmp_path: Path) -> None:
    for name, data, container in [
        ("walk.mcap", small_bag().build(), "ROS 1 bag"),
        ("walk.bag.active", small_bag().build(), "ROS 1 bag"),
        ("walk.bag", small_mcap().build(), "MCAP"),
    ]:
        path = tmp_path / name
        path.write_bytes(data)
        log = open_log(path)
        assert log.container == container
        log.close()


@pytest.mark.parametrize("place", range(13))
def test_a_damaged_magic_is_said(tmp_path: Path, place: int) -> None:
    bag, mcap = small_bag(), small_mcap()
    for data, written, size in [
        (bag.build(), written_bag(bag), 13),
        (mcap.build(), written_mcap(mcap), 8),
    ]:
        harmed = bytearray(data)
        harmed[place % size] ^= 0x40
        reading = read_bytes(tmp_path, bytes(harmed))
        assert list(reading.messages) == written
        assert reading.losses[0].what == "the file's first bytes are damaged"


def test_other_files_are_refused_in_a_sentence(tmp_path: Path) -> None:
    database = tmp_path / "bag.db3"
    with sqlite3.connect(database) as connection:
        connection.execute("create table topics (id integer)")
    connection.close()
    for data, says in [
        (b"", "is empty"),
        (b"#", "neither a ROS 1 bag"),
        (b"hello, world, this is a text", "neither a ROS 1 bag"),
        (database.read_bytes(), "is no ROS 2 bag"),
        (b"#ROSBAG V1.2\n" + bytes(100), "older format"),
        (gzip.compress(small_bag().build()), "gunzip"),
        (zstandard.ZstdCompressor().compress(b"hello, world, this is"), "neither a ROS 1 bag"),
    ]:
        path = tmp_path / "log"
        path.write_bytes(data)
        with pytest.raises(LogError, match=says) as caught:
            open_log(path)
        assert "\n" not in str(caught.value)


def test_no_file_is_a_wrong_call(tmp_path: Path) -> None:
    with pytest.raises(CallError):
        open_log(tmp_path / "absent.bag")
