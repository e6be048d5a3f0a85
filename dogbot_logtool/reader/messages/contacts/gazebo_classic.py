"""gazebo_msgs/ContactsState: the bumpers of Gazebo classic.

A sensor that is slower than the simulation puts the states of several physics steps into one
message. Which of them a contact state belongs to is told by its text `info` alone.
"""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.contact.contacts import (
    FOOT_IS_COLLISION1,
    NOT_THIS_FOOT,
    Contacts,
    contact_samples,
)
from dogbot_logtool.core.geometry.arrays import Bytes, Flags, Ints
from dogbot_logtool.core.geometry.order_statistics import distinct
from dogbot_logtool.reader.decode.columns import Texts, gather_bytes
from dogbot_logtool.reader.decode.fields import HEADER, table, text, vector
from dogbot_logtool.reader.messages.contacts.collisions import foot_sides, link_of_collision
from dogbot_logtool.reader.messages.contacts.source import (
    UNTIMED,
    ContactSamples,
    ContactSource,
    FootChannels,
    FootLinks,
    StepTiming,
    vectors_inside,
)
from dogbot_logtool.reader.messages.messages import DecodedMessages

_INFO_TAIL: Final = 48
"""Bytes at the end of `info` that hold the time of the physics step, and more."""
_TIME: Final = np.frombuffer(b"time:", np.uint8)
_NANOSECOND_DIGITS: Final = 9
_NINE: Final = 9
_MOST_DIGITS: Final = 19
"""Of times since 1970 in ns; more may not fit into an int64."""
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


def foot_links(
    messages: DecodedMessages, _feet: FootChannels, contacts: Contacts | None
) -> FootLinks:
    """Return the links that the feet's own collisions belong to, by foot.

    Only pairs with the foot named first count: their wrenches are in that link's frame.
    """
    if contacts is None:
        return {}
    states = messages.table.nested("states")
    code, names = states.table.texts("collision1_name").encode()
    pairs = contacts.foot[contacts.state_message] * len(names) + code
    links: dict[int, set[str]] = {}
    for pair in distinct(pairs[contacts.foot_side == FOOT_IS_COLLISION1]).tolist():
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
    info, stamp = states.table.texts("info"), messages.table.nanoseconds("header.stamp")
    return StepTiming(
        newest_lag(info, states.parent, stamp), steps_of_messages(info, states.parent)
    )


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
    newest = np.ones(len(message), np.bool_)
    rows = _in_several(message)
    if not len(rows):
        return newest, 0
    message_of = message[rows]
    time, timed = _step_times(info.pick(rows))
    last = np.zeros(messages, np.int64)
    last[message_of] = np.arange(len(rows))
    untimed = np.zeros(messages, np.bool_)
    untimed[message_of[~timed]] = True
    newest[rows] = (time == time[last[message_of]]) | untimed[message_of]
    return newest, int(untimed.sum())


def _in_several(message: Ints) -> Ints:
    """Return the rows of states whose message holds several, most of which hold one."""
    return np.flatnonzero(np.bincount(message)[message] > 1)


def _step_times(info: Texts) -> tuple[NDArray[np.void], Flags]:
    """(s,) the text after the last ``time:`` in a form that compares, and (s,) if there is one."""
    end = info.end
    alike = _times_at_same_offset(info, end)
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


def _times_at_same_offset(info: Texts, end: Ints) -> NDArray[np.void] | None:
    """(s,) what `_step_times` seeks if it is as long in all texts, as is usual; else None."""
    text = info.text(0)
    size = len(text) - text.rfind("time:") if text.isascii() and "time:" in text else 0
    if not len(_TIME) < size <= _INFO_TAIL or int(info.length.min()) < size:
        return None
    tail = gather_bytes(info.buffer, end - size, size)
    if (tail[:, : len(_TIME)] != _TIME).any() or (tail[:, len(_TIME) :] == ord(":")).any():
        return None
    return tail.view(f"V{size}")[:, 0]


def newest_lag(info: Texts, message: Ints, stamp: Ints) -> Ints:
    """Return by how much the newest step of each message is older than its stamp.

    Args:
        info: (s,) texts.
        message: (s,) the message of each state; states of one message stand in order.
        stamp: (n,) ns.

    Returns:
        (n,) ns; `UNTIMED` where a message has no state, or one that tells no time.
    """
    last_state = np.full(len(stamp), -1, np.int64)
    last_state[message] = np.arange(len(message))
    known = np.flatnonzero(last_state >= 0)
    time, timed = _nanoseconds(info.pick(last_state[known]))
    lag = np.full(len(stamp), UNTIMED)
    lag[known[timed]] = stamp[known[timed]] - time[timed]
    return lag


def steps_of_messages(info: Texts, message: Ints) -> Ints:
    """(k,) ns between neighbouring steps in one message; arguments as for `newest_lag`."""
    rows = _in_several(message)
    time, timed = _nanoseconds(info.pick(rows))
    time, message = time[timed], message[rows[timed]]
    order = np.lexsort((time, message))
    time, message = time[order], message[order]
    step = np.diff(time)
    later: Ints = step[(message[1:] == message[:-1]) & (step > 0)]
    return later


def _nanoseconds(info: Texts) -> tuple[Ints, Flags]:
    """(s,) ns, the time that texts tell, and (s,) if they do.

    Behind the point stand nanoseconds, which ROS 1 fills up with zeros and ROS 2 does not.
    """
    if not len(info.start):
        return info.start, np.ones(0, np.bool_)
    time, timed = _step_times(info)
    characters: Bytes = time.view(np.uint8).reshape(len(time), -1)
    padded = _padded_nanoseconds(characters)
    if padded is not None:
        return padded, timed
    seconds, nanoseconds = np.zeros((2, len(time)), np.int64)
    behind_point = np.zeros(len(time), np.bool_)
    for column in characters.T:
        digit = (column >= ord("0")) & (column <= ord("9"))
        for number, here in ((seconds, digit & ~behind_point), (nanoseconds, digit & behind_point)):
            number[here] = 10 * number[here] + column[here] - ord("0")
        behind_point |= column == ord(".")
    return seconds * 1_000_000_000 + nanoseconds, timed


def _padded_nanoseconds(characters: Bytes) -> Ints | None:
    """(s,) ns of texts that end in seconds, a point and nine digits, as in ROS 1; None: others."""
    points = np.flatnonzero(characters[0] == ord("."))
    point = int(points[0]) if len(points) == 1 else 0
    end = point + 1 + _NANOSECOND_DIGITS
    if point <= len(_TIME) or (characters[:, point] != ord(".")).any():
        return None
    if (characters[:, end:] != ord("\n")).any():
        return None
    digits = np.delete(characters[:, :end], point, axis=1)[:, len(_TIME) :] - np.uint8(ord("0"))
    powers = np.arange(digits.shape[1] - 1, -1, -1)
    if end > characters.shape[1] or len(powers) > _MOST_DIGITS or (digits > _NINE).any():
        return None
    nanoseconds: Ints = digits.astype(np.int64) @ 10**powers
    return nanoseconds


SOURCE: Final = ContactSource(
    type_name="gazebo_msgs/ContactsState",
    fields=_FIELDS,
    read=to_contact_samples,
    links=foot_links,
    timing=step_timing,
)
