"""Content of a decompressed chunk: which records found in it are kept, and what is lost."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from dogbot_logtool.core.arrays import Bytes, Flags
from dogbot_logtool.reader.containers.log import Chunk, Messages
from dogbot_logtool.reader.containers.loss import Loss
from dogbot_logtool.reader.containers.salvage.records import (
    Index,
    RecordFormat,
    Records,
    find_all,
    find_indexed,
)

_LAST_TIME = 2**63 - 1


class ChunkDamage(Exception):  # noqa: N818 - it never reaches a user; `Loss` does
    """A chunk cannot be used; the text says why."""

    def __init__(self, what: str, messages: int | None = None) -> None:
        """Say why.

        Args:
            what: the rest of the sentence "it was left out: ...".
            messages: how many were in it, if an index behind it says so.
        """
        super().__init__(what)
        self.messages = messages


class ChunkContent(NamedTuple):
    """What a container's own code finds in a decompressed chunk."""

    messages: Messages
    """Channels as numbered in the records, offsets relative to the chunk's first byte."""
    described: Sequence[bytes]
    """The records that describe channels."""
    losses: tuple[Loss, ...] = ()
    indexed: bool = False
    """The index behind the chunk names all messages truthfully."""


def left_out(chunk: Chunk, damage: ChunkDamage) -> Loss:
    """Say that nothing in a chunk can be used."""
    what = f"the chunk at byte {chunk.offset} was left out: {damage}"
    messages = chunk.messages if damage.messages is None else damage.messages
    return Loss(chunk.data_offset, what, chunk.data_size, messages)


def undescribed(chunk: Chunk, messages: Messages) -> Loss:
    """Say that the channels of some messages of a chunk are not described."""
    count, size = len(messages), int((messages.end - messages.start).sum())
    what = (
        f"the chunk at byte {chunk.offset} holds {count} {'message' if count == 1 else 'messages'} "
        "of channels that are nowhere described"
    )
    return Loss(chunk.offset, what, size, count)


def read_content(
    fmt: RecordFormat, data: Bytes, index: Index | None, chunk: Chunk, *, verified: bool
) -> ChunkContent:
    """Find the messages of a decompressed chunk.

    Args:
        fmt: how its records are written.
        data: (n,) the chunk, or as much of it as there is.
        index: what the index behind it names, if there is one.
        chunk: what is known of it; its counts are by channel as numbered in the records.
        verified: its checksum holds, so that its records are true whatever an index says.
    """
    is_cut = len(data) < chunk.size
    found = None if index is None or is_cut else find_indexed(fmt, data, index)
    is_indexed, skipped = found is not None, list[tuple[int, int]]()
    if found is None:
        found, skipped = find_all(fmt, data, 0, len(data))
    is_message = found.op == fmt.message
    messages = found if is_message.all() else found.pick(is_message)
    kept = _Kept(chunk, messages, not skipped and not is_cut)
    if index is not None and not is_indexed and not is_cut:
        kept.compare_index(index, verified=verified)
    kept.compare_times(believed=verified or is_indexed)
    # Unsigned log times that do not fit 64 bits with a sign.
    kept.leave_out(kept.messages.log_time < 0, "of times after the year 2262")
    if not kept.is_whole:
        named = None if index is None else len(index.offset)
        promised = named if chunk.messages is None else chunk.messages
        kept.account(skipped, chunk.size - len(data), promised)
    described = [
        data[found.offset[row] : found.end[row]].tobytes()
        for row in np.flatnonzero(~is_message).tolist()
        if found.op[row] in fmt.describing
    ]
    return ChunkContent(
        kept.messages.messages(),
        described,
        tuple(kept.losses),
        index is not None and is_indexed and index.complete,
    )


class _Kept:
    """Messages of a chunk that are kept, judged by its index and its stated times and counts."""

    def __init__(self, chunk: Chunk, messages: Records, is_whole: bool) -> None:  # noqa: FBT001
        self.chunk = chunk
        self.found = self.messages = messages
        self.is_whole = is_whole
        """All of its bytes are there, and records."""
        self.losses: list[Loss] = []
        kind = "the chunk" if chunk.is_record else "the run of messages"
        self._name = f"{kind} at byte {chunk.offset}"

    def _say(self, what: str) -> None:
        self.losses.append(Loss(self.chunk.offset, what))

    def leave_out(self, rows: Flags, what: str) -> None:
        """Leave out messages, if there are any."""
        if rows.any():
            lost, self.messages = self.messages.pick(rows), self.messages.pick(~rows)
            were = "1 message was" if len(lost) == 1 else f"{len(lost)} messages were"
            size = int((lost.end - lost.start).sum())
            whole = f"{were} left out of {self._name}: {what}"
            self.losses.append(Loss(self.chunk.offset, whole, size, len(lost)))

    def compare_index(self, index: Index, *, verified: bool) -> None:
        """Leave out messages whose time or channel differs from the index.

        One of the two is damaged, and it is not known which. An index record of which most entries
        differ is wrong itself. A checksum that holds speaks for the messages.
        """
        messages = self.messages
        if not len(index.offset) or not len(messages):
            return
        row = np.minimum(np.searchsorted(messages.offset, index.offset), len(messages) - 1)
        same_offset = messages.offset[row] == index.offset
        differs = same_offset & (
            (messages.channel[row] != index.channel) | (messages.log_time[row] != index.log_time)
        )
        # One that merely names fewer messages was cut off, or never meant to be complete.
        if self.is_whole and (differs.any() or not same_offset.all()):
            self._say(f"the index of {self._name} is wrong; it was read without it")
        if verified:
            return
        wrong, entries = np.bincount(index.group, differs), np.bincount(index.group)
        distrusted = (wrong > 1) & (2 * wrong > entries)
        doubtful = np.zeros(len(messages), np.bool_)
        doubtful[row[differs & ~distrusted[index.group]]] = True
        self.leave_out(doubtful, "the index tells another time or channel")

    def compare_times(self, *, believed: bool) -> None:
        """Leave out messages outside the chunk's stated range of times.

        Args:
            believed: a checksum or an index speaks for the messages, so the range is wrong.
        """
        times = self.messages.log_time
        if self.chunk.start_time is None or self.chunk.end_time is None or not len(times):
            return
        start, end = min(self.chunk.start_time, _LAST_TIME), min(self.chunk.end_time, _LAST_TIME)
        if (int(times.min()), int(times.max())) == (start, end):
            return
        outside = (times < start) | (times > end)
        mostly = 2 * int(outside.sum()) > len(times)
        if outside.any() and not believed and not mostly:
            self.leave_out(outside, "of times outside the range that is stated for it")
        elif self.is_whole and len(self.messages) == len(self.found):
            self._say(f"the range of times stated for {self._name} is wrong")

    def account(
        self, skipped: Sequence[tuple[int, int]], missing: int, promised: int | None
    ) -> None:
        """Account for bytes that are no records, and for messages that an index promises.

        Args:
            skipped: starts and ends of the bytes.
            missing: bytes at the chunk's end that are damaged or cut off.
            promised: messages; None: not known.
        """
        chunk = self.chunk
        lost = None if promised is None else max(promised - len(self.found), 0)
        size = sum(end - start for start, end in skipped)
        if missing:
            what = f"the last {missing} bytes in {self._name} are damaged or cut off"
        else:
            where = "" if len(skipped) == 1 else f" in {len(skipped)} places"
            what = f"{self._name} holds {size} bytes{where} that are no record"
        first = skipped[0][0] if skipped else chunk.size - missing
        offset = chunk.offset if chunk.is_compressed else chunk.data_offset + first
        self.losses.append(Loss(offset, what, size, lost))
