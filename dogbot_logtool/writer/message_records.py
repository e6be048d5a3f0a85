"""MCAP message records of the output, many at a time."""

from collections.abc import Iterable, Iterator, Sequence
from itertools import groupby
from typing import Final, NamedTuple

import numpy as np
from mcap.opcode import Opcode

from dogbot_logtool.core.arrays import Bytes, Ints
from dogbot_logtool.io.mcap_layout import MESSAGE_HEAD, RECORD_HEAD
from dogbot_logtool.writer.template import Records

_MANY: Final = 64 << 10
"""Bytes of one channel's messages from which they get chunks of their own."""


class MessageRecords(NamedTuple):
    """Consecutive message records."""

    data: Bytes
    """(b,) the records."""
    bounds: Ints
    """(n + 1,) where each record begins and the last one ends."""
    channel: Ints
    """(n,) channel ids of the output."""
    log_time: Ints
    """(n,) ns."""

    def part(self, rows: slice) -> "MessageRecords":
        """Return consecutive messages."""
        bounds = self.bounds[rows.start : rows.stop + 1]
        first = int(bounds[0])
        return MessageRecords(
            self.data[first : int(bounds[-1])],
            bounds - first,
            self.channel[rows],
            self.log_time[rows],
        )


def recorded(
    channel: Ints,
    sequence: Ints,
    log_time: Ints,
    publish_time: Ints,
    buffer: Bytes,
    start: Ints,
    end: Ints,
) -> MessageRecords:
    """Return records of recorded messages, payloads byte for byte.

    Args:
        channel: (n,) channel ids of the output.
        sequence: (n,).
        log_time: (n,) ns.
        publish_time: (n,) ns.
        buffer: (b,) holds the payloads.
        start: (n,) offset of each payload's first byte.
        end: (n,) offset after its last byte.
    """
    size = end - start
    head = np.empty(len(size), MESSAGE_HEAD)
    head["opcode"] = Opcode.MESSAGE
    head["length"] = size + (MESSAGE_HEAD.itemsize - RECORD_HEAD.size)
    head["channel"] = channel
    head["sequence"] = sequence
    head["log_time"] = log_time
    head["publish_time"] = publish_time
    # Slices of Python: to gather and scatter pieces with numpy takes as long, and more lines.
    pieces: list[bytes | memoryview] = [b""] * (2 * len(size))
    pieces[::2] = head.view(f"V{MESSAGE_HEAD.itemsize}").tolist()
    payloads = buffer.data
    pieces[1::2] = [payloads[a:b] for a, b in zip(start.tolist(), end.tolist(), strict=True)]
    data = np.frombuffer(b"".join(pieces), np.uint8)
    return MessageRecords(data, _bounds(size + MESSAGE_HEAD.itemsize), channel, log_time)


def of_payloads(channel: int, payloads: Iterable[bytes], log_time: Ints) -> MessageRecords:
    """Return records of messages of one channel, (n,) ns."""
    made = list(payloads)
    end = np.cumsum([len(each) for each in made], dtype=np.int64)
    start, none = np.append(0, end)[:-1], np.zeros(len(made), np.int64)
    data = np.frombuffer(b"".join(made), np.uint8)
    return recorded(none + channel, none, log_time, log_time, data, start, end)


def by_channel(parts: Iterable[Records]) -> Iterator[MessageRecords]:
    """Group records by channel: each channel that has many, then the rest together.

    Messages of one channel are similar, so they compress better together; and a reader of some
    channels skips the chunks of the others.

    Args:
        parts: copies of record templates, each (k,) and of one channel. They are made one after
            the other, so that few are in memory at once; parts of a channel that are not
            neighbours make several groups.
    """
    few: list[Records] = []
    for _, same in groupby(filter(len, parts), lambda part: int(part["channel"][0])):
        of_channel = list(same)
        if sum(part.nbytes for part in of_channel) < _MANY:
            few.extend(of_channel)
        else:
            yield in_time_order(of_channel)
    if few:
        yield in_time_order(few)


def in_time_order(parts: Sequence[Records]) -> MessageRecords:
    """Return records sorted by log time; at equal times the earlier part comes first.

    Args:
        parts: copies of record templates, each (k,).
    """
    log_time, channel = (_joined(parts, field) for field in ("log_time", "channel"))
    counts = [len(part) for part in parts]
    order = np.argsort(log_time, kind="stable")
    bounds = _bounds(np.repeat([part.dtype.itemsize for part in parts], counts)[order])
    offset = np.empty_like(order)
    offset[order] = bounds[:-1]
    data = np.empty(int(bounds[-1]), np.uint8)
    for part, own in zip(parts, np.split(offset, np.cumsum(counts)[:-1]), strict=True):
        width = part.dtype.itemsize
        windows = np.ndarray((len(data) - width + 1,), f"V{width}", data.data, 0, (1,))
        windows[own] = part.view(f"V{width}")
    return MessageRecords(data, bounds, channel[order], log_time[order])


def _joined(parts: Sequence[Records], field: str) -> Ints:
    return np.concatenate([part[field] for part in parts]).astype(np.int64)


def _bounds(size: Ints) -> Ints:
    return np.concatenate([[0], np.cumsum(size)])
