"""Contents of a log, known before its messages are read: channels, chunks, counts and times."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from dogbot_logtool.reader.containers.loss import LONGEST_NAME, Loss
from dogbot_logtool.reader.containers.sources.source import ByteSource
from dogbot_logtool.reader.decode.definition import short_type_name


@dataclass(frozen=True, slots=True)
class Schema:
    """A recorded message definition."""

    id: int
    name: str
    """Type name as recorded."""
    encoding: str
    """``ros1msg``, ``ros2msg``, ``ros2idl``, ``protobuf`` ..."""
    data: bytes


@dataclass(frozen=True, slots=True)
class Channel:
    """A topic as one sender wrote it; a topic may have several."""

    id: int
    topic: str
    message_encoding: str
    """``ros1``, ``cdr``, ``protobuf`` ..."""
    schema: Schema | None
    metadata: Mapping[str, str] = field(hash=False)

    @property
    def type_name(self) -> str:
        """``package/Name`` whatever the spelling in the log; empty without a schema."""
        return short_type_name(self.schema.name) if self.schema else ""


@dataclass(frozen=True, slots=True)
class Chunk:
    """Position of a chunk of messages in the file."""

    offset: int
    """First byte of the chunk's record."""
    data_offset: int
    data_size: int
    """Bytes as stored."""
    end: int
    """End of the chunk's record, where the records that index it begin."""
    index_end: int
    compression: str
    size: int
    """Bytes when decompressed, as claimed."""
    crc: int = 0
    """CRC-32 of the decompressed bytes; 0: none recorded."""
    start_time: int | None = None
    """ns, log time of its first message, if known; also `end_time`."""
    end_time: int | None = None
    counts: Mapping[int, int] | None = None
    """Messages by channel id, from an index or counted when the log was opened; None: unknown."""
    is_scanned: bool = False
    """It was read when the log was opened, so that its damage is among the log's losses."""

    @property
    def messages(self) -> int | None:
        """Number of messages; None: unknown."""
        return None if self.counts is None else sum(self.counts.values())

    @property
    def is_compressed(self) -> bool:
        """Whether its bytes are stored in another form."""
        return self.compression not in {"", "none"}

    @property
    def is_record(self) -> bool:
        """Whether it is a chunk record, not bare messages that only are read like one."""
        return self.data_offset > self.offset


@dataclass(frozen=True, slots=True)
class Extra:
    """A record that is no message: an MCAP attachment or metadata record, copied as it is."""

    opcode: int
    offset: int
    size: int
    source: ByteSource
    """The file that it stands in."""


@dataclass(frozen=True, slots=True)
class EarlierAnnotations:
    """Annotations that `convert` added to a log."""

    channels: frozenset[int] = frozenset()
    """Ids of the channels."""
    extras: tuple[Extra, ...] = ()
    """The metadata records that describe how the file was made."""
    records: tuple[Mapping[str, str], ...] = ()
    """Their contents, the oldest first."""
    messages: int = 0


@dataclass(frozen=True, slots=True)
class Contents:
    """Contents found when a log is opened, without reading its messages."""

    channels: Mapping[int, Channel]
    chunks: Sequence[Chunk]
    counts: Mapping[int, int]
    """Messages by channel id."""
    start_time: int | None
    """ns, log time of the earliest message; None for an empty log; also `end_time`."""
    end_time: int | None
    profile: str = ""
    extras: Sequence[Extra] = ()
    losses: Sequence[Loss] = field(default=())
    """Damage found so far."""


def time_range(chunks: Sequence[Chunk]) -> tuple[int | None, int | None]:
    """Return when the first of some chunks begins and the last one ends, ns, as far as known."""
    starts = [chunk.start_time for chunk in chunks if chunk.start_time is not None]
    ends = [chunk.end_time for chunk in chunks if chunk.end_time is not None]
    return min(starts, default=None), max(ends, default=None)


def differing_counts(
    channels: Mapping[int, Channel], stated: Mapping[int, int], found: Mapping[int, int]
) -> str:
    """Return what to say of stated counts of messages that differ from those found.

    Args:
        channels: by id.
        stated: messages by channel id.
        found: likewise.

    Returns:
        "5 messages of /left, but 6 were found"; empty where all are right.
    """
    wrong = [
        number
        for number in sorted({*stated, *found})
        if stated.get(number, 0) != found.get(number, 0)
    ]
    if not wrong:
        return ""
    first = wrong[0]
    name = channels[first].topic[:LONGEST_NAME] if first in channels else f"channel {first}"
    text = f"{stated.get(first, 0)} messages of {name}, but {found.get(first, 0)} were found"
    if len(wrong) > 1:
        text += f" ({len(wrong) - 1} more wrong)"
    return text
