"""Messages that a recorder compressed one by one."""

from dataclasses import replace
from typing import Final

import numpy as np
import zstandard

from dogbot_logtool.core.arrays import Bytes, Flags
from dogbot_logtool.reader.containers.batch import Batch
from dogbot_logtool.reader.containers.loss import Loss
from dogbot_logtool.reader.containers.signatures import ZSTD_MAGIC
from dogbot_logtool.reader.decode.columns import gather
from dogbot_logtool.reader.decode.message_table import Messages

_BUDGET: Final = 64 << 20
_MAX_RATIO: Final = 40
"""A batch must not swell to more than this times its size, or `_BUDGET`."""


def unpacked(batch: Batch) -> Batch:
    """Decompress the messages of a batch that are zstd frames of their own."""
    messages = batch.messages
    packed = _is_packed(batch.buffer, messages)
    if not packed.any():
        return batch
    parts: list[bytes] = []
    kept = np.ones(len(messages), np.bool_)
    left = max(_BUDGET, _MAX_RATIO * len(batch.buffer))
    for row, (start, end) in enumerate(
        zip(messages.start.tolist(), messages.end.tolist(), strict=True)
    ):
        data = batch.buffer[start:end].tobytes()
        if packed[row]:
            plain = _decompress(data, left)
            kept[row] = plain is not None
            data = plain or b""
        left -= len(data)
        parts.append(data)
    sizes = np.array([len(part) for part in parts], np.int64)
    ends = np.cumsum(sizes)
    buffer = np.frombuffer(b"".join(parts) or b"\0", np.uint8)
    fresh = replace(batch, buffer=buffer, messages=replace(messages, start=ends - sizes, end=ends))
    if kept.all():
        return fresh
    lost = int((~kept).sum())
    loss = Loss(0, f"{lost} messages cannot be decompressed", 0, lost)
    return replace(fresh.only(kept), losses=(*batch.losses, loss))


def _is_packed(buffer: Bytes, messages: Messages) -> Flags:
    packed = (messages.end - messages.start) >= len(ZSTD_MAGIC)
    if packed.any():
        heads = gather(buffer, messages.start[packed], len(ZSTD_MAGIC))
        packed[packed] = heads == np.void(ZSTD_MAGIC)
    return packed


def _decompress(data: bytes, most: int) -> bytes | None:
    """Return the content of a frame; None if it is damaged or larger than allowed."""
    try:
        size = zstandard.frame_content_size(data)
        if not most > 0 or size > most:
            return None
        plain = zstandard.ZstdDecompressor().decompress(data, max_output_size=most)
    except (zstandard.ZstdError, MemoryError):
        return None
    return plain if len(plain) <= most else None
