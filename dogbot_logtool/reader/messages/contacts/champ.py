"""champ_msgs/ContactsStamped: which feet of a CHAMP robot touch. No force."""

from typing import Final

import numpy as np

from dogbot_logtool.core.frames.wrench_frame import WrenchFrame
from dogbot_logtool.reader.decode.fields import numbers, text, time
from dogbot_logtool.reader.decode.message_layout import ELEMENT
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


def to_contact_samples(messages: DecodedMessages, feet: FootChannels) -> ContactSamples:
    """Reduce messages to samples; see `ContactSource.read`."""
    flags = messages.table.nested("contacts")
    touches = flags.table.numbers(ELEMENT).astype(np.float64)
    values = by_element(flags, touches, len(messages.channel), len(_LEGS))
    stamp = messages.table.nanoseconds("header.stamp")
    return each_foot(messages, feet, stamp, values, only_contact)


SOURCE: Final = ContactSource(
    type_name="champ_msgs/ContactsStamped",
    fields=(time("header.stamp"), text("header.frame_id"), numbers("contacts")),
    read=to_contact_samples,
    elements=_LEGS,
    any_package=True,
    frame=WrenchFrame.UNKNOWN,
    has_force=False,
    has_points=False,
)
