"""Stamped-out records with any payloads."""

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.writer.message_records import record_template, write_log_time
from dogbot_logtool.writer.template import Template


def stamped(channel: int, log_time: Ints, payloads: NDArray[np.void]) -> NDArray[np.void]:
    """Return the records, (n,), of payloads of one size, (n,)."""
    size = payloads.dtype.itemsize
    message = Template(bytes(size), np.dtype([("payload", f"V{size}")]), {})
    records = record_template(message, channel).copies(len(log_time))
    write_log_time(records, log_time)
    records["payload"] = payloads
    return records
