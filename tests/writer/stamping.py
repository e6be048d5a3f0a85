"""Stamped-out records with any payloads."""

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.writer.template import Fill, Kind, Records, Slot, learn


def stamped(channel: int, log_time: Ints, payloads: NDArray[np.uint8]) -> Records:
    """Return the records, (n,), of payloads of one size, (n, size)."""

    def serialise(fill: Fill) -> bytes:
        return bytes(int(fill(Slot(str(row)), Kind.BOOL)) for row in range(payloads.shape[1]))

    columns = {str(row): column for row, column in enumerate(payloads.T)}
    return learn(serialise).records(channel, log_time, columns, np.arange(len(payloads)))
