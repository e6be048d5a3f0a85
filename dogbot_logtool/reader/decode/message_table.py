"""Messages as columns, with the offsets of their payloads in a buffer."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.geometry.arrays import Flags, Ints
from dogbot_logtool.dataclass import dataclass


@dataclass(frozen=True, slots=True)
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

    def pick(self, rows: Flags | Ints | slice) -> "Messages":
        """Return the chosen rows."""
        return Messages(
            self.channel[rows],
            self.log_time[rows],
            self.publish_time[rows],
            self.sequence[rows],
            self.start[rows],
            self.end[rows],
        )

    def shifted(self, offset: int) -> "Messages":
        """Return the same messages for a buffer in which their bytes lie `offset` further on."""
        return Messages(
            self.channel,
            self.log_time,
            self.publish_time,
            self.sequence,
            self.start + offset,
            self.end + offset,
        )


def no_messages() -> Messages:
    """Return an empty table."""
    nothing = np.empty(0, np.int64)
    return Messages(nothing, nothing, nothing, nothing, nothing, nothing)


def concatenate_messages(parts: Sequence[Messages]) -> Messages:
    """Stack message tables."""
    if len(parts) == 1:
        return parts[0]
    if not parts:
        return no_messages()
    return Messages(
        np.concatenate([part.channel for part in parts]),
        np.concatenate([part.log_time for part in parts]),
        np.concatenate([part.publish_time for part in parts]),
        np.concatenate([part.sequence for part in parts]),
        np.concatenate([part.start for part in parts]),
        np.concatenate([part.end for part in parts]),
    )
