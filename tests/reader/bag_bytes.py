"""ROS 1 bags written byte by byte, so that each fault of one is exact."""

import bz2
import struct
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from types import MappingProxyType
from typing import NamedTuple

import lz4.frame

from tests.reader.reading import Read, small_chunks

MAGIC = b"#ROSBAG V2.0\n"
SECOND = 1_000_000_000
U32 = struct.Struct("<I")
TYPE = "std_msgs/String"
DEFINITION = "string data\n"


def header(**fields: bytes) -> bytes:
    parts = (name.encode() + b"=" + value for name, value in fields.items())
    return b"".join(U32.pack(len(part)) + part for part in parts)


def record(data: bytes, **fields: bytes) -> bytes:
    head = header(**fields)
    return U32.pack(len(head)) + head + U32.pack(len(data)) + data


def time(ns: int) -> bytes:
    return struct.pack("<II", *divmod(ns, SECOND))


class Message(NamedTuple):
    connection: int
    log_time: int
    payload: bytes

    def record(self) -> bytes:
        return record(
            self.payload, op=b"\x02", conn=U32.pack(self.connection), time=time(self.log_time)
        )


class Connection(NamedTuple):
    number: int
    topic: str
    type_name: str = TYPE
    definition: str = DEFINITION
    extra: Mapping[str, bytes] = MappingProxyType({})

    def record(self) -> bytes:
        sent = header(
            topic=self.topic.encode(),
            type=self.type_name.encode(),
            md5sum=b"992ce8a1687cec8c8bd883ec73ca41d1",
            message_definition=self.definition.encode(),
            **self.extra,
        )
        return record(sent, op=b"\x07", conn=U32.pack(self.number), topic=self.topic.encode())


LZ4_OF_ROSBAG = partial(
    lz4.frame.compress,
    block_size=lz4.frame.BLOCKSIZE_MAX4MB,
    block_linked=False,
    content_checksum=True,
    store_size=False,
)
CODECS: Mapping[str, Callable[[bytes], bytes]] = {
    "none": bytes,
    "bz2": bz2.compress,
    "lz4": LZ4_OF_ROSBAG,
}


def chunk(
    inner: bytes, compression: str, compress: Callable[[bytes], bytes] | None = None
) -> bytes:
    stored = (compress or CODECS[compression])(inner)
    size = U32.pack(len(inner))
    return record(stored, op=b"\x05", compression=compression.encode(), size=size)


@dataclass
class BagBytes:
    """A bag, its parts by name and place, so that a test can harm exactly one of them."""

    chunks: Sequence[Sequence[Message]]
    connections: Sequence[Connection]
    compression: str = "none"
    compress: Callable[[bytes], bytes] | None = None
    in_chunks: bool = True
    """The first chunk holds the connection records."""
    in_index_section: Sequence[Connection] | None = None
    """The connections that the index section describes instead of the true ones."""
    described_later: Mapping[int, bytes] = field(default_factory=dict)
    """More connection records at the start of a chunk, by its number."""
    zeros: int = 0
    """Zero bytes before the index section."""
    indexed: bool = True
    chunk_ends: list[int] = field(default_factory=list)
    """Where each chunk record ends in the file."""
    chunk_starts: list[int] = field(default_factory=list)
    message_ends: list[int] = field(default_factory=list)
    """Where each message ends in the file, if it is not compressed."""
    index_place: int = 0

    @property
    def written(self) -> list[Read]:
        """The messages, as they should come out."""
        topics = {connection.number: connection.topic for connection in self.connections}
        messages = (message for chunk in self.chunks for message in chunk)
        return [Read(topics[each.connection], each.log_time, each.payload) for each in messages]

    def build(self) -> bytes:
        """Write the bag, and note the places."""
        infos: list[bytes] = []
        body = b""
        start = len(MAGIC) + 4096
        for messages in self.chunks:
            place = start + len(body)
            self.chunk_starts.append(place)
            body += self._chunk(messages, place)
            infos.append(chunk_info(place, messages))
        body += b"\0" * self.zeros
        self.index_place = start + len(body)
        head = bag_header(
            self.index_place if self.indexed else 0, len(self.connections), len(self.chunks)
        )
        index = b""
        if self.indexed:
            described = self.in_index_section or self.connections
            index = b"".join([*(connection.record() for connection in described), *infos])
        return MAGIC + head + body + index

    def _chunk(self, messages: Sequence[Message], place: int) -> bytes:
        inner = b""
        if self.in_chunks and len(self.chunk_starts) == 1:
            inner = b"".join(connection.record() for connection in self.connections)
        inner += self.described_later.get(len(self.chunk_starts) - 1, b"")
        offsets = [len(inner)]
        for message in messages:
            inner += message.record()
            offsets.append(len(inner))
        written = chunk(inner, self.compression, self.compress)
        data_place = place + len(written) - len(inner)
        self.message_ends.extend(data_place + end for end in offsets[1:])
        self.chunk_ends.append(place + len(written))
        return written + index_records(messages, offsets)


def bag_header(index_place: int, connections: int, chunks: int) -> bytes:
    head = header(
        op=b"\x03",
        index_pos=struct.pack("<Q", index_place),
        conn_count=U32.pack(connections),
        chunk_count=U32.pack(chunks),
    )
    padding = 4096 - 8 - len(head)
    return U32.pack(len(head)) + head + U32.pack(padding) + b" " * padding


def index_records(messages: Sequence[Message], offsets: Sequence[int]) -> bytes:
    written = b""
    for number in sorted({message.connection for message in messages}):
        entries = [
            time(message.log_time) + U32.pack(offset)
            for message, offset in zip(messages, offsets, strict=False)
            if message.connection == number
        ]
        written += record(
            b"".join(entries),
            op=b"\x04",
            ver=U32.pack(1),
            conn=U32.pack(number),
            count=U32.pack(len(entries)),
        )
    return written


def chunk_info(place: int, messages: Sequence[Message]) -> bytes:
    counts = Counter(message.connection for message in messages)
    times = [message.log_time for message in messages] or [0]
    return record(
        b"".join(U32.pack(number) + U32.pack(count) for number, count in counts.items()),
        op=b"\x06",
        ver=U32.pack(1),
        chunk_pos=struct.pack("<Q", place),
        start_time=time(min(times)),
        end_time=time(max(times)),
        count=U32.pack(len(counts)),
    )


def small_bag(compression: str = "none", chunks: int = 3, each: int = 4) -> BagBytes:
    """Return a bag of two topics, a few messages a chunk, each payload unlike all others."""
    messages = [[Message(*one) for one in chunk] for chunk in small_chunks(chunks, each)]
    return BagBytes(messages, [Connection(0, "/left"), Connection(1, "/right")], compression)
