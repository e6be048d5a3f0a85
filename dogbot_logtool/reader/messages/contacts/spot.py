"""spot_msgs/FootStateArray: which feet of Spot touch, and where they are. No force, no header."""

from collections.abc import Sequence
from functools import partial
from typing import Final

import numpy as np

from dogbot_logtool.core.frames.wrench_frame import WrenchFrame
from dogbot_logtool.reader.decode.fields import number, table, vector
from dogbot_logtool.reader.messages.contacts.source import ContactSource, FootValues
from dogbot_logtool.reader.messages.contacts.whole_robot import QUADRUPED, matrix
from dogbot_logtool.reader.messages.messages import DecodedMessages
from dogbot_logtool.robot import Foot

_MADE, _LOST = 1, 2
"""Values of FootState.contact; any other means that Spot does not know."""
_POSITION: Final = "foot_position_rt_body"


def _values(messages: DecodedMessages, feet: Sequence[Foot], *, position: str) -> FootValues:
    del feet
    states, rows = messages.table.nested("states"), len(messages.channel)
    contact = states.table.numbers("contact")
    touches = np.select([contact == _MADE, contact == _LOST], [1.0, 0.0], np.nan)
    points = None
    if position:
        recorded = states.table.vectors(position, "xyz")
        # Some drivers fill in the contact only; no foot is in the middle of the body.
        recorded = np.where((recorded != 0.0).any(axis=1, keepdims=True), recorded, np.nan)
        points = matrix(states, recorded, rows)
    return FootValues(
        stamp=np.zeros(rows, np.int64), contact=matrix(states, touches, rows), position=points
    )


def _source(position: str) -> ContactSource:
    values = partial(_values, position=position)
    placed = vector(position) if position else ()
    return ContactSource(
        type_name="spot_msgs/FootStateArray",
        fields=(table("states", number("contact"), *placed),),
        values=values,
        elements=QUADRUPED,
        any_package=True,
        frame=WrenchFrame.UNKNOWN,
        has_header=False,
        has_force=False,
        has_points=bool(position),
        has_flags=True,
        in_base=bool(position),
    )


SOURCES: Final = (_source(_POSITION), _source(""))
