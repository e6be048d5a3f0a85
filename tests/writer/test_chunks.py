"""Chunks, as the mcap library reads them back."""

from collections import defaultdict
from io import BytesIO
from typing import get_args

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from mcap import records
from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.stream_reader import breakup_chunk

from dogbot_logtool.writer.chunks import (
    CHUNK_SIZE,
    Compression,
    FinishedChunk,
    finish_chunks,
    indexed_channels,
)
from dogbot_logtool.writer.message_records import MessageRecords, recorded

COMPRESSIONS: tuple[Compression, ...] = get_args(Compression)
HEAD = 9


def parse(chunk: FinishedChunk) -> records.Chunk:
    record = bytes(chunk.record)
    assert record[0] == Opcode.CHUNK
    assert int.from_bytes(record[1:HEAD], "little") == len(record) - HEAD
    parsed: records.Chunk = records.Chunk.read(ReadDataStream(BytesIO(record[HEAD:])))
    return parsed


def parse_index(chunk: FinishedChunk) -> dict[int, records.MessageIndex]:
    """Read the message index records from where the chunk says that they begin."""
    found: dict[int, records.MessageIndex] = {}
    listed = list(indexed_channels(chunk.index))
    for channel, place, count in listed:
        assert chunk.index[place] == Opcode.MESSAGE_INDEX
        index = records.MessageIndex.read(
            ReadDataStream(BytesIO(chunk.index[place + HEAD :].tobytes()))
        )
        assert (index.channel_id, len(index.records)) == (channel, count)
        found[channel] = index
    sizes = [int.from_bytes(chunk.index[p + 1 : p + HEAD], "little") for _, p, _ in listed]
    assert sum(sizes) + HEAD * len(sizes) == len(chunk.index)
    return found


def check(chunk: FinishedChunk, compression: Compression) -> list[records.Message]:
    """Compare everything that a chunk says of itself with its messages."""
    parsed = parse(chunk)
    assert parsed.compression == ("" if compression == "none" else compression)
    assert (chunk.compression, chunk.compressed_size) == (parsed.compression, len(parsed.data))
    assert parsed.uncompressed_crc != 0
    broken_up = breakup_chunk(parsed, validate_crc=True)
    messages = [record for record in broken_up if isinstance(record, records.Message)]
    assert len(messages) == len(broken_up)
    times = [message.log_time for message in messages]
    assert (parsed.message_start_time, parsed.message_end_time) == (min(times), max(times))
    assert (chunk.start_time, chunk.end_time) == (min(times), max(times))
    assert chunk.size == parsed.uncompressed_size
    wanted: dict[int, list[tuple[int, int]]] = defaultdict(list)
    place = 0
    for message in messages:
        wanted[message.channel_id].append((message.log_time, place))
        place += HEAD + 22 + len(message.data)
    assert place == chunk.size
    assert {channel: index.records for channel, index in parse_index(chunk).items()} == wanted
    return messages


def outgoing(channels: list[int], times: list[int], payloads: list[bytes]) -> MessageRecords:
    size = np.array([len(payload) for payload in payloads], np.int64)
    end = np.cumsum(size)
    time = np.array(times, np.int64)
    return recorded(
        np.array(channels, np.int64),
        np.zeros(len(times), np.int64),
        time,
        time,
        np.frombuffer(b"".join(payloads), np.uint8),
        end - size,
        end,
    )


@pytest.mark.parametrize("compression", COMPRESSIONS)
@given(
    rows=st.lists(
        st.tuples(st.integers(0, 3), st.integers(0, 2**62), st.binary(max_size=50)), min_size=1
    )
)
def test_any_messages(compression: Compression, rows: list[tuple[int, int, bytes]]) -> None:
    channels, times, payloads = (list(column) for column in zip(*rows, strict=True))
    chunks = list(finish_chunks(outgoing(channels, times, payloads), compression))
    messages = [message for chunk in chunks for message in check(chunk, compression)]
    assert [(m.channel_id, m.log_time, m.data) for m in messages] == rows


def test_a_message_larger_than_a_chunk_is_not_split() -> None:
    payloads = [b"a", bytes(CHUNK_SIZE + 5), b"b", bytes(3 * CHUNK_SIZE), b"c", b"d"]
    chunks = list(finish_chunks(outgoing([1] * 6, list(range(6)), payloads), "none"))
    messages = [[len(m.data) for m in check(chunk, "none")] for chunk in chunks]
    assert [size for chunk in messages for size in chunk] == [len(p) for p in payloads]
    assert len(chunks) >= 3
