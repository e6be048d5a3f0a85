"""Gazebo's contact sensors: pairs of bodies that touch, and several physics steps a message.

The foot may be either body of a pair. A sensor of Gazebo classic that is slower than the simulation
puts the states of several steps into one message; which of them a state belongs to is told by its
text `info` alone. The new Gazebo's messages are one step each.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase
from typing import Final

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.arrays import Bytes, Flags, Ints, sum_by_group
from dogbot_logtool.core.contact.contacts import (
    FOOT_IS_COLLISION1,
    FOOT_IS_COLLISION2,
    NOT_THIS_FOOT,
    Contacts,
    contact_samples,
)
from dogbot_logtool.reader.decode.columns import Texts, gather_bytes
from dogbot_logtool.reader.foot import Foot
from dogbot_logtool.reader.messages.feet import ContactSamples, FootChannels
from dogbot_logtool.reader.messages.message_type import Pairs
from dogbot_logtool.reader.messages.messages import DecodedMessages

UNTIMED: Final = int(np.iinfo(np.int64).min)
"""The lag of a message that tells no physics step."""
_GROUND_WORDS: Final = ("ground", "plane", "terrain", "heightmap", "floor", "world")
_INFO_TAIL: Final = 48
"""Bytes at the end of `info` that hold the time of the physics step, and more."""
_TIME: Final = np.frombuffer(b"time:", np.uint8)
_NANOSECOND_DIGITS: Final = 9
_NINE: Final = 9
_MOST_DIGITS: Final = 19
"""Of times since 1970 in ns; more may not fit into an int64."""


@dataclass(frozen=True, slots=True)
class StepTiming:
    """How the physics steps of n messages lie to their stamps."""

    lag: Ints
    """(n,) ns by which a message's newest step is older than its stamp; `UNTIMED`: not known."""
    step: Ints
    """(k,) ns between neighbouring steps of one message."""


def read_pairs(
    pairs: Pairs, messages: DecodedMessages, stamp: Ints, feet: FootChannels
) -> ContactSamples:
    """Reduce n messages of pairs to one sample each, of the newest physics step.

    Args:
        pairs: where they have the pairs.
        messages: their channels tell of one foot each.
        stamp: (n,) ns.
        feet: the feet.
    """
    states = messages.table.nested(pairs.array)
    inside = states.table
    points, wrenches, normals = (
        inside.nested(name) for name in (pairs.points, "wrenches", pairs.normals)
    )
    force = wrenches.table.vectors(pairs.force, "xyz")
    if pairs.total:
        total = inside.vectors(pairs.total, "xyz")
    else:
        total = sum_by_group(force, wrenches.parent, inside.rows)
    newest, untimed = np.ones(inside.rows, np.bool_), 0
    if pairs.info:
        newest, untimed = newest_step(inside.texts(pairs.info), states.parent, messages.table.rows)
    foot = feet.single(messages.channel)
    names = inside.texts(pairs.bodies[0]), inside.texts(pairs.bodies[1])
    side, links = foot_sides(*names, foot[states.parent], feet.feet)
    contacts = Contacts(
        foot=foot,
        log_time=messages.log_time,
        stamp=stamp,
        state_message=states.parent,
        foot_side=side,
        newest=newest,
        total_force=total,
        point_state=points.parent,
        point=points.table.vectors("", "xyz"),
        wrench_state=wrenches.parent,
        wrench_force=force,
        normal_state=normals.parent,
        normal=normals.table.vectors("", "xyz"),
    )
    samples = contact_samples(contacts)
    if not pairs.info:
        # The new Gazebo writes wrenches along the world's axes.
        samples = replace(samples, in_world=samples.in_contact)
    return ContactSamples(samples, contacts, untimed, int((side == NOT_THIS_FOOT).sum()), links)


def step_timing(pairs: Pairs, messages: DecodedMessages, stamp: Ints) -> StepTiming:
    """Tell how the physics steps of messages lie to their stamps, (n,) ns."""
    states = messages.table.nested(pairs.array)
    info = states.table.texts(pairs.info)
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


def foot_sides(
    first_names: Texts, second_names: Texts, foot: Ints, feet: Sequence[Foot]
) -> tuple[NDArray[np.int8], dict[int, set[str]]]:
    """Tell which body of each pair is the foot.

    Args:
        first_names: (s,) names of body 1.
        second_names: (s,) names of body 2.
        foot: (s,) index of the foot whose sensor tells of the pair.
        feet: the robot's feet.

    Returns:
        (s,) as in `Contacts.foot_side`; and by foot the links that forces are in the frames of:
        those of its own collisions, where they are named first.
    """
    # Few pairs of names make few cases: each is judged once, and looked up. Whatever stands between
    # two names, their lengths for one, can only make more pairs of them. Each foot has its own.
    start = np.minimum(first_names.start, second_names.start)
    end = np.maximum(first_names.end, second_names.end)
    pair, rows = Texts(first_names.buffer, start, end - start).alike(foot)
    sides: list[int] = []
    links: dict[int, set[str]] = {}
    for row in rows:
        number, first = int(foot[row]), first_names.text(row)
        sides.append(_side(feet[number], first, second_names.text(row)))
        link = link_of_collision(first)
        if sides[-1] == FOOT_IS_COLLISION1 and link is not None:
            links.setdefault(number, set()).add(link)
    side: NDArray[np.int8] = np.array(sides, np.int8)[pair]
    return side, links


def _side(foot: Foot, first: str, second: str) -> int:
    """Tell which of two bodies is the foot, by their names."""
    if _of_same_robot(first, second):
        return NOT_THIS_FOOT
    is_first, is_second = _is_foot(foot, first), _is_foot(foot, second)
    if is_first != is_second:
        return FOOT_IS_COLLISION1 if is_first else FOOT_IS_COLLISION2
    if is_first or foot.collision:
        return NOT_THIS_FOOT
    # Without a pattern, and with names that do not tell, the ground's name may; else the sensor's
    # own body stands first.
    only_first_is_ground = _is_ground(first) and not _is_ground(second)
    return FOOT_IS_COLLISION2 if only_first_is_ground else FOOT_IS_COLLISION1


def _of_same_robot(first: str, second: str) -> bool:
    """Tell whether two bodies belong to one model that is not the ground's."""
    models = [name.split("::")[0] for name in (first, second) if name.count("::") >= 2]
    ground = _is_ground(first) or _is_ground(second)
    return len(models) == 2 and models[0] == models[1] and not ground


def link_of_collision(collision: str) -> str | None:
    """Return the link in Gazebo's name of a collision, ``model::link::collision``; None: none.

    Nested models add parts in front; the link is always the last but one.
    """
    parts = collision.split("::")
    return parts[-2] if len(parts) >= 3 else None


def _is_foot(foot: Foot, name: str) -> bool:
    if foot.collision:
        return fnmatchcase(name, foot.collision)
    return foot.name.lower() in name.lower()


def _is_ground(name: str) -> bool:
    return any(word in name.lower() for word in _GROUND_WORDS)
