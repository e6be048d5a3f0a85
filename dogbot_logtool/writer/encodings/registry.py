"""The registry of output encodings.

An encoding is one row here and a file beside this one. That file, which imports the library of its
message format, is imported late, so that the command line can list the encodings at once.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from dogbot_logtool.writer.encodings.encoding import Encoding


@dataclass(frozen=True, slots=True)
class OutputEncoding:
    """One way to encode annotations."""

    name: str
    summary: str
    """Description of the messages for ``--help``."""
    profile: str
    """MCAP profile of a file in which all messages have this encoding."""
    load: Callable[[], "Encoding"]
    """Imports the encoding and returns it, the same one to all outputs."""


@cache
def _foxglove() -> "Encoding":
    from dogbot_logtool.writer.encodings.foxglove import FoxgloveEncoding  # noqa: PLC0415

    return FoxgloveEncoding()


@cache
def _ros1() -> "Encoding":
    from dogbot_logtool.writer.encodings.ros import Ros1Encoding  # noqa: PLC0415

    return Ros1Encoding()


@cache
def _ros2() -> "Encoding":
    from dogbot_logtool.writer.encodings.ros import Ros2Encoding  # noqa: PLC0415

    return Ros2Encoding()


_ENCODINGS: Final = (
    OutputEncoding("foxglove", "Foxglove's schemas in protobuf", profile="", load=_foxglove),
    OutputEncoding("ros1", "ROS 1 markers and transforms", profile="ros1", load=_ros1),
    OutputEncoding("ros2", "the same for ROS 2", profile="ros2", load=_ros2),
)
ENCODINGS: Final[Mapping[str, OutputEncoding]] = {each.name: each for each in _ENCODINGS}
"""By name, in the order of ``--help``."""


@cache
def texts(profile: str) -> "Encoding":
    """Return the encoding of texts in a profile, ``ros1`` or ``ros2``; Foxglove has none."""
    from dogbot_logtool.writer.encodings.ros import Ros1Texts, Ros2Texts  # noqa: PLC0415

    return Ros1Texts() if profile == "ros1" else Ros2Texts()
