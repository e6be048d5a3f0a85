"""Gazebo's contact sensors: pairs of bodies that touch, and several physics steps a message.

The foot may be either body of a pair. A sensor of Gazebo classic that is slower than the simulation
puts the states of several steps into one message; which of them a state belongs to is told by its
text `info` alone. The new Gazebo's messages are one step each.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fnmatch import fnmatchcase
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.arrays import Bytes, Flags, Ints, sum_by_group
from dogbot_logtool.core.contact.contacts import (
    FOOT_IS_COLLISION1,
    FOOT_IS_COLLISION2,
    NOT_THIS_FOOT,
    Contacts,
    Samples,
    contact_samples,
)
from dogbot_logtool.reader.decode.columns import Texts, gather_bytes
from dogbot_logtool.reader.foot import Foot
from dogbot_logtool.reader.messages.feet import FootChannels
from dogbot_logtool.reader.messages.message_type import Pairs
from dogbot_logtool.reader.messages.messages import DecodedMessages

UNTIMED: Final = int(np.iinfo(np.int64).min)
"""The time of a text that tells none, and the lag of a message that tells no physics step."""
_GROUND_WORDS: Final = ("ground", "plane", "terrain", "heightmap", "floor", "world")
_INFO_TAIL: Final = 48
"""Bytes at the end of `info` that hold the time of the physics step, and more."""
_MOST_DIGITS: Final = 18
"""Of a number; more may not fit into an int64."""


class PairStates(NamedTuple):
    """Contact states of n messages, as recorded, and which physics steps they are of."""

    contacts: Contacts
    lag: Ints
    """(n,) ns by which a message's newest step is older than its stamp; `UNTIMED`: not known."""
    step: Ints
    """(k,) ns between neighbouring steps of one message."""
    untimed_messages: int
    """Messages of several states of which some tell no time: read as one physics step."""
    foreign_states: int
    """States of pairs in which not exactly one body is the foot, or both are of one robot."""
    links: Mapping[int, set[str]]
    """Links of the feet's own collisions, by foot."""


def read_pairs(
    pairs: Pairs, messages: DecodedMessages, stamp: Ints, feet: FootChannels
) -> tuple[Samples, PairStates]:
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
    newest, untimed, step = np.ones(inside.rows, np.bool_), 0, np.empty(0, np.int64)
    lag = np.full(len(stamp), UNTIMED)
    if pairs.info:
        time = step_times(inside.texts(pairs.info))
        newest, lag, untimed = newest_step(time, states.parent, stamp)
        step = steps_of_messages(time, states.parent)
    foot = feet.single(messages.channel)
    names = [inside.texts(body) for body in pairs.bodies]
    side, links = foot_sides(names[0], names[1], foot[states.parent], feet.feet)
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
    foreign = int((side == NOT_THIS_FOOT).sum())
    return samples, PairStates(contacts, lag, step, untimed, foreign, links)


def newest_step(time: Ints, message: Ints, stamp: Ints) -> tuple[Flags, Ints, int]:
    """Tell which states belong to their message's newest physics step.

    States come in the order of the steps, so those with the last state's time are the newest.
    Where any state of a message tells no time, all count as one step.

    Args:
        time: (s,) ns, as `step_times` returns them.
        message: (s,) the message of each state; states of one message stand in order.
        stamp: (n,) ns.

    Returns:
        (s,) flags; (n,) ns by which each message's newest step is older than its stamp, or
        `UNTIMED`; and how many messages of several states have one that tells no time.
    """
    last, untimed = np.full(len(stamp), UNTIMED), np.zeros(len(stamp), np.bool_)
    last[message] = time
    untimed[message[time == UNTIMED]] = True
    newest = (time == last[message]) | untimed[message]
    lag = np.where(last == UNTIMED, UNTIMED, stamp - last)
    several = np.bincount(message, minlength=len(stamp)) > 1
    return newest, lag, int((untimed & several).sum())


def steps_of_messages(time: Ints, message: Ints) -> Ints:
    """(k,) ns between neighbouring steps in one message; arguments as for `newest_step`."""
    rows = np.flatnonzero((np.bincount(message)[message] > 1) & (time != UNTIMED))
    rows = rows[np.lexsort((time[rows], message[rows]))]
    step = np.diff(time[rows])
    later: Ints = step[(np.diff(message[rows]) == 0) & (step > 0)]
    return later


def step_times(info: Texts) -> Ints:
    """(s,) ns, the time behind the last ``time:`` of each text; `UNTIMED`: none.

    It reads ``time:12.345000000`` in ROS 1 and ``time: [12.345]`` in ROS 2: behind the point stand
    nanoseconds, which ROS 1 fills up with zeros and ROS 2 does not.
    """
    if not len(info.start):
        return info.start
    alike = _times_of_alike(info)
    if alike is not None:
        return alike
    size = min(_INFO_TAIL, len(info.buffer))
    first, column = np.maximum(info.end - size, 0), np.arange(size)
    begin, end = (info.start - first)[:, None], (info.end - first)[:, None]
    tail = np.where(
        (column >= begin) & (column < end), gather_bytes(info.buffer, first, size), np.uint8(0)
    )
    colon = size - 1 - (tail == ord(":"))[:, ::-1].argmax(axis=1)
    before = np.maximum(colon[:, None] + np.arange(-4, 1), 0)
    timed = (np.take_along_axis(tail, before, 1) == np.frombuffer(b"time:", np.uint8)).all(axis=1)
    seconds, nanoseconds = np.zeros((2, len(tail)), np.int64)
    behind_point = np.zeros(len(tail), np.bool_)
    for place in range(int(colon.min()) + 1, size):
        letter, here = tail[:, place], place > colon
        digit = _is_digit(letter) & here
        for number, own in ((seconds, digit & ~behind_point), (nanoseconds, digit & behind_point)):
            number[own] = 10 * number[own] + letter[own] - ord("0")
        behind_point |= (letter == ord(".")) & here
    return np.where(timed, seconds * 1_000_000_000 + nanoseconds, UNTIMED)


def _times_of_alike(info: Texts) -> Ints | None:
    """(s,) ns, if all texts end alike but for the digits, as is usual; else None."""
    text = info.text(0)
    size = len(text) - text.rfind("time:") if text.isascii() and "time:" in text else 0
    if not 0 < size <= _INFO_TAIL or int(info.length.min()) < size:
        return None
    tail = gather_bytes(info.buffer, info.end - size, size)
    digit = _is_digit(tail[0])
    if (tail != tail[0])[:, ~digit].any() or not _is_digit(tail[:, digit]).all():
        return None
    behind_point = np.cumsum(tail[0] == ord(".")) > 0
    numbers = [tail[:, digit & side] for side in (~behind_point, behind_point)]
    if max(each.shape[1] for each in numbers) > _MOST_DIGITS:
        return None
    seconds, nanoseconds = (
        (each - np.uint8(ord("0"))).astype(np.int64) @ 10 ** np.arange(each.shape[1])[::-1]
        for each in numbers
    )
    return np.asarray(seconds * 1_000_000_000 + nanoseconds)


def _is_digit(letters: Bytes) -> Flags:
    return np.asarray((letters >= ord("0")) & (letters <= ord("9")))


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
    (first, names), (second, others) = first_names.encode(), second_names.encode()
    # Few pairs of names make few cases: each is judged once.
    shape = len(feet), max(len(names), 1), max(len(others), 1)
    code = np.ravel_multi_index((foot, first, second), shape)
    different, case = np.unique(code, return_inverse=True)
    cases = np.stack(np.unravel_index(different, shape), axis=1)
    sides: list[int] = []
    links: dict[int, set[str]] = {}
    for number, one, other in cases.tolist():
        sides.append(_side(feet[number], names[one], others[other]))
        # Nested models add parts in front of ``model::link::collision``.
        if sides[-1] == FOOT_IS_COLLISION1 and names[one].count("::") > 1:
            links.setdefault(number, set()).add(names[one].split("::")[-2])
    return np.array(sides, np.int8)[case], links


def _side(foot: Foot, first: str, second: str) -> int:
    """Tell which of two bodies is the foot, by their names."""
    names = (first, second)
    models = [name.split("::")[0] for name in names if name.count("::") > 1]
    is_ground = [any(word in name.lower() for word in _GROUND_WORDS) for name in names]
    if len(models) == len(names) and models[0] == models[1] and not any(is_ground):
        return NOT_THIS_FOOT
    if foot.collision:
        is_foot = [fnmatchcase(name, foot.collision) for name in names]
    else:
        is_foot = [foot.name.lower() in name.lower() for name in names]
    if is_foot[0] != is_foot[1]:
        return FOOT_IS_COLLISION1 if is_foot[0] else FOOT_IS_COLLISION2
    if is_foot[0] or foot.collision:
        return NOT_THIS_FOOT
    # Without a pattern, and with names that do not tell, the ground's name may; else the sensor's
    # own body stands first.
    return FOOT_IS_COLLISION2 if is_ground == [True, False] else FOOT_IS_COLLISION1
