"""The containers that are read, one entry each.

The code of a container is imported when such a log is opened.
"""

from collections.abc import Callable
from typing import TYPE_CHECKING, Final

from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.reader.containers.signatures import BAG_MAGIC, MCAP_MAGIC, SQLITE_MAGIC

if TYPE_CHECKING:
    from dogbot_logtool.reader.containers.log import Log
    from dogbot_logtool.reader.containers.loss import Loss
    from dogbot_logtool.reader.containers.sources.source import ByteSource


@dataclass(frozen=True, slots=True)
class Container:
    """A file format for logs."""

    name: str
    magic: bytes
    """The first bytes of every such file."""
    suffix: str
    """Files with this suffix are found when a directory is searched."""
    open_indexed: Callable[["ByteSource", str], tuple["Log | None", "Loss | None"]]
    """Opens a file through its index, given the ROS 2 distribution that recorded it, if known.

    Returns the log, or None where the index is missing or damaged, and then the damage, if any.
    Raises `LogError` where nothing else can be tried."""
    scan: Callable[["ByteSource", "Loss | None"], "Log"] | None = None
    """Opens a file by reading it from end to end, given what is wrong with its index. A file that
    can be scanned is recognised even if a few bytes of its magic are damaged."""
    is_in_rosbag2: bool = False
    """Whether the directory of a ROS 2 bag may hold such files."""


def _open_bag(source: "ByteSource", distribution: str) -> tuple["Log | None", "Loss | None"]:
    from dogbot_logtool.reader.containers.bag.log import open_bag  # noqa: PLC0415

    del distribution
    return open_bag(source)


def _scan_bag(source: "ByteSource", problem: "Loss | None") -> "Log":
    from dogbot_logtool.reader.salvage.bag_recovery_scan import scan_bag  # noqa: PLC0415

    return scan_bag(source, problem)


def _open_mcap(source: "ByteSource", distribution: str) -> tuple["Log | None", "Loss | None"]:
    from dogbot_logtool.reader.containers.mcap.log import open_mcap  # noqa: PLC0415

    del distribution
    return open_mcap(source)


def _scan_mcap(source: "ByteSource", problem: "Loss | None") -> "Log":
    from dogbot_logtool.reader.salvage.mcap_recovery_scan import scan_mcap  # noqa: PLC0415

    return scan_mcap(source, problem)


def _open_sqlite(source: "ByteSource", distribution: str) -> tuple["Log | None", "Loss | None"]:
    from dogbot_logtool.reader.containers.sqlite.log import open_sqlite  # noqa: PLC0415

    return open_sqlite(source, distribution), None


CONTAINERS: Final = (
    Container("ROS 1 bag", BAG_MAGIC, ".bag", _open_bag, _scan_bag),
    Container("MCAP", MCAP_MAGIC, ".mcap", _open_mcap, _scan_mcap, is_in_rosbag2=True),
    Container("SQLite file of a ROS 2 bag", SQLITE_MAGIC, ".db3", _open_sqlite, is_in_rosbag2=True),
)
ROSBAG2_SUFFIXES: Final = tuple(each.suffix for each in CONTAINERS if each.is_in_rosbag2)
