"""Messages as columns, with the offsets of their payloads in a buffer."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.arrays import Flags, Ints, concatenated, picked


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Messages:
    """Messages in the order in which they stand in the file."""

    channel: NDArray[np.int64]
    """(n,) channel ids."""
    log_time: Ints
    """(n,) ns."""
    publish_time: Ints
    """(n,) ns."""
    sequence: Ints
    """(n,)."""
    start: Ints
    """(n,) where each payload begins in the batch's buffer."""
    end: Ints
    """(n,) where it ends."""

    def __len__(self) -> int:
        return len(self.channel)

    def pick(self, rows: Flags | Ints | slice) -> Self:
        """Return the chosen rows."""
        return picked(self, rows)

    def shifted(self, offset: int) -> "Messages":
        """Return the same messages for a buffer in which their bytes lie `offset` further on."""
        return replace(self, start=self.start + offset, end=self.end + offset)


def no_messages() -> Messages:
    """Return an empty table."""
    nothing = np.empty(0, np.int64)
    return Messages(nothing, nothing, nothing, nothing, nothing, nothing)


def concatenate_messages(parts: Sequence[Messages]) -> Messages:
    """Stack message tables."""
    return concatenated(parts) if parts else no_messages()
