"""Many messages as an MCAP file, as its specification says: much faster than by its library.

The library takes longer to write a log of a walk than all else that is done with it. Logs that are
looked at for what is in them, not for how they are written, come from here.
"""

import struct
import zlib
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import BinaryIO, Final, NamedTuple

from tests.reader.mcap_bytes import (
    CHANNEL,
    CHUNK,
    CHUNK_INDEX,
    CODECS,
    DATA_END,
    FOOTER,
    HEADER,
    MAGIC,
    MESSAGE,
    MESSAGE_INDEX,
    SCHEMA,
    STATISTICS,
    record,
    text,
)


class Entry(NamedTuple):
    """A message of a log."""

    topic: str
    kind: str
    log_time: int
    """ns"""
    data: bytes


_HEAD: Final = struct.Struct("<BQHIQQ")
"""Of a message: opcode, length, channel, sequence, log time, publish time."""


def write_mcap(
    path: Path,
    entries: Sequence[Entry],
    definition: Callable[[str], str],
    chunk_bytes: int = 1 << 20,
    compression: str = "",
) -> Path:
    """Write messages of ROS 2.

    Args:
        path: of the file.
        entries: in the order of the file.
        definition: returns a type's message definition.
        chunk_bytes: least size of a chunk before compression, but of the last one.
        compression: of chunks; `CODECS` has the names.
    """
    channels, described = _described(entries, definition)
    indexes = b""
    row = chunks = 0
    with path.open("wb") as stream:
        stream.write(MAGIC + record(HEADER, text("ros2") + text("")))
        while row < len(entries):
            first, parts = row, [] if chunks else [described]
            size = sum(map(len, parts))
            places: dict[int, list[int]] = {}
            while row < len(entries) and size < chunk_bytes:
                topic, _, log_time, data = entries[row]
                channel = channels[topic]
                places.setdefault(channel, []).extend((log_time, size))
                parts.append(_HEAD.pack(MESSAGE, 22 + len(data), channel, 0, log_time, log_time))
                parts.append(data)
                size += _HEAD.size + len(data)
                row += 1
            span = _span(entries[first:row])
            indexes += _write_chunk(stream, b"".join(parts), span, places, compression)
            chunks += 1
        stream.write(record(DATA_END, struct.pack("<I", 0)))
        start = stream.tell()
        stream.write(described + indexes + _statistics(entries, channels, chunks))
        stream.write(record(FOOTER, struct.pack("<QQI", start, 0, 0)) + MAGIC)
    return path


def _span(entries: Sequence[Entry]) -> tuple[int, int]:
    """Return the first and the last log time."""
    times = [entry.log_time for entry in entries] or [0]
    return min(times), max(times)


def _described(
    entries: Sequence[Entry], definition: Callable[[str], str]
) -> tuple[dict[str, int], bytes]:
    """Return the channels' numbers by topic, and the records of them and of their schemas."""
    schemas: dict[str, int] = {}
    channels: dict[str, int] = {}
    described = b""
    for topic, kind in dict.fromkeys((each.topic, each.kind) for each in entries):
        if kind not in schemas:
            schemas[kind] = len(schemas) + 1
            content = struct.pack("<H", schemas[kind]) + text(kind) + text("ros2msg")
            described += record(SCHEMA, content + text(definition(kind)))
        channels[topic] = len(channels) + 1
        content = struct.pack("<HH", channels[topic], schemas[kind])
        described += record(CHANNEL, content + text(topic) + text("cdr") + text(b""))
    return channels, described


def _write_chunk(
    stream: BinaryIO,
    inner: bytes,
    span: tuple[int, int],
    places: Mapping[int, Sequence[int]],
    compression: str,
) -> bytes:
    """Write a chunk and its message indexes; return its index record.

    Args:
        stream: of the file.
        inner: the chunk's records.
        span: first and last log time.
        places: log time and offset of each message, one after the other, by channel.
        compression: of the chunk.
    """
    start, stored = stream.tell(), CODECS[compression](inner)
    head = struct.pack("<QQQI", *span, len(inner), zlib.crc32(inner))
    stream.write(record(CHUNK, head + text(compression) + struct.pack("<Q", len(stored)) + stored))
    end, offsets = stream.tell(), b""
    for channel, pairs in places.items():
        offsets += struct.pack("<HQ", channel, stream.tell())
        data = struct.pack(f"<{len(pairs)}Q", *pairs)
        stream.write(record(MESSAGE_INDEX, struct.pack("<H", channel) + text(data)))
    index = struct.pack("<QQQQ", *span, start, end - start) + text(offsets)
    index += struct.pack("<Q", stream.tell() - end) + text(compression)
    return record(CHUNK_INDEX, index + struct.pack("<QQ", len(stored), len(inner)))


def _statistics(entries: Sequence[Entry], channels: Mapping[str, int], chunks: int) -> bytes:
    counts = Counter(channels[each.topic] for each in entries)
    kinds = len({each.kind for each in entries})
    told = struct.pack("<QHIIII", len(entries), kinds, len(channels), 0, 0, chunks)
    told += struct.pack("<QQ", *_span(entries))
    told += text(b"".join(struct.pack("<HQ", *each) for each in counts.items()))
    return record(STATISTICS, told)
