"""The containers that are read, one entry each, and the first bytes by which they are recognised.

The code of a container is imported when such a log is opened.
"""

from typing import Final, NamedTuple

BAG_MAGIC: Final = b"#ROSBAG V2.0\n"
MCAP_MAGIC: Final = b"\x89MCAP0\r\n"
SQLITE_MAGIC: Final = b"SQLite format 3\0"
ZSTD_MAGIC: Final = b"\x28\xb5\x2f\xfd"
"""Also before messages that a recorder compressed one by one: no CDR message begins like it."""
_ZSTD_SKIPPED: Final = b"\x2a\x4d\x18"
"""After a byte of 0x50 to 0x5f: a frame to be skipped, with which parallel compressors begin."""
ROSBAG2_METADATA: Final = "metadata.yaml"
ANNOTATED: Final = ".annotated.mcap"
"""Default ending of the files that `convert` writes: they are no part of a bag."""


def is_zstd(start: bytes) -> bool:
    """Tell whether bytes are the start of a file that was compressed with zstd."""
    is_skipped = b"\x50" <= start[:1] <= b"\x5f" and start[1:4] == _ZSTD_SKIPPED
    return is_skipped or start.startswith(ZSTD_MAGIC)


class Container(NamedTuple):
    """A file format for logs."""

    magic: bytes
    """The first bytes of every such file."""
    suffix: str
    """Files with this suffix are found when a directory is searched."""
    module: str
    """Where in `containers` its `open_log` stands: it opens a file, given the ROS 2 distribution
    that recorded it, if known, through its index; where that is missing or damaged, from end to
    end. It raises `LogError` where nothing of it can be read."""
    is_scanned: bool = False
    """Whether it is read without an index, and so recognised even if a few bytes of its magic are
    damaged."""
    is_in_rosbag2: bool = False
    """Whether the directory of a ROS 2 bag may hold such files."""


CONTAINERS: Final = (
    Container(BAG_MAGIC, ".bag", "bag.scan", is_scanned=True),
    Container(MCAP_MAGIC, ".mcap", "mcap.scan", is_scanned=True, is_in_rosbag2=True),
    Container(SQLITE_MAGIC, ".db3", "sqlite.log", is_in_rosbag2=True),
)
ROSBAG2_SUFFIXES: Final = tuple(each.suffix for each in CONTAINERS if each.is_in_rosbag2)
