"""anymal_msgs/AnymalState: ANYmal's base, and the flag, force and position of each foot."""

from functools import partial
from typing import Final

from dogbot_logtool.reader.decode.fields import number, table, text, time, vector
from dogbot_logtool.reader.messages.contacts.source import ContactSource
from dogbot_logtool.reader.messages.contacts.whole_robot import (
    MessageFoot,
    labels_in,
    named_contacts,
    reader_of,
)
from dogbot_logtool.reader.messages.messages import DecodedMessages

_FLAGS: Final = {0: 0.0, 1: 1.0, 2: 1.0}
"""Contact by `Contact.state`: open, closed, slipping."""
_values: Final = partial(
    named_contacts, state="state", flags=_FLAGS, position="position", normal="normal"
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
