"""Messages of arrows, and of their removal, made of columns."""

from collections.abc import Iterator, Mapping
from functools import partial

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.core.scene.arrows import Arrows
from dogbot_logtool.writer.encodings.encoding import SHAFT_SHARE, ArrowLook, Encoding
from dogbot_logtool.writer.message_records import kept_template, write_pose
from dogbot_logtool.writer.messages.shown import ShownTemplates, shown_records
from dogbot_logtool.writer.template import Stamps


class ArrowWriter:
    """Makes the messages of arrows, on one channel a foot."""

    def __init__(
        self, channels: Mapping[str, int], encoding: Encoding, frame: str, look: ArrowLook
    ) -> None:
        self._templates = [
            ShownTemplates(
                kept_template(encoding.arrow, channel, foot, frame, look),
                kept_template(encoding.removal, channel, foot, frame),
            )
            for foot, channel in channels.items()
        ]

    def records(self, arrows: Arrows, stamps: Stamps) -> Iterator[NDArray[np.void]]:
        """Yield the message records of arrows, (n,) of any feet, foot by foot."""
        return shown_records(self._templates, arrows, stamps, partial(_fill, arrows))


def _fill(arrows: Arrows, records: NDArray[np.void], rows: Ints) -> None:
    write_pose(records, arrows.position.take(rows, 0), arrows.orientation.take(rows, 0))
    length = arrows.length[rows]
    if "length" in (records.dtype.names or ()):
        records["length"] = length
    else:
        records["shaft"] = SHAFT_SHARE * length
        records["head"] = (1.0 - SHAFT_SHARE) * length
    for part, column in zip("rgba", arrows.colour.take(rows, 0).T, strict=True):
        records[part] = column
