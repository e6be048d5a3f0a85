"""gazebo_msgs/ContactsState: the bumpers of Gazebo classic."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.contact.contacts import (
    FOOT_IS_COLLISION1,
    NOT_THIS_FOOT,
    Contacts,
    contact_samples,
)
from dogbot_logtool.core.geometry.arrays import Ints
from dogbot_logtool.core.geometry.order_statistics import distinct
from dogbot_logtool.reader.decode.fields import HEADER, table, text, vector
from dogbot_logtool.reader.messages.contacts.collisions import foot_sides, link_of_collision
from dogbot_logtool.reader.messages.contacts.physics_steps import (
    newest_lag,
    newest_step,
    steps_of_messages,
)
from dogbot_logtool.reader.messages.contacts.source import (
    ContactSamples,
    ContactSource,
    FootChannels,
    FootLinks,
    StepTiming,
    vectors_inside,
)
from dogbot_logtool.reader.messages.messages import DecodedMessages

_FIELDS: Final = (
    *HEADER,
    table(
        "states",
        text("info"),
        text("collision1_name"),
        text("collision2_name"),
        table("wrenches", *vector("force")),
        *vector("total_wrench.force"),
        table("contact_positions", *vector("")),
        table("contact_normals", *vector("")),
    ),
)


def to_contact_samples(messages: DecodedMessages, feet: FootChannels) -> ContactSamples:
    """Reduce messages to samples; see `ContactSource.read`."""
    states = messages.table.nested("states")
    point_state, point = vectors_inside(states.table, "contact_positions")
    wrenches = states.table.nested("wrenches")
    normal_state, normal = vectors_inside(states.table, "contact_normals")
    foot = feet.single(messages.channel)
    stamp = messages.table.nanoseconds("header.stamp")
    info = states.table.texts("info")
    newest, untimed = newest_step(info, states.parent, messages.table.rows)
    if feet.left_after_ns is not None:
        left = newest_lag(info, states.parent, stamp) > feet.left_after_ns
        newest &= ~left[states.parent]
    side = _sides(messages, feet, foot)
    contacts = Contacts(
        foot=foot,
        log_time=messages.log_time,
        stamp=stamp,
        state_message=states.parent,
        foot_side=side,
        newest=newest,
        total_force=states.table.vectors("total_wrench.force", "xyz"),
        point_state=point_state,
        point=point,
        wrench_state=wrenches.parent,
        wrench_force=wrenches.table.vectors("force", "xyz"),
        normal_state=normal_state,
        normal=normal,
    )
    foreign = int((side == NOT_THIS_FOOT).sum())
    return ContactSamples(contact_samples(contacts), contacts, untimed, foreign)


def foot_links(messages: DecodedMessages, feet: FootChannels) -> FootLinks:
    """Return the links that the feet's own collisions belong to, by foot.

    Only pairs with the foot named first count: their wrenches are in that link's frame.
    """
    states = messages.table.nested("states")
    foot = feet.single(messages.channel)
    side = _sides(messages, feet, foot)
    code, names = states.table.texts("collision1_name").encode()
    pairs = foot[states.parent] * len(names) + code
    links: dict[int, set[str]] = {}
    for pair in distinct(pairs[side == FOOT_IS_COLLISION1]).tolist():
        link = link_of_collision(names[pair % len(names)])
        if link is not None:
            links.setdefault(pair // len(names), set()).add(link)
    return links


def _sides(messages: DecodedMessages, feet: FootChannels, foot: Ints) -> NDArray[np.int8]:
    """(s,) which body of each state's pair is the foot."""
    states = messages.table.nested("states")
    names = states.table.texts("collision1_name"), states.table.texts("collision2_name")
    return foot_sides(*names, foot[states.parent], feet.feet)


def step_timing(messages: DecodedMessages) -> StepTiming:
    """Tell how the physics steps of messages lie to their stamps."""
    states = messages.table.nested("states")
    return steps_of_messages(
        states.table.texts("info"), states.parent, messages.table.nanoseconds("header.stamp")
    )


SOURCE: Final = ContactSource(
    type_name="gazebo_msgs/ContactsState",
    fields=_FIELDS,
    normals="states.contact_normals",
    read=to_contact_samples,
    links=foot_links,
    timing=step_timing,
)
