"""Messages of the labels beside feet, made of columns."""

from collections.abc import Iterator, Mapping
from functools import partial
from typing import Final

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.core.scene.foot_style import short_names
from dogbot_logtool.core.scene.labels import Labels
from dogbot_logtool.core.scene.styles import LIFETIME_S
from dogbot_logtool.writer.encodings.encoding import LABEL_WIDTH, Encoding
from dogbot_logtool.writer.message_records import kept_template
from dogbot_logtool.writer.messages.shown import ShownTemplates, shown_records
from dogbot_logtool.writer.template import Stamps

_LARGEST_N: Final = 9999.0
_BEYOND: Final = ">10 kN"


class LabelWriter:
    """Makes the messages of labels, on one channel a foot."""

    def __init__(self, channels: Mapping[str, int], encoding: Encoding, frame: str) -> None:
        names = short_names(tuple(channels))
        self._templates = [
            ShownTemplates(
                kept_template(encoding.label, channel, foot, frame, name, LIFETIME_S),
                kept_template(encoding.removal, channel, foot, frame),
            )
            for (foot, channel), name in zip(channels.items(), names, strict=True)
        ]

    def records(self, labels: Labels, stamps: Stamps) -> Iterator[NDArray[np.void]]:
        """Yield the message records of labels, (n,) of any feet, foot by foot."""
        return shown_records(self._templates, labels, stamps, partial(_fill, labels))


def _fill(labels: Labels, records: NDArray[np.void], rows: Ints) -> None:
    for axis, column in zip("xyz", labels.position.take(rows, 0).T, strict=True):
        records[axis] = column
    records["text"] = [
        (_BEYOND if force > _LARGEST_N else f"{force:.0f} N").center(LABEL_WIDTH).encode()
        for force in labels.force[rows].tolist()
    ]
