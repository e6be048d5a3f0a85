"""Records in a row, whatever the container: found through an index, or by following their lengths.

An index is only a hint: it is believed when every record that it names is what it says and the
records tile the bytes, so that nothing is missing. Otherwise the records are followed one after
another; behind a damaged one the search goes on at the next sound one.
"""

import re
from collections.abc import Callable
from dataclasses import dataclass, fields
from typing import Final, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.arrays import Bytes, Ints, concatenated
from dogbot_logtool.reader.containers.log import Messages

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
