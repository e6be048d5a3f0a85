"""gazebo_msgs/ContactsState: the bumpers of Gazebo classic."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.arrays import Flags, Ints
from dogbot_logtool.core.contacts import (
    FOOT_IS_COLLISION1,
    NOT_THIS_FOOT,
    Contacts,
    contact_samples,
)
from dogbot_logtool.reader.columns import Texts, gather_bytes
from dogbot_logtool.reader.contact_sources.collisions import foot_sides, link_of_collision
from dogbot_logtool.reader.contact_sources.source import (
    ContactSource,
    Felt,
    FootChannels,
    FootLinks,
)
from dogbot_logtool.reader.messages import DecodedMessages

_WANTED: Final = (
    "header.stamp",
    "header.frame_id",
    "states.info",
    "states.collision1_name",
    "states.collision2_name",
    "states.wrenches.force",
    "states.total_wrench.force",
    "states.contact_positions",
    "states.contact_normals",
)
_INFO_TAIL: Final = 48
"""Bytes at the end of `info` that hold the time of the physics step, and more."""
_TIME: Final = np.frombuffer(b"time:", np.uint8)


def contacts_felt(messages: DecodedMessages, feet: FootChannels) -> Felt:
    """Reduce messages to samples; see `ContactSource.read`."""
    table = messages.table
    states = table.nested("states")
    points = states.table.nested("contact_positions")
    wrenches = states.table.nested("wrenches")
    normals = states.table.nested("contact_normals")
    foot = feet.single(messages.channel)
    newest, untimed = newest_step(states.table.texts("info"), states.parent, table.rows)
    side = _sides(messages, feet, foot)
    contacts = Contacts(
        foot=foot,
        log_time=messages.log_time,
        stamp=table.nanoseconds("header.stamp"),
        state_message=states.parent,
        foot_side=side,
        newest=newest,
        total_force=states.table.vectors("total_wrench.force", "xyz"),
        point_state=points.parent,
        point=points.table.vectors("", "xyz"),
        wrench_state=wrenches.parent,
        wrench_force=wrenches.table.vectors("force", "xyz"),
        normal_state=normals.parent,
        normal=normals.table.vectors("", "xyz"),
    )
    foreign = int((side == NOT_THIS_FOOT).sum())
    return Felt(contact_samples(contacts), contacts, untimed, foreign)


def foot_links(messages: DecodedMessages, feet: FootChannels) -> FootLinks:
    """Return the links that the feet's own collisions belong to, by foot.

    Only pairs with the foot in first place count: their wrenches are in that link's frame.
    """
    states = messages.table.nested("states")
    foot = feet.single(messages.channel)
    side = _sides(messages, feet, foot)
    code, names = states.table.texts("collision1_name").encode()
    pairs = foot[states.parent] * len(names) + code
    links: dict[int, set[str]] = {}
    for pair in np.unique(pairs[side == FOOT_IS_COLLISION1]).tolist():
        link = link_of_collision(names[pair % len(names)])
        if link is not None:
            links.setdefault(pair // len(names), set()).add(link)
    return links


def _sides(messages: DecodedMessages, feet: FootChannels, foot: Ints) -> NDArray[np.int8]:
    """(s,) which body of each state's pair is the foot."""
    states = messages.table.nested("states")
    names = states.table.texts("collision1_name"), states.table.texts("collision2_name")
    return foot_sides(*names, foot[states.parent], feet.feet)


def newest_step(info: Texts, message: Ints, messages: int) -> tuple[Flags, int]:
    """Tell which states belong to their message's newest physics step.

    The step's time is only in the text `info`: ``time:12.345000000`` in ROS 1, ``time: [12.345]``
    in ROS 2. States come in the order of the steps, so those whose time reads like the last
    state's are the newest. Where any state of a message tells no time, all count as one step.

    Args:
        info: (s,) texts.
        message: (s,) the message of each state; states of one message stand in order.
        messages: number of messages.

    Returns:
        (s,) flags, and how many messages of several states tell no time.
    """
    if not len(message):
        return np.ones(0, np.bool_), 0
    last_state = np.zeros(messages, np.int64)
    last_state[message] = np.arange(len(message))
    states_of = np.bincount(message, minlength=messages)
    if states_of.max() == 1:
        return np.ones(len(message), np.bool_), 0
    time, timed = _step_times(info)
    newest: Flags = time == time[last_state[message]]
    if timed.all():
        return newest, 0
    untimed = np.bincount(message[~timed], minlength=messages) > 0
    newest |= untimed[message]
    return newest, int((untimed & (states_of > 1)).sum())


def _step_times(info: Texts) -> tuple[NDArray[np.void], Flags]:
    """(s,) the text after the last ``time:`` in a form that compares, and (s,) if there is one."""
    end = info.start + info.length
    alike = _times_at_same_place(info, end)
    if alike is not None:
        return alike, np.ones(len(end), np.bool_)
    size = min(_INFO_TAIL, len(info.buffer))
    first = np.maximum(end - size, 0)
    tail = np.zeros((len(end), _INFO_TAIL), np.uint8)
    tail[:, :size] = gather_bytes(info.buffer, first, size)
    column = np.arange(_INFO_TAIL)
    begins_at = (info.start - first)[:, None]
    inside = (column >= begins_at) & (column < (end - first)[:, None])
    colons = (tail == ord(":")) & inside
    colon = _INFO_TAIL - 1 - colons[:, ::-1].argmax(axis=1)
    rows = np.arange(len(end))
    timed = colons[rows, colon] & (colon >= 4)
    for back, letter in enumerate(b"emit", start=1):
        timed &= tail[rows, colon - back] == letter
    tail[column <= colon[:, None]] = 0
    tail[~inside] = 0
    return tail.view(f"V{_INFO_TAIL}")[:, 0], timed


def _times_at_same_place(info: Texts, end: Ints) -> NDArray[np.void] | None:
    """(s,) what `_step_times` seeks if it is as long in all texts, as is usual; else None."""
    text = info.text(0)
    size = len(text) - text.rfind("time:") if text.isascii() and "time:" in text else 0
    if not len(_TIME) < size <= _INFO_TAIL or int(info.length.min()) < size:
        return None
    tail = gather_bytes(info.buffer, end - size, size)
    if (tail[:, : len(_TIME)] != _TIME).any() or (tail[:, len(_TIME) :] == ord(":")).any():
        return None
    return tail.view(f"V{size}")[:, 0]


SOURCE: Final = ContactSource(
    type_name="gazebo_msgs/ContactsState",
    wanted=_WANTED,
    read=contacts_felt,
    links=foot_links,
)
