"""pronto_msgs/QuadrupedForceTorqueSensors: the forces on all feet of a quadruped."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from dogbot_logtool.core.frames.wrench_frame import WrenchFrame
from dogbot_logtool.reader.decode.fields import HEADER, vector
from dogbot_logtool.reader.messages.contacts.source import ContactSource, FootValues
from dogbot_logtool.reader.messages.messages import DecodedMessages
from dogbot_logtool.robot import Foot

_LEGS: Final = {
    "front_left": "lf",
    "front_right": "rf",
    "back_left": "lh",
    "back_right": "rh",
}


def _values(messages: DecodedMessages, feet: Sequence[Foot]) -> FootValues:
    del feet
    forces = [messages.table.vectors(f"{path}.force", "xyz") for path in _LEGS.values()]
    return FootValues(
        stamp=messages.table.nanoseconds("header.stamp"), force=np.stack(forces, axis=1)
    )


SOURCE: Final = ContactSource(
    type_name="pronto_msgs/QuadrupedForceTorqueSensors",
    fields=(
        *HEADER,
        *(field for path in _LEGS.values() for field in vector(f"{path}.force")),
    ),
    values=_values,
    elements=tuple(_LEGS),
    any_package=True,
    frame=WrenchFrame.UNKNOWN,
    has_points=False,
)
"""Nothing says in which frame the forces are."""
