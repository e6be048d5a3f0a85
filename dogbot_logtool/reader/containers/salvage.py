"""Records in a row, whatever the container, and which of those in a chunk are kept.

Records are found through an index, or by following their lengths. An index is only a hint: it is
believed when every record that it names is what it says and the records tile the bytes, so that
nothing is missing. Otherwise the records are followed one after another; behind a damaged one the
search goes on at the next sound one.
"""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from typing import Final, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.arrays import Bytes, Flags, Ints, concatenated
from dogbot_logtool.reader.containers.log import Chunk, Messages
from dogbot_logtool.reader.containers.loss import Loss

_FIRST_WINDOW: Final = 1 << 12
_LARGEST_WINDOW: Final = 1 << 20
"""Bytes that are searched at a time. The next sound record is mostly near."""
_OVERLAP: Final = 1 << 12
"""Bytes of the next window that a candidate may need to be seen as one."""
LONGEST_START: Final = 64
"""Bytes in which a record's head is seen as one."""
SHORTEST_RECORD: Final = 24
"""Fewer bytes at the end are taken for a record that is cut off."""
_FIRST_BLOCK: Final = 64
_LARGEST_BLOCK: Final = 1 << 16
_LAST_TIME: Final = 2**63 - 1


Read = Callable[[int, int], bytes]
"""Returns up to some bytes from an offset of a file, or of memory; fewer at the end."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Records(Messages):
    """Neighbouring records of all kinds.

    The columns of messages are zero for others, but for the bytes of their content.
    """

    op: Ints
    """(n,) kind of the record, 0 where the bytes are no sound record."""
    offset: Ints
    """(n,) first byte of the record."""

    def messages(self) -> Messages:
        """Return those columns that messages have."""
        return Messages(*(getattr(self, column.name) for column in fields(Messages)))


class Index(NamedTuple):
    """A chunk's index of its messages, in the order of their offsets."""

    offset: Ints
    """(n,) of the record in the decompressed chunk."""
    channel: Ints
    """(n,) as numbered in the records."""
    log_time: Ints
    """(n,) ns."""
    group: Ints
    """(n,) which index record named it."""
    complete: bool
    """Nothing but index records was there."""


IndexRecord = tuple[int, memoryview, int]
"""The channel of a record that names messages, its entries, and where it ends."""


def read_index(
    behind: memoryview,
    record_at: Callable[[memoryview, int], IndexRecord | None],
    entry: np.dtype[np.void],
    log_times: Callable[[NDArray[np.void]], Ints],
) -> Index | None:
    """Return what the records behind a chunk name; None if there are none to be read.

    Args:
        behind: the bytes behind the chunk.
        record_at: reads the record at an offset; None: there is none.
        entry: how an entry is written, with its ``offset``.
        log_times: returns the log times of entries, ns.
    """
    parts: list[memoryview] = []
    named: list[tuple[int, int]] = []
    end = 0
    while end < len(behind) and (record := record_at(behind, end)):
        if len(record[1]) % entry.itemsize:
            break
        channel, entries, end = record
        count = len(entries) // entry.itemsize
        parts.append(entries)
        named.append((channel, count))
    if not parts:
        return None
    table = np.frombuffer(b"".join(parts), entry)
    channels, counts = np.array(named, np.int64).T
    # Offsets beyond 2^63 become negative, and no message begins there either.
    offset = table["offset"].astype(np.int64)
    order = np.argsort(offset, kind="stable")
    group = np.repeat(np.arange(len(counts)), counts)[order]
    complete = end == len(behind)
    log_time = log_times(table)[order]
    return Index(offset[order], channels[group], log_time, group, complete)


class RecordFormat(Protocol):
    """How a container writes records."""

    message: int
    """Kind of a message record."""
    describing: frozenset[int]
    """Kinds of the records that describe channels."""
    record_start: re.Pattern[bytes]
    """Matches where a record may begin."""

    def chain(self, data: memoryview, offset: int, end: int, limit: int) -> list[int]:
        """Follow the records' lengths.

        Returns:
            the first bytes of up to `limit` records that fit, and where the last one ends.
        """

    def decode(self, records: Bytes, offset: Ints) -> Records:
        """Decode the heads of records; of those that do not fit the bytes the kind is 0.

        Args:
            records: the bytes.
            offset: (n,) ascending.
        """

    def sound(self, read: Read, offset: int, end: int) -> bool:
        """Tell whether a record begins here, beyond reasonable doubt."""


def next_sound(fmt: RecordFormat, read: Read, offset: int, end: int) -> int:
    """Return where the next sound record begins, or the end."""
    size = _FIRST_WINDOW
    while offset < end:
        window = read(offset, min(size + _OVERLAP, end - offset))
        for match in fmt.record_start.finditer(window):
            candidate = offset + match.start()
            if match.start() >= size:
                break
            if fmt.sound(read, candidate, end):
                return candidate
        offset += size
        size = min(2 * size, _LARGEST_WINDOW)
    return end


def find_indexed(fmt: RecordFormat, records: Bytes, index: Index) -> Records | None:
    """Return the records, or None if the index does not describe them truthfully."""
    messages = fmt.decode(records, index.offset)
    if (
        (messages.op != fmt.message).any()
        or (messages.channel != index.channel).any()
        or (messages.log_time != index.log_time).any()
    ):
        return None
    gap_start = np.concatenate([[0], messages.end])
    gap_end = np.concatenate([messages.offset, [len(records)]])
    gaps = np.flatnonzero(gap_start != gap_end)
    if (gap_end[gaps] < gap_start[gaps]).any():
        return None
    parts = [messages]
    for start, end in zip(gap_start[gaps].tolist(), gap_end[gaps].tolist(), strict=True):
        others, skipped = find_all(fmt, records, start, end)
        if skipped or (others.op == fmt.message).any():
            return None
        parts.append(others)
    return concatenated(parts)


def find_all(
    fmt: RecordFormat, records: Bytes, start: int, end: int
) -> tuple[Records, list[tuple[int, int]]]:
    """Follow the records; behind damage go on at the next sound one.

    Returns:
        the records; and starts and ends of the bytes that are none.
    """
    parts: list[Records] = [fmt.decode(records, np.empty(0, np.int64))]
    skipped: list[tuple[int, int]] = []
    offset, block = start, _FIRST_BLOCK
    while offset < end:
        bounds = fmt.chain(records.data, offset, end, block)
        part = fmt.decode(records, np.array(bounds[:-1], np.int64))
        count = int(np.append(part.op == 0, True).argmax())
        if count:
            parts.append(part.pick(slice(count)))
        offset = bounds[count]
        if count == block:
            block = min(2 * block, _LARGEST_BLOCK)
        elif offset < end:
            damage, last = offset, parts[-1]
            is_behind = len(last) and last.end[-1] == offset
            if is_behind and not may_begin(fmt, records, offset, end):
                damage = int(last.offset[-1])
                parts[-1] = last.pick(slice(len(last) - 1))
            offset = next_sound(fmt, reader_of(records), damage + 1, end)
            skipped.append((damage, offset))
            block = _FIRST_BLOCK
    return concatenated(parts), skipped


def reader_of(records: Bytes) -> Read:
    """Return what reads bytes in memory like those of a file."""
    return lambda offset, size: records[offset : offset + size].tobytes()


def may_begin(fmt: RecordFormat, records: Bytes, offset: int, end: int) -> bool:
    """Tell whether bytes that are no whole record look like the head of one.

    Where they do not, the record before them is given up, too: its length may be wrong.
    """
    head = records[offset : min(offset + LONGEST_START, end)].tobytes()
    return offset + SHORTEST_RECORD > end or fmt.record_start.match(head) is not None


# Which of the records in a chunk are kept


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
    return Loss(chunk.data_offset, what, chunk.end - chunk.data_offset, messages)


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
