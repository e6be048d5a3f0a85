"""Content of a decompressed chunk: which records found in it are kept, and what is lost."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from dogbot_logtool.core.arrays import Bytes, Flags, Ints
from dogbot_logtool.reader.containers.log import Chunk
from dogbot_logtool.reader.containers.loss import Loss
from dogbot_logtool.reader.containers.salvage.records import (
    FoundRecords,
    Index,
    RecordFormat,
    find_all,
    find_indexed,
)
from dogbot_logtool.reader.decode.message_table import Messages


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


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class ChunkContent:
    """Messages that a container's own code finds in a decompressed chunk."""

    messages: Messages
    """Channels as numbered in the records, offsets relative to the chunk's first byte."""
    others: Ints
    """(k, 3) records that are no messages: kind, first byte, and end."""
    losses: tuple[Loss, ...] = ()
    indexed: bool = False
    """The index behind the chunk names all messages truthfully."""


def left_out(chunk: Chunk, damage: ChunkDamage) -> Loss:
    """Say that nothing in a chunk can be used."""
    what = f"the chunk at byte {chunk.offset} was left out: {damage}"
    messages = chunk.messages if damage.messages is None else damage.messages
    return Loss(chunk.offset, what, chunk.data_size, messages)


def undescribed(chunk: Chunk, messages: Messages) -> Loss:
    """Say that the channels of some messages of a chunk are not described."""
    count, size = len(messages), int((messages.end - messages.start).sum())
    what = (
        f"the chunk at byte {chunk.offset} holds {count} {'message' if count == 1 else 'messages'} "
        "of channels that are nowhere described"
    )
    return Loss(chunk.offset, what, size, count)


def read_content(
    fmt: RecordFormat, records: Bytes, index: Index | None, chunk: Chunk, *, verified: bool
) -> ChunkContent:
    """Find the messages of a decompressed chunk.

    Args:
        fmt: how its records are written.
        records: (n,) uint8, the chunk, or as much of it as there is.
        index: what the index behind it names, if there is one.
        chunk: what is known of it; its counts are by channel as numbered in the records.
        verified: its checksum holds, so that its records are true whatever an index says.
    """
    true_index = index if len(records) == chunk.size else None
    found = None if true_index is None else find_indexed(fmt, records, true_index)
    if found is None:
        true_index = None
        found = find_all(fmt, records, 0, len(records))
    check = _Check(chunk, found, found.messages.messages, chunk.size - len(records))
    if index is not None and true_index is None and not check.missing:
        check.compare_index(index, verified=verified)
    check.compare_times(believed=verified or true_index is not None)
    # Unsigned log times that do not fit 64 bits with a sign.
    check.leave_out(check.messages.log_time < 0, "of times after the year 2262")
    check.account(index, true_index)
    others, messages = found.others, check.messages
    return ChunkContent(
        messages=messages if check.keep.all() else messages.pick(check.keep),
        others=np.array([others.op, others.offset, others.messages.end]).T,
        losses=tuple(check.losses),
        indexed=true_index is not None and true_index.complete,
    )


@dataclass(slots=True)
class _Check:
    """Compares the messages of a chunk with its index and its stated times and counts."""

    chunk: Chunk
    found: FoundRecords
    messages: Messages
    missing: int
    """Bytes at its end that are damaged or cut off."""
    keep: Flags = field(init=False)
    losses: list[Loss] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.keep = np.ones(len(self.messages), np.bool_)

    @property
    def _is_whole(self) -> bool:
        return not self.found.skipped and not self.missing

    @property
    def _name(self) -> str:
        kind = "the chunk" if self.chunk.is_record else "the run of messages"
        return f"{kind} at byte {self.chunk.offset}"

    def _say(self, what: str) -> None:
        self.losses.append(Loss(self.chunk.offset, what))

    def leave_out(self, rows: Flags, what: str) -> None:
        """Leave out messages, if there are any."""
        rows = rows & self.keep
        count = int(rows.sum())
        if count:
            self.keep &= ~rows
            size = int((self.messages.end - self.messages.start)[rows].sum())
            were = "1 message was" if count == 1 else f"{count} messages were"
            whole = f"{were} left out of {self._name}: {what}"
            self.losses.append(Loss(self.chunk.offset, whole, size, count))

    def compare_index(self, index: Index, *, verified: bool) -> None:
        """Leave out messages whose time or channel differs from the index.

        One of the two is damaged, and it is not known which. An index record of which most entries
        differ is wrong itself. A checksum that holds speaks for the messages.
        """
        offset = self.found.messages.offset
        if not len(index.offset) or not len(offset):
            return
        row = np.minimum(np.searchsorted(offset, index.offset), len(offset) - 1)
        same_offset = offset[row] == index.offset
        differs = same_offset & (
            (self.messages.channel[row] != index.channel)
            | (self.messages.log_time[row] != index.log_time)
        )
        # One that merely names fewer messages was cut off, or never meant to be complete.
        if self._is_whole and (differs.any() or not same_offset.all()):
            self._say(f"the index of {self._name} is wrong; it was read without it")
        if verified:
            return
        wrong, entries = np.bincount(index.group, differs), np.bincount(index.group)
        distrusted = (wrong > 1) & (2 * wrong > entries)
        doubtful = np.zeros(len(offset), np.bool_)
        doubtful[row[differs & ~distrusted[index.group]]] = True
        self.leave_out(doubtful, "the index tells another time or channel")

    def compare_times(self, *, believed: bool) -> None:
        """Leave out messages outside the chunk's stated range of times.

        Args:
            believed: a checksum or an index speaks for the messages, so the range is wrong.
        """
        start, end = self.chunk.start_time, self.chunk.end_time
        if start is None or end is None or not self.keep.any():
            return
        limit = 2**63 - 1
        start, end = min(start, limit), min(end, limit)
        times = self.messages.log_time[self.keep]
        if (int(times.min()), int(times.max())) == (start, end):
            return
        outside = self.keep & ((self.messages.log_time < start) | (self.messages.log_time > end))
        mostly = 2 * int(outside.sum()) > len(times)
        if outside.any() and not believed and not mostly:
            self.leave_out(outside, "of times outside the range that is stated for it")
        elif self.keep.all() and self._is_whole:
            self._say(f"the range of times stated for {self._name} is wrong")

    def account(self, index: Index | None, true_index: Index | None) -> None:
        """Account for the bytes that are no records, and for messages that an index promises."""
        skipped, chunk = self.found.skipped, self.chunk
        if self._is_whole:
            if chunk.counts is not None:
                self._compare_counts(chunk.counts, true_index)
            return
        promised = chunk.messages
        if promised is None and index is not None:
            promised = len(index.offset)
        lost = None if promised is None else max(promised - len(self.messages), 0)
        size = sum(end - start for start, end in skipped)
        if self.missing:
            # A record that the cut goes through is no other damage.
            what = f"the last {self.missing} bytes in {self._name} are damaged or cut off"
            size = 0 if chunk.is_compressed else size
        else:
            where = "" if len(skipped) == 1 else f" in {len(skipped)} places"
            what = f"{self._name} holds {size} bytes{where} that are no record"
        first = skipped[0][0] if skipped else chunk.size - self.missing
        offset = chunk.offset if chunk.is_compressed else chunk.data_offset + first
        self.losses.append(Loss(offset, what, size, lost))

    def _compare_counts(self, stated: Mapping[int, int], true_index: Index | None) -> None:
        """Say where the log's index names other numbers of messages."""
        by_index = None if true_index is None else true_index.counts
        counts = Counter(self.messages.channel.tolist()) if by_index is None else by_index
        wrong = [n for n in sorted({*stated, *counts}) if stated.get(n, 0) != counts.get(n, 0)]
        if not wrong:
            return
        found, promised, of_channel = sum(counts.values()), sum(stated.values()), ""
        if found == promised:
            found, promised = counts.get(wrong[0], 0), stated.get(wrong[0], 0)
            of_channel = f" of channel {wrong[0]}"
        what = f"{self._name} holds {found} messages{of_channel} where the log's index names "
        self._say(f"{what}{promised}")
