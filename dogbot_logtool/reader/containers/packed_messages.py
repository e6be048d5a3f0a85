"""Messages that a recorder compressed one by one."""

from dataclasses import replace
from typing import Final

import numpy as np
import zstandard

from dogbot_logtool.reader.containers.log import Batch
from dogbot_logtool.reader.containers.loss import Loss
from dogbot_logtool.reader.containers.registry import ZSTD_MAGIC
from dogbot_logtool.reader.decode.columns import gather

_BUDGET: Final = 64 << 20
_MAX_RATIO: Final = 40
"""A batch must not swell to more than this times its size, or `_BUDGET`."""


def unpacked(batch: Batch) -> Batch:
    """Decompress the messages of a batch that are zstd frames of their own."""
    messages = batch.messages
    packed = messages.end - messages.start >= len(ZSTD_MAGIC)
    if packed.any():
        heads = gather(batch.buffer, messages.start[packed], len(ZSTD_MAGIC))
        packed[packed] = heads == np.void(ZSTD_MAGIC)
    if not packed.any():
        return batch
    parts: list[bytes | None] = []
    left = max(_BUDGET, _MAX_RATIO * len(batch.buffer))
    rows = zip(packed.tolist(), messages.start.tolist(), messages.end.tolist(), strict=True)
    for is_packed, start, end in rows:
        data = batch.buffer[start:end].tobytes()
        parts.append(_decompress(data, left) if is_packed else data)
        left -= len(parts[-1] or b"")
    ends = np.cumsum([len(part or b"") for part in parts])
    starts = np.append(0, ends[:-1])
    buffer = np.frombuffer(b"".join(part or b"" for part in parts) or b"\0", np.uint8)
    fresh = replace(batch, buffer=buffer, messages=replace(messages, start=starts, end=ends))
    kept = np.array([part is not None for part in parts])
    if kept.all():
        return fresh
    lost = int((~kept).sum())
    loss = Loss(0, f"{lost} messages cannot be decompressed", 0, lost)
    return replace(fresh.only(kept), losses=(*batch.losses, loss))


def _decompress(data: bytes, most: int) -> bytes | None:
    """Return the content of a frame; None if it is damaged or larger than allowed."""
    try:
        if most <= 0 or zstandard.frame_content_size(data) > most:
            return None
        plain = zstandard.ZstdDecompressor().decompress(data, max_output_size=most)
    except (zstandard.ZstdError, MemoryError):
        return None
    return plain if len(plain) <= most else None
