"""spot_msgs/FootStateArray: which feet of Spot touch. No force, no header."""

from typing import Final

import numpy as np

from dogbot_logtool.core.frames.wrench_frame import WrenchFrame
from dogbot_logtool.reader.decode.fields import number, table
from dogbot_logtool.reader.messages.contacts.source import (
    ContactSamples,
    ContactSource,
    FootChannels,
    by_element,
    each_foot,
    only_contact,
)
from dogbot_logtool.reader.messages.messages import DecodedMessages

_LEGS: Final = ("front_left", "front_right", "back_left", "back_right")
_MADE, _LOST = 1, 2
"""Values of FootState.contact; any other means that Spot does not know."""


def to_contact_samples(messages: DecodedMessages, feet: FootChannels) -> ContactSamples:
    """Reduce messages to samples; see `ContactSource.read`."""
    states = messages.table.nested("states")
    contact = states.table.numbers("contact")
    touches = np.select([contact == _MADE, contact == _LOST], [1.0, 0.0], np.nan)
    count = len(messages.channel)
    values = by_element(states, touches, count, len(_LEGS))
    return each_foot(messages, feet, np.zeros(count, np.int64), values, only_contact)


SOURCE: Final = ContactSource(
    type_name="spot_msgs/FootStateArray",
    fields=(table("states", number("contact")),),
    read=to_contact_samples,
    elements=_LEGS,
    frame=WrenchFrame.UNKNOWN,
    has_header=False,
    has_force=False,
    has_points=False,
)
