"""syropod_highlevel_controller/TipState: forces at the tips of a walker's legs, by name."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from dogbot_logtool.core.frames.wrench_frame import WrenchFrame
from dogbot_logtool.reader.decode.fields import HEADER, table, texts, vector
from dogbot_logtool.reader.decode.message_layout import ELEMENT
from dogbot_logtool.reader.messages.contacts.source import ContactSource, FootValues, MessageFoot
from dogbot_logtool.reader.messages.contacts.whole_robot import (
    labelled_elements,
    labels_in,
    matrix,
    scattered,
)
from dogbot_logtool.reader.messages.messages import DecodedMessages
from dogbot_logtool.robot import Foot


def _values(messages: DecodedMessages, feet: Sequence[Foot]) -> FootValues:
    """Return the force beside each name; a name without one has none."""
    rows, names = len(messages.channel), messages.table.nested("name")
    wrenches = messages.table.nested("wrench")
    element = labelled_elements(names.table.texts(ELEMENT), feet).astype(np.float64)
    named = matrix(names, element, rows)
    force = matrix(wrenches, wrenches.table.vectors("force", "xyz"), rows)
    both = min(named.shape[1], force.shape[1])
    row, column = np.nonzero(named[:, :both] >= 0)
    return FootValues(
        stamp=messages.table.nanoseconds("header.stamp"),
        force=scattered(row, named[row, column].astype(np.int64), force[row, column], rows),
    )


def _feet_in(messages: DecodedMessages) -> tuple[MessageFoot, ...]:
    return labels_in(messages.table.nested("name").table.texts(ELEMENT))


SOURCE: Final = ContactSource(
    type_name="syropod_highlevel_controller/TipState",
    fields=(
        *HEADER,
        texts("name"),
        table("wrench", *vector("force")),
    ),
    values=_values,
    feet_in=_feet_in,
    any_package=True,
    frame=WrenchFrame.UNKNOWN,
    has_points=False,
)
"""Its definition does not name the frame of the forces."""
