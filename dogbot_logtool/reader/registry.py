"""The containers that are read, one entry each.

The code of a container is imported when such a log is opened.
"""

from dataclasses import dataclass
from typing import Final

from dogbot_logtool.reader.containers.signatures import BAG_MAGIC, MCAP_MAGIC, SQLITE_MAGIC


@dataclass(frozen=True, slots=True)
class Container:
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
