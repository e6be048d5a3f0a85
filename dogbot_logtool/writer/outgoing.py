"""Messages on their way out: heads as columns, payloads in groups of equal size."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Final

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.arrays import Ints, stable_order

Bytes = NDArray[np.uint8]
MESSAGE_OPCODE: Final = 0x05
MESSAGE_HEAD: Final = np.dtype(
    [
        ("opcode", "u1"),
        ("length", "<u8"),
        ("channel", "<u2"),
        ("sequence", "<u4"),
        ("log_time", "<i8"),
        ("publish_time", "<i8"),
    ]
)
"""An MCAP message record up to its payload."""
_RECORD_HEAD_SIZE: Final = 9
_FEW: Final = 4
"""Groups of up to so many messages are copied one by one."""


@dataclass(frozen=True, slots=True)
class Payloads:
    """Payloads of one size."""

    rows: Ints
    """(k,) the messages they belong to."""
    data: NDArray[np.void]
    """(m,) of dtype ``V<size>``: the payloads, or windows that begin at each byte of a buffer."""
    at: Ints | None = None
    """(k,) which of the data they are; None: all, in order."""


@dataclass(frozen=True, slots=True)
class Outgoing:
    """Messages to be written, in any order."""

    channel: Ints
    """(n,) channel ids of the output."""
    sequence: Ints
    log_time: Ints
    """(n,) ns."""
    publish_time: Ints
    """(n,) ns."""
    size: Ints
    """(n,) bytes of each payload."""
    payloads: Sequence[Payloads]


def stamped(channel: int | Ints, log_time: Ints, records: NDArray[np.void]) -> Outgoing:
    """Return stamped-out messages of one size.

    Args:
        channel: id of their channel, or (n,) of the channel of each.
        log_time: (n,) ns; the publish time is the same.
        records: (n,) messages.
    """
    count, size = len(log_time), records.dtype.itemsize
    return Outgoing(
        channel=np.full(count, channel, np.int64),
        sequence=np.zeros(count, np.int64),
        log_time=log_time,
        publish_time=log_time,
        size=np.full(count, size, np.int64),
        payloads=[Payloads(np.arange(count), records.view(f"V{size}"))] if count else [],
    )


def in_time_order(parts: Sequence[Outgoing]) -> Outgoing:
    """Merge messages by log time; at equal times the earlier part comes first."""
    log_time = np.concatenate([part.log_time for part in parts])
    order = np.argsort(log_time, kind="stable")
    place = np.empty(len(order), np.int64)
    place[order] = np.arange(len(order))
    payloads: list[Payloads] = []
    first = 0
    for part in parts:
        places = place[first : first + len(part.log_time)]
        payloads.extend(replace(group, rows=places[group.rows]) for group in part.payloads)
        first += len(part.log_time)
    return Outgoing(
        channel=np.concatenate([part.channel for part in parts])[order],
        sequence=np.concatenate([part.sequence for part in parts])[order],
        log_time=log_time[order],
        publish_time=np.concatenate([part.publish_time for part in parts])[order],
        size=np.concatenate([part.size for part in parts])[order],
        payloads=payloads,
    )


def lay_out(messages: Outgoing) -> tuple[Bytes, Ints]:
    """Write the messages as MCAP records, one after the other.

    Returns:
        the bytes, and (n + 1,) where each record begins and the last one ends.
    """
    ends = np.cumsum(messages.size + MESSAGE_HEAD.itemsize)
    bounds = np.concatenate([[0], ends])
    records = np.empty(int(bounds[-1]), np.uint8)
    head = np.empty(len(messages.channel), MESSAGE_HEAD)
    head["opcode"] = MESSAGE_OPCODE
    head["length"] = messages.size + (MESSAGE_HEAD.itemsize - _RECORD_HEAD_SIZE)
    head["channel"] = messages.channel
    head["sequence"] = messages.sequence
    head["log_time"] = messages.log_time
    head["publish_time"] = messages.publish_time
    _scatter(records, bounds[:-1], head.view(f"V{MESSAGE_HEAD.itemsize}"))
    payload_place = bounds[:-1] + MESSAGE_HEAD.itemsize
    for group in messages.payloads:
        # Recorded payloads are fetched only here, a size at a time, while they are in the cache.
        data = group.data if group.at is None else group.data[group.at]
        _scatter(records, payload_place[group.rows], data)
    return records, bounds


def _scatter(target: Bytes, place: Ints, data: NDArray[np.void]) -> None:
    """Write pieces of one size to their places, in one call through an overlapping view."""
    size = data.dtype.itemsize
    if not len(place) or not size:
        return
    if len(place) <= _FEW:
        for start, piece in zip(place.tolist(), data, strict=True):
            target[start : start + size] = np.frombuffer(piece.tobytes(), np.uint8)
        return
    windows: NDArray[np.void] = np.ndarray(
        (len(target) - size + 1,), f"V{size}", target.data, 0, (1,)
    )
    windows[place] = data


def recorded(
    channel: Ints,
    sequence: Ints,
    log_time: Ints,
    publish_time: Ints,
    buffer: Bytes,
    start: Ints,
    end: Ints,
) -> Outgoing:
    """Return recorded messages, payloads byte for byte.

    Args:
        channel: (n,) channel ids of the output.
        sequence: (n,).
        log_time: (n,) ns.
        publish_time: (n,) ns.
        buffer: where the payloads are.
        start: (n,) first byte of each payload.
        end: (n,) first byte after it.
    """
    size = end - start
    if not len(size):
        return Outgoing(channel, sequence, log_time, publish_time, size, [])
    order = stable_order(size)
    in_order, begin = size[order], start[order]
    changes = np.flatnonzero(in_order[1:] != in_order[:-1]) + 1
    payloads: list[Payloads] = []
    for first, last in pairwise([0, *changes.tolist(), len(order)]):
        if length := int(in_order[first]):
            windows: NDArray[np.void] = np.ndarray(
                (len(buffer) - length + 1,), f"V{length}", buffer.data, 0, (1,)
            )
            payloads.append(Payloads(order[first:last], windows, begin[first:last]))
    return Outgoing(channel, sequence, log_time, publish_time, size, payloads)
