"""Messages of arrows, and of their removal, made of columns."""

from collections.abc import Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.geometry.arrays import Ints, rows_by_group
from dogbot_logtool.core.scene.arrows import Arrows
from dogbot_logtool.writer.encodings.encoding import SHAFT_SHARE, ArrowLook, Encoding
from dogbot_logtool.writer.message_records import record_template, timed_records, write_pose
from dogbot_logtool.writer.template import Stamps, Template


class ArrowWriter:
    """Makes the messages of arrows, on one channel a foot."""

    def __init__(
        self, channels: Mapping[str, int], encoding: Encoding, frame: str, look: ArrowLook
    ) -> None:
        self._templates = [
            (
                record_template(encoding.arrow(foot, frame, look), channel),
                record_template(encoding.removal(foot, frame), channel),
            )
            for foot, channel in channels.items()
        ]

    def records(self, arrows: Arrows, stamps: Stamps) -> Iterator[NDArray[np.void]]:
        """Yield the message records of arrows, foot by foot.

        Args:
            arrows: (n,) of any feet.
            stamps: their stamps in the encoding's form.
        """
        for group, rows in rows_by_group(2 * arrows.foot + ~arrows.shown):
            arrow, removal = self._templates[group // 2]
            if group % 2:
                yield timed_records(removal, arrows.log_time, stamps, rows)
            else:
                yield _arrow_records(arrow, arrows, stamps, rows)


def _arrow_records(
    template: Template, arrows: Arrows, stamps: Stamps, rows: Ints
) -> NDArray[np.void]:
    records = timed_records(template, arrows.log_time, stamps, rows)
    write_pose(records, arrows.position.take(rows, 0), arrows.orientation.take(rows, 0))
    length = arrows.length[rows]
    if "length" in template.kinds:
        records["length"] = length
    else:
        records["shaft"] = SHAFT_SHARE * length
        records["head"] = (1.0 - SHAFT_SHARE) * length
    for part, column in zip("rgba", arrows.colour.take(rows, 0).T, strict=True):
        records[part] = column
    return records
