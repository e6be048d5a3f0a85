"""The encodings of annotations, by name; the library of a message format is imported late."""

from functools import cache
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from dogbot_logtool.writer.encodings.encoding import Encoding

ENCODINGS: Final = ("foxglove", "ros1", "ros2")


@cache
def encoding_named(name: str) -> "Encoding":
    """Return one of `ENCODINGS`, the same one to all outputs."""
    if name == "foxglove":
        from dogbot_logtool.writer.encodings.foxglove import FoxgloveEncoding  # noqa: PLC0415

        return FoxgloveEncoding()
    from dogbot_logtool.writer.encodings.ros import Ros1Encoding, Ros2Encoding  # noqa: PLC0415

    return Ros1Encoding() if name == "ros1" else Ros2Encoding()


@cache
def texts(profile: str) -> "Encoding":
    """Return the encoding of texts in a profile, ``ros1`` or ``ros2``; Foxglove has none."""
    from dogbot_logtool.writer.encodings.ros import Ros1Texts, Ros2Texts  # noqa: PLC0415

    return Ros1Texts() if profile == "ros1" else Ros2Texts()
