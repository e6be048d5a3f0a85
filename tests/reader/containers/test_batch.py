"""Messages of a batch in the order of their log times."""

from itertools import pairwise

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from dogbot_logtool.reader.containers.batch import Batch, LoadedChunk
from dogbot_logtool.reader.containers.contents import Chunk
from dogbot_logtool.reader.decode.message_table import Messages

ROWS = st.lists(st.tuples(st.integers(0, 2), st.integers(0, 9)), max_size=30)
"""Channel and log time of each message."""


def batch_of(rows: list[tuple[int, int]], split: int) -> Batch:
    """Return messages in two chunks; their sequence numbers are their rows in the file."""
    channel, time = np.array(rows, np.int64).reshape(-1, 2).T
    number = np.arange(len(rows))
    messages = Messages(channel, time, time, number, number, number)
    chunk = Chunk(0, 0, 0, 0, 0, "", 0)
    rows_of = (slice(0, split), slice(split, len(rows)))
    chunks = tuple(LoadedChunk(chunk, memoryview(b""), 0, own, whole=True) for own in rows_of)
    return Batch(np.zeros(1, np.uint8), messages, chunks)


@given(ROWS, st.data())
def test_messages_of_each_channel_follow_in_time(
    rows: list[tuple[int, int]], data: st.DataObject
) -> None:
    batch = batch_of(rows, data.draw(st.integers(0, len(rows))))
    back = sum(
        b < a
        for channel in range(3)
        for times in [[time for each, time in rows if each == channel]]
        for a, b in pairwise(times)
    )
    ordered = batch.in_time_order()
    assert ordered.out_of_order == back
    if not back:
        assert ordered is batch
        return
    expected = sorted(range(len(rows)), key=lambda row: rows[row][1])
    assert ordered.messages.sequence.tolist() == expected
    assert [each.rows for each in ordered.chunks] == [
        slice(0, len(rows)),
        slice(len(rows), len(rows)),
    ]
    assert not any(each.whole for each in ordered.chunks)
