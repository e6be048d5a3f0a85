"""A bag or an MCAP made byte by byte, and what must come out of it."""

import struct
from typing import Any, Final, NamedTuple, TypeVar

from tests.reader import bag_bytes, mcap_bytes
from tests.reader.bag_bytes import BagBytes, Connection
from tests.reader.mcap_bytes import McapBytes, attachment, channel, metadata, schema

Log = BagBytes | McapBytes
AnyLog = TypeVar("AnyLog", BagBytes, McapBytes)
BAG, MCAP = bag_bytes.Message, mcap_bytes.Message
ANY: Final = ""
"""Said of a log: anything."""
AS_LOST: Final = -1


class Case(NamedTuple):
    """A log, and what must come out of it."""

    name: str
    log: Log
    data: bytes
    says: str | None = None
    """Said of it, among other things; None: it is sound."""
    lost: tuple[int, ...] = ()
    """Messages that do not come out, by their number."""
    either: bool = False
    """They may come out."""
    number: int | None = AS_LOST
    """Messages that are said to be lost."""
    bytes: int | None = None
    """Bytes that are said to be lost; None: any."""
    whole: tuple[bool, ...] | None = None
    """Which chunks may be copied as they stand; None: any, or of a sound log all."""
    index_is_true: bool = True
    """What is said of counts when the log is opened is true."""


def built(log: AnyLog, **options: Any) -> tuple[AnyLog, bytes]:
    for name, value in options.items():
        setattr(log, name, value)
    return log, log.build()


def put(data: bytes, place: int, new: bytes) -> bytes:
    """Return bytes with others in their place, from some place on."""
    return data[:place] + new + data[place + len(new) :]


def flipped(data: bytes, place: int, bits: int) -> bytes:
    return put(data, place, bytes([data[place] ^ bits]))


def u64(value: int) -> bytes:
    return struct.pack("<Q", value)


DESCRIBED = schema(1) + channel(1, "/left") + channel(2, "/right")
SWAPPED = schema(1) + channel(1, "/right") + channel(2, "/left")
EXTRAS = [attachment("notes", b"x" * 1000), metadata("robot", {"name": "dogbot"})]
SENDERS: Final = (
    Connection(0, "/foot", extra={"callerid": b"/first"}),
    Connection(7, "/foot", extra={"callerid": b"/second", "latching": b"1"}),
    Connection(3, "/foot", "other_msgs/String", "string text\n"),
)


RUBBISH: Final = (b"\0" * 9000, b"\xff" * 300, b"op=\x05" * 500, b"\x05\x16\0\0\0" * 400)
SECOND_CHUNK: Final = (4, 5, 6, 7)
