"""From the numbers that a file's records give to channels, to the ids of the log's channels."""

from collections.abc import Mapping
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Ints

UNKNOWN_CHANNEL: Final = -1
"""Channel of messages whose channel is nowhere described."""


class ChannelIds:
    """Channel ids by number."""

    def __init__(self, ids: Mapping[int, int]) -> None:
        numbers = sorted(ids)
        self._numbers = np.array([*numbers, UNKNOWN_CHANNEL], np.int64)
        self._ids = np.array([*map(ids.__getitem__, numbers), UNKNOWN_CHANNEL], np.int64)

    def of(self, numbers: Ints) -> Ints:
        """Return the ids.

        Args:
            numbers: (n,).

        Returns:
            (n,), `UNKNOWN_CHANNEL` where nothing describes the channel.
        """
        index = np.searchsorted(self._numbers[:-1], numbers)
        ids: Ints = self._ids[index]
        ids[self._numbers[index] != numbers] = UNKNOWN_CHANNEL
        return ids
