"""Messages of arrows and labels, shown or removed, foot by foot."""

from collections.abc import Callable, Iterator, Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.arrays import Flags, Ints, rows_by_group
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.writer.message_records import timed_records
from dogbot_logtool.writer.template import Stamps, Template


class Shown(Protocol):
    """Columns of what is shown or removed."""

    @property
    def foot(self) -> Ints:
        """(n,) index of the foot."""

    @property
    def log_time(self) -> Ints:
        """(n,) ns."""

    @property
    def shown(self) -> Flags:
        """(n,) False: it is removed."""


@dataclass(frozen=True, slots=True)
class ShownTemplates:
    """Message records of one foot."""

    shown: Template
    removed: Template


def shown_records(
    templates: Sequence[ShownTemplates],
    columns: Shown,
    stamps: Stamps,
    fill: Callable[[NDArray[np.void], Ints], None],
) -> Iterator[NDArray[np.void]]:
    """Yield message records, foot by foot.

    Args:
        templates: of each foot.
        columns: (n,) of any feet.
        stamps: their stamps in the encoding's form.
        fill: writes some rows into copies of a template; a removal has nothing but times.
    """
    for group, rows in rows_by_group(2 * columns.foot + ~columns.shown):
        of_foot = templates[group // 2]
        if group % 2:
            yield timed_records(of_foot.removed, columns.log_time, stamps, rows)
        else:
            records = timed_records(of_foot.shown, columns.log_time, stamps, rows)
            fill(records, rows)
            yield records
