"""Decompressed messages of some neighbouring chunks."""

from collections.abc import Set as AbstractSet
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from dogbot_logtool.core.arrays import Bytes, Flags
from dogbot_logtool.reader.containers.contents import Chunk
from dogbot_logtool.reader.containers.loss import Loss
from dogbot_logtool.reader.decode.message_table import Messages


@dataclass(frozen=True, slots=True)
class LoadedChunk:
    """A chunk in a batch."""

    chunk: Chunk
    stored: memoryview
    """Its bytes as they stand in the file, where the log copies chunks; else none."""
    base: int
    """Offset of its decompressed bytes in the batch's buffer."""
    rows: slice
    """Its rows in the batch's messages."""
    whole: bool
    """Nothing in it was damaged, so that its bytes may be copied as they stand, and those of its
    index if it is `indexed`."""
    indexed: bool = False
    """An index that truthfully names all its messages follows it in the file."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Batch:
    """A run of decompressed messages."""

    buffer: Bytes
    """(b,) uint8."""
    messages: Messages
    chunks: tuple[LoadedChunk, ...]
    losses: tuple[Loss, ...] = ()
    decoded: dict[object, Any] = field(init=False, repr=False, compare=False)
    """Columns that `decode_channels` made of it, which may be asked for again."""

    def __post_init__(self) -> None:
        """Begin with nothing decoded, also where a batch is made of another one."""
        object.__setattr__(self, "decoded", {})

    def cropped(self, start: int | None, end: int | None) -> "Batch":
        """Leave out messages recorded before the start or after the end, ns; None: no limit."""
        if start is None and end is None:
            return self
        time = self.messages.log_time
        kept = np.ones(len(time), np.bool_)
        if start is not None:
            kept &= time >= start
        if end is not None:
            kept &= time <= end
        return self.only(kept)

    def without(self, channels: AbstractSet[int]) -> "Batch":
        """Leave out the messages of some channels."""
        return self.only(~np.isin(self.messages.channel, list(channels)))

    def only(self, kept: Flags) -> "Batch":
        """Return some of the messages; chunks that lose any are not whole."""
        bounds = np.concatenate([[0], np.cumsum(kept)])
        chunks = tuple(
            replace(
                loaded,
                rows=slice(int(bounds[loaded.rows.start]), int(bounds[loaded.rows.stop])),
                whole=loaded.whole and bool(kept[loaded.rows].all()),
            )
            for loaded in self.chunks
        )
        return replace(self, messages=self.messages.pick(kept), chunks=chunks)
