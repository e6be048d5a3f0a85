"""hrpsys_ros_bridge/ContactStatesStamped: which feet and hands of a humanoid touch, by sensor."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from dogbot_logtool.core.frames.wrench_frame import WrenchFrame
from dogbot_logtool.reader.decode.fields import HEADER, number, table, text
from dogbot_logtool.reader.messages.contacts.source import ContactSource, FootValues, MessageFoot
from dogbot_logtool.reader.messages.contacts.whole_robot import (
    labelled_elements,
    labels_in,
    scattered,
)
from dogbot_logtool.reader.messages.messages import DecodedMessages
from dogbot_logtool.robot import Foot

_FEET: Final = {"lfsensor": "left", "rfsensor": "right"}
_HANDS: Final = ("lhsensor", "rhsensor", "hand", "arm", "wrist")
"""Words in names of sensors that are no feet."""


def _values(messages: DecodedMessages, feet: Sequence[Foot]) -> FootValues:
    states = messages.table.nested("states")
    element = labelled_elements(states.table.texts("header.frame_id"), feet)
    flag = (states.table.numbers("state.state") != 0).astype(np.float64)
    return FootValues(
        stamp=messages.table.nanoseconds("header.stamp"),
        contact=scattered(states.parent, element, flag, len(messages.channel)),
    )


def _feet_in(messages: DecodedMessages) -> tuple[MessageFoot, ...]:
    found = labels_in(messages.table.nested("states").table.texts("header.frame_id"))
    return tuple(
        MessageFoot(foot.label, _FEET.get(foot.label.lower(), ""))
        for foot in found
        if not any(hand in foot.label.lower() for hand in _HANDS)
    )


SOURCE: Final = ContactSource(
    type_name="hrpsys_ros_bridge/ContactStatesStamped",
    fields=(
        *HEADER,
        table("states", text("header.frame_id"), number("state.state")),
    ),
    values=_values,
    feet_in=_feet_in,
    any_package=True,
    plans="by_name",
    frame=WrenchFrame.UNKNOWN,
    has_force=False,
    has_points=False,
    has_flags=True,
)
"""``act_contact_states`` are measured, ``ref_contact_states`` planned."""
