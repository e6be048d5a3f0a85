"""anymal_msgs/AnymalState: ANYmal's base, and the flag, force and position of each foot."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from dogbot_logtool.reader.decode.fields import number, table, text, time, vector
from dogbot_logtool.reader.messages.contacts.source import ContactSource
from dogbot_logtool.reader.messages.contacts.whole_robot import (
    FootValues,
    MessageFoot,
    labelled_elements,
    labels_in,
    reader_of,
    scattered,
)
from dogbot_logtool.reader.messages.messages import DecodedMessages
from dogbot_logtool.robot import Foot

_OPEN, _CLOSED, _SLIPPING = 0, 1, 2
"""Values of Contact.state; a slipping foot is in contact."""


def _values(messages: DecodedMessages, feet: Sequence[Foot]) -> FootValues:
    rows = len(messages.channel)
    contacts = messages.table.nested("contacts")
    parent, inside = contacts.parent, contacts.table
    element = labelled_elements(inside.texts("name"), feet)
    state = inside.numbers("state")
    flag = np.select([state == _OPEN, np.isin(state, (_CLOSED, _SLIPPING))], [0.0, 1.0], np.nan)
    return FootValues(
        stamp=messages.table.nanoseconds("header.stamp"),
        contact=scattered(parent, element, flag, rows),
        force=scattered(parent, element, inside.vectors("wrench.force", "xyz"), rows),
        position=scattered(parent, element, inside.vectors("position", "xyz"), rows),
        normal=scattered(parent, element, inside.vectors("normal", "xyz"), rows),
    )


def _feet_in(messages: DecodedMessages) -> tuple[MessageFoot, ...]:
    return labels_in(messages.table.nested("contacts").table.texts("name"))


SOURCE: Final = ContactSource(
    type_name="anymal_msgs/AnymalState",
    fields=(
        time("header.stamp"),
        text("header.frame_id"),
        table(
            "contacts",
            text("name"),
            number("state"),
            *vector("wrench.force"),
            *vector("position"),
            *vector("normal"),
        ),
    ),
    read=reader_of(_values),
    values=_values,
    feet_in=_feet_in,
    any_package=True,
    has_flags=True,
)
"""Simulators write forces along the world's axes; of real robots that is decided by evidence."""
