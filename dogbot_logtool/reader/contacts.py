"""gazebo_msgs/ContactsState to columns."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from typing import Final

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.arrays import Flags, Ints
from dogbot_logtool.core.contacts import (
    FOOT_IS_COLLISION1,
    FOOT_IS_COLLISION2,
    NOT_THIS_FOOT,
    Contacts,
)
from dogbot_logtool.reader.columns import Nested, Texts, gather_bytes
from dogbot_logtool.reader.log import Batch, Channel
from dogbot_logtool.reader.messages import DecodedMessages, decode_channels, layout_of
from dogbot_logtool.robot import Foot

CONTACTS_TYPE: Final = "gazebo_msgs/ContactsState"
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
_GROUND_WORDS: Final = ("ground", "plane", "terrain", "heightmap", "floor", "world")


@dataclass(frozen=True, slots=True)
class ContactsRead:
    """Contact columns, and what was noticed on the way."""

    contacts: Contacts
    untimed_messages: int
    """Messages of several states whose `info` tells no time: read as one physics step."""
    foreign_states: int
    """States of pairs in which not exactly one body is the foot."""


def check_contacts(channel: Channel) -> None:
    """Check that a channel's messages can be decoded.

    Raises:
        DefinitionError: its definition is damaged, or lacks a field that is needed.
    """
    layout_of(channel, _WANTED)


def decode_contacts(batch: Batch, channels: Sequence[Channel]) -> list[DecodedMessages]:
    """Decode the contact messages of a batch; see `decode_channels`."""
    return decode_channels(batch, channels, _WANTED)


def contact_columns(
    messages: DecodedMessages, feet: Sequence[Foot], foot_of: Mapping[int, int]
) -> ContactsRead:
    """Return the columns of decoded contact messages.

    Args:
        messages: the decoded messages.
        feet: the robot's feet.
        foot_of: index of the foot in `feet` by channel id.
    """
    table = messages.table
    states = table.nested("states")
    points = states.table.nested("contact_positions")
    wrenches = states.table.nested("wrenches")
    normals = states.table.nested("contact_normals")
    foot = _foot_of_messages(messages.channel, foot_of)
    newest, untimed = newest_step(states.table.texts("info"), states.parent, table.rows)
    side = _foot_sides(states, foot, feet)
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
    return ContactsRead(contacts, untimed, int((side == NOT_THIS_FOOT).sum()))


def foot_links(
    messages: DecodedMessages, feet: Sequence[Foot], foot_of: Mapping[int, int]
) -> dict[int, set[str]]:
    """Return the links that the feet's own collisions belong to, by foot.

    Only pairs with the foot in first place count: their wrenches are in that link's frame.
    """
    states = messages.table.nested("states")
    foot = _foot_of_messages(messages.channel, foot_of)
    side = _foot_sides(states, foot, feet)
    code, names = states.table.texts("collision1_name").encode()
    pairs = foot[states.parent] * len(names) + code
    links: dict[int, set[str]] = {}
    for pair in np.unique(pairs[side == FOOT_IS_COLLISION1]).tolist():
        link = link_of_collision(names[pair % len(names)])
        if link is not None:
            links.setdefault(pair // len(names), set()).add(link)
    return links


def link_of_collision(collision: str) -> str | None:
    """Return the link in Gazebo's name of a collision, ``model::link::collision``; None: none.

    Nested models add parts in front; the link is always the last but one.
    """
    parts = collision.split("::")
    return parts[-2] if len(parts) >= 3 else None


def _foot_of_messages(channel: Ints, foot_of: Mapping[int, int]) -> Ints:
    """(n,) foot index of every message."""
    ids = np.array(sorted(foot_of), np.int64)
    feet = np.array([foot_of[number] for number in ids.tolist()], np.int64)
    return feet[np.searchsorted(ids, channel)]


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


def _foot_sides(states: Nested, foot: Ints, feet: Sequence[Foot]) -> NDArray[np.int8]:
    """(s,) which body of each state's pair is the foot."""
    code1, names1 = states.table.texts("collision1_name").encode()
    code2, names2 = states.table.texts("collision2_name").encode()
    foot_of_state = foot[states.parent]
    first = _matches(feet, names1)[foot_of_state, code1]
    second = _matches(feet, names2)[foot_of_state, code2]
    side = np.select(
        [first & ~second, second & ~first], [FOOT_IS_COLLISION1, FOOT_IS_COLLISION2], NOT_THIS_FOOT
    )
    # Without a pattern, and with names that do not tell, the ground's name may; else the sensor's
    # own body stands first.
    guess = np.array([not one.collision for one in feet], np.bool_)[foot_of_state]
    guess &= ~(first | second)
    ground1 = np.array([_is_ground(name) for name in names1], np.bool_)[code1]
    ground2 = np.array([_is_ground(name) for name in names2], np.bool_)[code2]
    guessed = np.where(ground1 & ~ground2, FOOT_IS_COLLISION2, FOOT_IS_COLLISION1)
    return np.where(guess, guessed, side).astype(np.int8)


def _matches(feet: Sequence[Foot], names: Sequence[str]) -> Flags:
    """(feet, names) whether a name is the foot's."""
    table = [[_is_foot(foot, name) for name in names] for foot in feet]
    return np.array(table, np.bool_).reshape(len(feet), len(names))


def _is_foot(foot: Foot, name: str) -> bool:
    if foot.collision:
        return fnmatchcase(name, foot.collision)
    return foot.name.lower() in name.lower()


def _is_ground(name: str) -> bool:
    return any(word in name.lower() for word in _GROUND_WORDS)
