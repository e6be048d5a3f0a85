"""Messages of the labels beside feet, made of columns."""

from collections.abc import Iterator, Mapping
from typing import Final

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.geometry.arrays import Ints, rows_by_group
from dogbot_logtool.core.scene.foot_style import short_names
from dogbot_logtool.core.scene.labels import Labels
from dogbot_logtool.core.scene.styles import LIFETIME_S
from dogbot_logtool.writer.encodings.encoding import LABEL_WIDTH, Encoding
from dogbot_logtool.writer.message_records import record_template, timed_records
from dogbot_logtool.writer.template import Stamps, Template

_LARGEST_N: Final = 9999.0
_BEYOND: Final = ">10 kN"


class LabelWriter:
    """Makes the messages of labels, on one channel a foot."""

    def __init__(self, channels: Mapping[str, int], encoding: Encoding, frame: str) -> None:
        names = short_names(tuple(channels))
        self._templates = [
            (
                record_template(encoding.label(foot, frame, name, LIFETIME_S), channel),
                record_template(encoding.removal(foot, frame), channel),
            )
            for (foot, channel), name in zip(channels.items(), names, strict=True)
        ]

    def records(self, labels: Labels, stamps: Stamps) -> Iterator[NDArray[np.void]]:
        """Yield the message records of labels, foot by foot.

        Args:
            labels: (n,) of any feet.
            stamps: their stamps in the encoding's form.
        """
        for group, rows in rows_by_group(2 * labels.foot + ~labels.shown):
            label, removal = self._templates[group // 2]
            if group % 2:
                yield timed_records(removal, labels.log_time, stamps, rows)
            else:
                yield _label_records(label, labels, stamps, rows)


def _label_records(
    template: Template, labels: Labels, stamps: Stamps, rows: Ints
) -> NDArray[np.void]:
    records = timed_records(template, labels.log_time, stamps, rows)
    for axis, column in zip("xyz", labels.position.take(rows, 0).T, strict=True):
        records[axis] = column
    records["text"] = [
        (_BEYOND if force > _LARGEST_N else f"{force:.0f} N").center(LABEL_WIDTH).encode()
        for force in labels.force[rows].tolist()
    ]
    return records
