"""Messages of feet's loads, made of columns."""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.arrays import rows_by_group
from dogbot_logtool.core.scene.loads import Loads
from dogbot_logtool.writer.encodings.encoding import LOAD_STATES, Encoding
from dogbot_logtool.writer.message_records import kept_template, timed_records
from dogbot_logtool.writer.template import Stamps


class LoadWriter:
    """Makes the messages of loads, on one channel a foot."""

    def __init__(self, channels: Sequence[int], encoding: Encoding) -> None:
        self._templates = [
            kept_template(encoding.load, channel, state)
            for channel in channels
            for state in LOAD_STATES
        ]

    def records(self, loads: Loads, stamps: Stamps) -> Iterator[NDArray[np.void]]:
        """Yield the message records of loads, those of one foot and state at a time.

        Args:
            loads: (n,) of any feet.
            stamps: their stamps in the encoding's form.
        """
        for group, rows in rows_by_group(len(LOAD_STATES) * loads.foot + loads.state):
            records = timed_records(self._templates[group], loads.log_time, stamps, rows)
            records["in_contact"] = loads.in_contact[rows]
            records["force"] = loads.force[rows]
            records["force_bw"] = loads.body_weights[rows]
            yield records
