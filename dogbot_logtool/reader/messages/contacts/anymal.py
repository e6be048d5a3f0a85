"""anymal_msgs/AnymalState: ANYmal's base, and the flag, force and position of each foot."""

from functools import partial
from typing import Final

from dogbot_logtool.reader.decode.fields import HEADER, number, table, text, vector
from dogbot_logtool.reader.messages.contacts.source import ContactSource
from dogbot_logtool.reader.messages.contacts.whole_robot import contact_names, named_contacts

_FLAGS: Final = {0: 0.0, 1: 1.0, 2: 1.0}
"""Contact by `Contact.state`: open, closed, slipping."""
_values: Final = partial(
    named_contacts, state="state", flags=_FLAGS, position="position", normal="normal"
)

SOURCE: Final = ContactSource(
    type_name="anymal_msgs/AnymalState",
    fields=(
        *HEADER,
        table(
            "contacts",
            text("name"),
            number("state"),
            *vector("wrench.force"),
            *vector("position"),
            *vector("normal"),
        ),
    ),
    values=_values,
    feet_in=contact_names,
    any_package=True,
    has_flags=True,
)
"""Simulators write forces along the world's axes; of real robots that is decided by evidence."""
