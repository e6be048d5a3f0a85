"""quad_msgs/GRFArray: forces, contact points and flags of Quad-SDK's robots, in the world."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from dogbot_logtool.core.frames.wrench_frame import WrenchFrame
from dogbot_logtool.reader.decode.fields import HEADER, numbers, table, vector
from dogbot_logtool.reader.decode.message_layout import ELEMENT
from dogbot_logtool.reader.messages.contacts.source import ContactSource, FootValues
from dogbot_logtool.reader.messages.contacts.whole_robot import matrix
from dogbot_logtool.reader.messages.messages import DecodedMessages
from dogbot_logtool.robot import Foot

_LEGS: Final = ("front_left", "back_left", "front_right", "back_right")


def _values(messages: DecodedMessages, feet: Sequence[Foot]) -> FootValues:
    del feet
    rows, columns = len(messages.channel), messages.table
    forces, points, flags = (
        columns.nested(path) for path in ("vectors", "points", "contact_states")
    )
    return FootValues(
        stamp=columns.nanoseconds("header.stamp"),
        contact=matrix(flags, flags.table.numbers(ELEMENT).astype(np.float64), rows),
        force=matrix(forces, forces.table.vectors("", "xyz"), rows),
        position=matrix(points, points.table.vectors("", "xyz"), rows),
    )


SOURCE: Final = ContactSource(
    type_name="quad_msgs/GRFArray",
    fields=(
        *HEADER,
        table("vectors", *vector("")),
        table("points", *vector("")),
        numbers("contact_states"),
    ),
    values=_values,
    elements=_LEGS,
    any_package=True,
    plans="by_name",
    frame=WrenchFrame.WORLD,
    has_flags=True,
)
"""``state/grfs`` is measured (in simulation), ``control/grfs`` is commanded."""
