"""dwl_msgs/WholeBodyState: positions and forces of contacts by name, in the base's frame."""

from collections.abc import Sequence
from functools import partial
from typing import Final

from dogbot_logtool.core.frames.wrench_frame import WrenchFrame
from dogbot_logtool.reader.decode.fields import HEADER, table, text, vector
from dogbot_logtool.reader.messages.contacts.source import ContactSource, FootValues
from dogbot_logtool.reader.messages.contacts.whole_robot import (
    contact_names,
    labelled_elements,
    scattered,
)
from dogbot_logtool.reader.messages.messages import DecodedMessages
from dogbot_logtool.robot import Foot


def _values(messages: DecodedMessages, feet: Sequence[Foot], *, position: str) -> FootValues:
    rows, contacts = len(messages.channel), messages.table.nested("contacts")
    element = labelled_elements(contacts.table.texts("name"), feet)
    force = contacts.table.vectors("wrench.force", "xyz")
    points = contacts.table.vectors(position, "xyz")
    return FootValues(
        stamp=messages.table.nanoseconds("header.stamp"),
        force=scattered(contacts.parent, element, force, rows),
        position=scattered(contacts.parent, element, points, rows),
    )


def _source(position: str) -> ContactSource:
    values = partial(_values, position=position)
    return ContactSource(
        type_name="dwl_msgs/WholeBodyState",
        fields=(
            *HEADER,
            table("contacts", text("name"), *vector(position), *vector("wrench.force")),
        ),
        values=values,
        feet_in=contact_names,
        any_package=True,
        plans="by_name",
        frame=WrenchFrame.UNKNOWN,
        in_base=True,
    )


SOURCES: Final = (_source("pose.position"), _source("position"))
"""Today's definition, and the one before it. Forces are zero without contact."""
