"""ros_gz_interfaces/Contacts: the contact sensors of the new Gazebo (gz sim).

Published only while something touches. Each message is one physics step, one `Contact` a pair.
Positions, normals and wrenches are in the world frame; `body_1_wrench` acts on body 1.
"""

from dataclasses import replace
from typing import Final

import numpy as np

from dogbot_logtool.core.contact.contacts import NOT_THIS_FOOT, Contacts, contact_samples
from dogbot_logtool.core.frames.wrench_frame import WrenchFrame
from dogbot_logtool.core.geometry.arrays import sum_by_group
from dogbot_logtool.reader.decode.fields import HEADER, table, text, vector
from dogbot_logtool.reader.messages.contacts.collisions import foot_sides
from dogbot_logtool.reader.messages.contacts.source import (
    ContactSamples,
    ContactSource,
    FootChannels,
    vectors_inside,
)
from dogbot_logtool.reader.messages.messages import DecodedMessages

_FIELDS: Final = (
    *HEADER,
    table(
        "contacts",
        text("collision1.name"),
        text("collision2.name"),
        table("positions", *vector("")),
        table("normals", *vector("")),
        table("wrenches", *vector("body_1_wrench.force")),
    ),
)


def to_contact_samples(messages: DecodedMessages, feet: FootChannels) -> ContactSamples:
    """Reduce messages to samples; see `ContactSource.read`."""
    pairs = messages.table.nested("contacts")
    point_state, point = vectors_inside(pairs.table, "positions")
    wrenches = pairs.table.nested("wrenches")
    normal_state, normal = vectors_inside(pairs.table, "normals")
    foot = feet.single(messages.channel)
    names = pairs.table.texts("collision1.name"), pairs.table.texts("collision2.name")
    side = foot_sides(*names, foot[pairs.parent], feet.feet)
    force = wrenches.table.vectors("body_1_wrench.force", "xyz")
    contacts = Contacts(
        foot=foot,
        log_time=messages.log_time,
        stamp=messages.table.nanoseconds("header.stamp"),
        state_message=pairs.parent,
        foot_side=side,
        newest=np.ones(len(pairs.parent), np.bool_),
        total_force=sum_by_group(force, wrenches.parent, len(pairs.parent)),
        point_state=point_state,
        point=point,
        wrench_state=wrenches.parent,
        wrench_force=force,
        normal_state=normal_state,
        normal=normal,
    )
    samples = contact_samples(contacts)
    samples = replace(samples, in_world=samples.in_contact)
    return ContactSamples(samples, contacts, foreign_states=int((side == NOT_THIS_FOOT).sum()))


SOURCE: Final = ContactSource(
    type_name="ros_gz_interfaces/Contacts",
    fields=_FIELDS,
    read=to_contact_samples,
    frame=WrenchFrame.WORLD,
    silent_in_swing=True,
)
