"""The containers that are read, one entry each.

The code of a container is imported when such a log is opened.
"""

from collections.abc import Callable
from importlib import import_module
from typing import TYPE_CHECKING, Final

from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.reader.containers.signatures import BAG_MAGIC, MCAP_MAGIC, SQLITE_MAGIC

if TYPE_CHECKING:
    from dogbot_logtool.reader.containers.log import Log
    from dogbot_logtool.reader.containers.sources.source import ByteSource


Open = Callable[["ByteSource", str], "Log"]
"""Opens a file, given the ROS 2 distribution that recorded it, if known. Raises `LogError` where
nothing of it can be read."""
_CONTAINERS: Final = "dogbot_logtool.reader.containers"


@dataclass(frozen=True, slots=True)
class Container:
    """A file format for logs."""

    name: str
    magic: bytes
    """The first bytes of every such file."""
    suffix: str
    """Files with this suffix are found when a directory is searched."""
    open: Open
    """Opens a file through its index; where that is missing or damaged, from end to end."""
    is_scanned: bool = False
    """Whether it is read without an index, and so recognised even if a few bytes of its magic are
    damaged."""
    is_in_rosbag2: bool = False
    """Whether the directory of a ROS 2 bag may hold such files."""


def _opened_by(module: str) -> Open:
    def open_log(source: "ByteSource", distribution: str) -> "Log":
        log: Log = import_module(f"{_CONTAINERS}.{module}").open_log(source, distribution)
        return log

    return open_log


CONTAINERS: Final = (
    Container("ROS 1 bag", BAG_MAGIC, ".bag", _opened_by("bag.log"), is_scanned=True),
    Container(
        "MCAP", MCAP_MAGIC, ".mcap", _opened_by("mcap.log"), is_scanned=True, is_in_rosbag2=True
    ),
    Container(
        "SQLite file of a ROS 2 bag",
        SQLITE_MAGIC,
        ".db3",
        _opened_by("sqlite.log"),
        is_in_rosbag2=True,
    ),
)
ROSBAG2_SUFFIXES: Final = tuple(each.suffix for each in CONTAINERS if each.is_in_rosbag2)
