"""champ_msgs/ContactsStamped: which feet of a CHAMP robot touch. No force."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from dogbot_logtool.core.frames.wrench_frame import WrenchFrame
from dogbot_logtool.reader.decode.fields import HEADER, numbers
from dogbot_logtool.reader.decode.message_layout import ELEMENT
from dogbot_logtool.reader.messages.contacts.source import ContactSource, FootValues
from dogbot_logtool.reader.messages.contacts.whole_robot import QUADRUPED, matrix
from dogbot_logtool.reader.messages.messages import DecodedMessages
from dogbot_logtool.robot import Foot


def _values(messages: DecodedMessages, feet: Sequence[Foot]) -> FootValues:
    del feet
    flags, rows = messages.table.nested("contacts"), len(messages.channel)
    return FootValues(
        stamp=messages.table.nanoseconds("header.stamp"),
        contact=matrix(flags, flags.table.numbers(ELEMENT).astype(np.float64), rows),
    )


SOURCE: Final = ContactSource(
    type_name="champ_msgs/ContactsStamped",
    fields=(*HEADER, numbers("contacts")),
    values=_values,
    elements=QUADRUPED,
    any_package=True,
    frame=WrenchFrame.UNKNOWN,
    has_force=False,
    has_points=False,
)
