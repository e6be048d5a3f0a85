"""Gazebo's contact sensors: pairs of bodies that touch, and several physics steps a message.

The foot may be either body of a pair. A sensor of Gazebo classic that is slower than the simulation
puts the states of several steps into one message; which of them a state belongs to is told by its
text `info` alone. The new Gazebo's messages are one step each.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from fnmatch import fnmatchcase
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.arrays import Bytes, Flags, Ints, distinct, sum_by_group
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
_TIME: Final = r"(?a)time:[\s\[]*(\d{1,10})\.(\d{1,9})[\s\]]*$"
"""End of `info`: seconds and nanoseconds of the physics step."""


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
    times = np.full(len(info.start), UNTIMED)
    for size in distinct(info.length).tolist():
        rows = np.flatnonzero(info.length == size)
        times[rows] = _times_of_one_length(info.pick(rows))
    return times


def _times_of_one_length(info: Texts) -> Ints:
    """(s,) ns, of texts of one length, which mostly are alike but for the digits at their end."""
    if found := re.search(_TIME, info.text(0)):
        tail = gather_bytes(info.buffer, info.end - len(found[0]), len(found[0]))
        digit = _is_digit(tail[0])
        if (tail == tail[0])[:, ~digit].all() and _is_digit(tail[:, digit]).all():
            start, point, end = found.start(1), found.end(1), found.end(2)
            seconds = _numbers(tail[:, start - found.start() : point - found.start()])
            nanoseconds = _numbers(tail[:, point + 1 - found.start() : end - found.start()])
            return np.asarray(seconds * 1_000_000_000 + nanoseconds)
    each = (re.search(_TIME, info.text(row)) for row in range(len(info.start)))
    return np.array([int(t[1]) * 1_000_000_000 + int(t[2]) if t else UNTIMED for t in each])


def _numbers(digits: Bytes) -> Ints:
    """(s,) numbers of which each row has the digits."""
    values = digits.astype(np.int64) - ord("0")
    return np.asarray(values @ 10 ** np.arange(digits.shape[1])[::-1])


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
