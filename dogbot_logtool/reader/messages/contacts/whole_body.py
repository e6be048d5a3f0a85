"""whole_body_state_msgs/WholeBodyState: contacts of any robot by name, in the world."""

from functools import partial
from typing import Final

import numpy as np

from dogbot_logtool.core.frames.wrench_frame import WrenchFrame
from dogbot_logtool.reader.decode.fields import HEADER, number, table, text, vector
from dogbot_logtool.reader.messages.contacts.source import ContactSource, MessageFoot
from dogbot_logtool.reader.messages.contacts.whole_robot import labels_in, named_contacts
from dogbot_logtool.reader.messages.messages import DecodedMessages

_LOCOMOTION: Final = 0
_STATUS: Final = {1: 0.0, 2: 1.0, 3: 1.0}
"""Contact by `status`: inactive, active, slipping. Unknown, 0, is the default."""
_FORMER: Final = {0: 1.0, 1: 0.0, 2: 1.0}
"""The same by `contact_state` of earlier versions: closed, open, slipping. Unknown is -1."""


def _feet_in(messages: DecodedMessages) -> tuple[MessageFoot, ...]:
    """Return the contacts for walking; hands that grasp are of another type."""
    inside = messages.table.nested("contacts").table
    rows = np.flatnonzero(inside.numbers("type") == _LOCOMOTION)
    return labels_in(inside.texts("name").pick(rows))


def _source(field: str, flags: dict[int, float]) -> ContactSource:
    values = partial(
        named_contacts, state=field, flags=flags, position="pose.position", normal="surface_normal"
    )
    return ContactSource(
        type_name="whole_body_state_msgs/WholeBodyState",
        fields=(
            *HEADER,
            table(
                "contacts",
                text("name"),
                number("type"),
                number(field),
                *vector("pose.position"),
                *vector("wrench.force"),
                *vector("surface_normal"),
            ),
        ),
        values=values,
        feet_in=_feet_in,
        any_package=True,
        plans="by_name",
        frame=WrenchFrame.WORLD,
        has_flags=True,
    )


SOURCES: Final = (_source("status", _STATUS), _source("contact_state", _FORMER))
