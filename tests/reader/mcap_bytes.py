"""MCAP files written byte by byte, so that each fault of one is exact."""

import struct
import zlib
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import count
from typing import NamedTuple

import lz4.frame
import zstandard

from tests.reader.reading import Read, small_chunks

MAGIC = b"\x89MCAP0\r\n"
HEADER, FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, MESSAGE_INDEX, CHUNK_INDEX = range(1, 9)
ATTACHMENT, ATTACHMENT_INDEX, STATISTICS, METADATA, METADATA_INDEX, SUMMARY_OFFSET = range(9, 15)
DATA_END = 15

CODECS: Mapping[str, Callable[[bytes], bytes]] = {
    "": bytes,
    "lz4": lz4.frame.compress,
    "zstd": zstandard.ZstdCompressor(level=1).compress,
}


def record(opcode: int, content: bytes) -> bytes:
    return struct.pack("<BQ", opcode, len(content)) + content


def text(value: str | bytes) -> bytes:
    data = value if isinstance(value, bytes) else value.encode()
    return struct.pack("<I", len(data)) + data


def file_header(profile: str = "ros1") -> bytes:
    return record(HEADER, text(profile) + text("by hand"))


def schema(
    number: int, name: str | bytes = "std_msgs/String", data: bytes = b"string data"
) -> bytes:
    content = struct.pack("<H", number) + text(name) + text("ros1msg") + text(data)
    return record(SCHEMA, content)


def channel(number: int, topic: str | bytes, schema_id: int = 1) -> bytes:
    content = struct.pack("<HH", number, schema_id) + text(topic) + text("ros1") + text(b"")
    return record(CHANNEL, content)


class Message(NamedTuple):
    channel: int
    log_time: int
    payload: bytes
    sequence: int = 0

    def record(self) -> bytes:
        head = struct.pack("<HIQQ", self.channel, self.sequence, self.log_time, self.log_time)
        return record(MESSAGE, head + self.payload)


def metadata(name: str, values: Mapping[str, str]) -> bytes:
    pairs = b"".join(text(key) + text(value) for key, value in values.items())
    return record(METADATA, text(name) + text(pairs))


def attachment(name: str, data: bytes) -> bytes:
    content = struct.pack("<QQ", 1, 2) + text(name) + text("text/plain")
    content += struct.pack("<Q", len(data)) + data
    return record(ATTACHMENT, content + struct.pack("<I", zlib.crc32(content)))


def chunk(
    inner: bytes,
    compression: str,
    times: Sequence[int] = (1,),
    *,
    with_crc: bool = False,
    claimed: int | None = None,
) -> bytes:
    """Return a chunk; it may claim to hold more bytes than it does."""
    stored = CODECS[compression](inner)
    size = len(inner) if claimed is None else claimed
    crc = zlib.crc32(inner) if with_crc else 0
    head = struct.pack("<QQQI", min(times), max(times), size, crc) + text(compression)
    return record(CHUNK, head + struct.pack("<Q", len(stored)) + stored)


def statistics(
    counts: Mapping[int, int], times: Sequence[int], chunks: int, extras: Sequence[bytes] = ()
) -> bytes:
    """Return the statistics of a file with one schema."""
    kinds = [extra[0] for extra in extras]
    others = kinds.count(ATTACHMENT), kinds.count(METADATA), chunks, min(times), max(times)
    content = struct.pack("<QHIIIIQQ", sum(counts.values()), 1, len(counts), *others)
    pairs = b"".join(struct.pack("<HQ", number, count) for number, count in counts.items())
    return record(STATISTICS, content + text(pairs))


@dataclass
class McapBytes:
    """An MCAP, its parts by place, so that a test can harm exactly one of them."""

    chunks: Sequence[Sequence[Message]]
    topics: Mapping[int, str] = field(default_factory=lambda: {1: "/left", 2: "/right"})
    compression: str = "zstd"
    chunked: bool = True
    chunk_crc: bool = True
    data_crc: bool = True
    summary: bool = True
    statistics: bool = True
    message_index: bool = True
    repeated: bool = True
    """The summary repeats schemas and channels."""
    described_in_summary: bytes | None = None
    """The schemas and channels that the summary has instead of the data's."""
    described_later: Mapping[int, bytes] = field(default_factory=dict)
    """More schemas and channels at the start of a chunk, by its number."""
    between: Mapping[int, bytes] = field(default_factory=dict)
    """Records in front of a chunk, by its number."""
    stated_counts: Mapping[int, int] | None = None
    """Messages by channel that the statistics tell instead of the true ones."""
    indexed_as: str | None = None
    """The compression that the chunk indexes name instead of the true one."""
    extras: Sequence[bytes] = ()
    chunk_starts: list[int] = field(default_factory=list)
    chunk_ends: list[int] = field(default_factory=list)
    message_ends: list[int] = field(default_factory=list)
    """Where each message ends in the file, if it is not compressed."""
    data_end: int = 0
    summary_start: int = 0

    @property
    def written(self) -> list[Read]:
        """The messages, as they should come out."""
        messages = (message for chunk in self.chunks for message in chunk)
        return [Read(self.topics[each.channel], each.log_time, each.payload) for each in messages]

    def build(self) -> bytes:
        """Write the file, and note the places."""
        body = MAGIC + file_header()
        described = schema(1) + b"".join(channel(n, topic) for n, topic in self.topics.items())
        if not self.chunked:
            body += described
        indexes: list[bytes] = []
        for row, messages in enumerate(self.chunks):
            inside = described if not self.chunk_starts else b""
            inside += self.described_later.get(row, b"")
            body += self.between.get(row, b"")
            self.chunk_starts.append(len(body))
            if self.chunked:
                written, index = self._chunk(messages, inside, len(body))
                body += written
                indexes.append(index)
            else:
                for message in messages:
                    body += message.record()
                    self.message_ends.append(len(body))
        body += b"".join(self.extras)
        self.data_end = len(body)
        crc = zlib.crc32(body) if self.data_crc else 0
        body += record(DATA_END, struct.pack("<I", crc))
        return body + self._summary(len(body), described, indexes) + MAGIC

    def _chunk(self, messages: Sequence[Message], inside: bytes, place: int) -> tuple[bytes, bytes]:
        inner = inside
        entries: dict[int, bytes] = {}
        ends: list[int] = []
        for message in messages:
            entry = struct.pack("<QQ", message.log_time, len(inner))
            entries[message.channel] = entries.get(message.channel, b"") + entry
            inner += message.record()
            ends.append(len(inner))
        times = [message.log_time for message in messages] or [0]
        written = chunk(inner, self.compression, times, with_crc=self.chunk_crc)
        size = len(CODECS[self.compression](inner))
        self.message_ends.extend(place + len(written) - size + end for end in ends)
        chunk_length = len(written)
        self.chunk_ends.append(place + chunk_length)
        offsets = b""
        if self.message_index:
            for number, data in entries.items():
                offsets += struct.pack("<HQ", number, place + len(written))
                written += record(MESSAGE_INDEX, struct.pack("<H", number) + text(data))
        index = struct.pack("<QQQQ", min(times), max(times), place, chunk_length)
        index += text(offsets) + struct.pack("<Q", len(written) - chunk_length)
        named = self.compression if self.indexed_as is None else self.indexed_as
        index += text(named) + struct.pack("<QQ", size, len(inner))
        return written, record(CHUNK_INDEX, index)

    def _summary(self, place: int, described: bytes, indexes: Sequence[bytes]) -> bytes:
        self.summary_start = place if self.summary else 0
        section = b""
        if self.summary:
            if self.described_in_summary is not None:
                described = self.described_in_summary
            section = (described if self.repeated else b"") + b"".join(indexes)
            if self.statistics:
                messages = [message for chunk in self.chunks for message in chunk]
                counts = self.stated_counts or Counter(message.channel for message in messages)
                times = [message.log_time for message in messages] or [0]
                section += statistics(counts, times, len(indexes), self.extras)
        footer = struct.pack("<BQQQ", FOOTER, 20, self.summary_start, 0)
        return section + footer + struct.pack("<I", zlib.crc32(section + footer))


def small_mcap(compression: str = "zstd", chunks: int = 3, each: int = 4) -> McapBytes:
    """Return an MCAP of two topics, a few messages a chunk, each payload unlike all others."""
    numbers = count()
    messages = [
        [Message(1 + topic, time, payload, next(numbers)) for topic, time, payload in chunk]
        for chunk in small_chunks(chunks, each)
    ]
    return McapBytes(messages, compression=compression)


def resealed(data: bytes, mcap: McapBytes) -> bytes:
    """Return the file with the right checksum over its summary."""
    end = len(data) - len(MAGIC) - 4
    crc = zlib.crc32(data[mcap.summary_start : end])
    return data[:end] + struct.pack("<I", crc) + MAGIC
