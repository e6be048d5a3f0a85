"""Opening a log: what it is, is told by its first bytes, not by its name."""

from pathlib import Path
from typing import Final

from dogbot_logtool.errors import LogError
from dogbot_logtool.reader import bag_records, mcap_records
from dogbot_logtool.reader.bag_log import open_bag
from dogbot_logtool.reader.log import Log
from dogbot_logtool.reader.mcap_log import open_mcap
from dogbot_logtool.reader.source import ByteSource

_KNOWN_BUT_UNREAD: Final = {
    b"SQLite format 3\0": "a ROS 2 sqlite3 bag, which is not read yet; "
    "'ros2 bag convert' makes an MCAP of it",
    b"#ROSBAG V1": "a bag of an older format than 2.0; 'rosbag fix' or 'rosbag migrate' updates it",
    b"\x28\xb5\x2f\xfd": "a zstd-compressed file; decompress it first ('zstd -d')",
    b"\x1f\x8b": "a gzip-compressed file; decompress it first ('gunzip')",
}


def open_log(path: Path) -> Log:
    """Open a ROS 1 bag or an MCAP.

    Raises:
        CallError: there is no such file.
        LogError: it is neither.
    """
    source = ByteSource(path)
    try:
        magic = source.read(0, 16)
        if magic.startswith(mcap_records.MAGIC):
            return open_mcap(source)
        if magic.startswith(bag_records.MAGIC):
            return open_bag(source)
        raise LogError(f"{path}: {_what_it_is(magic)}")
    except BaseException:
        source.close()
        raise


def _what_it_is(magic: bytes) -> str:
    if not magic:
        return "is empty"
    for start, what in _KNOWN_BUT_UNREAD.items():
        if magic.startswith(start):
            return f"is {what}"
    return "is neither a ROS 1 bag (#ROSBAG V2.0) nor an MCAP file: its first bytes are neither's"
