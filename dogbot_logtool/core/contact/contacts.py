"""Contact messages as columns, reduced to one sample a message."""

from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.arrays import (
    Flags,
    Floats,
    Ints,
    header_time,
    norms,
    picked,
    sum_by_group,
)
from dogbot_logtool.dataclass import dataclass

FOOT_IS_COLLISION1: Final = 1
FOOT_IS_COLLISION2: Final = 2
NOT_THIS_FOOT: Final = 0
"""Values of `Contacts.foot_side`."""


@dataclass(frozen=True, slots=True)
class Contacts:
    """Contact messages of all feet: n messages that hold s states with p points and q normals.

    Messages stand in log order. The states of one message keep their
    order among each other, but states of different messages may be interleaved; the same holds
    for points, wrenches and normals of one state.
    """

    foot: Ints
    """(n,) index of the foot among the robot's feet."""
    log_time: Ints
    """(n,) ns."""
    stamp: Ints
    """(n,) ns, header stamp as recorded."""
    state_message: Ints
    """(s,) the message that each state belongs to."""
    foot_side: NDArray[np.int8]
    """(s,) which body is the foot: `FOOT_IS_COLLISION1`, `FOOT_IS_COLLISION2`, or
    `NOT_THIS_FOOT` when it is neither or both, or the other body is of the same robot."""
    newest: Flags
    """(s,) whether the state belongs to its message's newest physics step."""
    total_force: Floats
    """(s, 3) N, on body 1, frame as recorded."""
    point_state: Ints
    """(p,) the state that each contact point belongs to."""
    point: Floats
    """(p, 3) m, world frame."""
    wrench_state: Ints
    """(w,) the state that each point wrench belongs to."""
    wrench_force: Floats
    """(w, 3) N, on body 1, frame as recorded."""
    normal_state: Ints
    """(q,) the state that each normal belongs to."""
    normal: Floats
    """(q, 3) contact normals, world frame, pointing into body 1."""


@dataclass(frozen=True, slots=True)
class Samples:
    """One contact message reduced to one contact sample."""

    foot: Ints
    """(n,) index of the foot among the robot's feet."""
    log_time: Ints
    """(n,) ns."""
    stamp: Ints
    """(n,) ns, header stamp as recorded."""
    in_contact: Flags
    """(n,) whether the newest physics step has a state of this foot."""
    force: Floats
    """(n, 3) N, on the foot, summed over the newest step; zero without contact. In the frame of
    the wrenches, except where `in_world` holds."""
    in_world: Flags
    """(n,) the force was read off the other body (the ground) and negated, so it is in the world
    frame even when the sensor writes link-frame wrenches."""
    points: Ints
    """(n,) number of contact points that `position` is the mean of."""
    position: Floats
    """(n, 3) m, force-weighted mean contact point, world frame; NaN where there is none."""
    normal: Floats
    """(n, 3) unit mean contact normal, world frame, pointing into the foot; NaN without one."""

    @property
    def time(self) -> Ints:
        """(n,) ns, header stamp, or log time where the stamp is zero."""
        return header_time(self.stamp, self.log_time)

    def pick(self, rows: Flags | Ints) -> "Samples":
        """Return the chosen rows (a mask or row numbers)."""
        return picked(self, rows)


def no_samples() -> Samples:
    """Return none."""
    times, vectors = np.empty(0, np.int64), np.empty((0, 3))
    flags = np.empty(0, np.bool_)
    return Samples(times, times, times, flags, vectors, flags, times, vectors, vectors)


def samples_by_foot(samples: Samples, feet: int) -> tuple[Samples, ...]:
    """Return the samples of each foot; the number of a foot takes no memory in them."""
    found = []
    for foot in range(feet):
        own = samples.pick(np.flatnonzero(samples.foot == foot))
        found.append(replace(own, foot=np.broadcast_to(np.int64(foot), len(own.log_time))))
    return tuple(found)


def without_contact(samples: Samples, rows: Flags) -> Samples:
    """Return samples of which the chosen ones, (n,), tell that nothing touches."""
    if not rows.any():
        return samples
    column = rows[:, None]
    return replace(
        samples,
        in_contact=samples.in_contact & ~rows,
        force=np.where(column, 0.0, samples.force),
        in_world=samples.in_world & ~rows,
        points=np.where(rows, 0, samples.points),
        position=np.where(column, np.nan, samples.position),
        normal=np.where(column, np.nan, samples.normal),
    )


def contact_samples(contacts: Contacts) -> Samples:
    """Reduce every contact message to one sample of its foot.

    A message may hold several physics steps of the same pair: only the newest counts, since
    adding steps up multiplies the load. Where the foot is the second body of a pair the force
    is turned round. States of other pairs are left out.
    """
    used = contacts.newest & (contacts.foot_side != NOT_THIS_FOOT)
    if not used.all():
        contacts = _of_states(contacts, used)
    messages, message = len(contacts.log_time), contacts.state_message
    turned = contacts.foot_side == FOOT_IS_COLLISION2

    states_of = np.bincount(message, minlength=messages)
    turned_of = np.bincount(message[turned], minlength=messages)
    in_contact = states_of > 0
    points, position = _mean_point(contacts)
    return Samples(
        foot=contacts.foot,
        log_time=contacts.log_time,
        stamp=contacts.stamp,
        in_contact=in_contact,
        force=sum_by_group(_where_turned(turned, contacts.total_force), message, messages),
        in_world=in_contact & (turned_of == states_of),
        points=points,
        position=position,
        normal=_mean_normal(contacts, turned),
    )


def _of_states(contacts: Contacts, used: Flags) -> Contacts:
    """Keep the chosen states, and what belongs to them."""
    number = np.cumsum(used) - 1
    point, wrench, normal = (
        used[state]
        for state in (contacts.point_state, contacts.wrench_state, contacts.normal_state)
    )
    return replace(
        contacts,
        state_message=contacts.state_message[used],
        foot_side=contacts.foot_side[used],
        newest=contacts.newest[used],
        total_force=contacts.total_force[used],
        point_state=number[contacts.point_state[point]],
        point=contacts.point[point],
        wrench_state=number[contacts.wrench_state[wrench]],
        wrench_force=contacts.wrench_force[wrench],
        normal_state=number[contacts.normal_state[normal]],
        normal=contacts.normal[normal],
    )


def _where_turned(turned: Flags, vectors: Floats) -> Floats:
    """(n, 3): turn the chosen vectors round."""
    return np.where(turned[:, None], -vectors, vectors) if turned.any() else vectors


def _mean_point(contacts: Contacts) -> tuple[Ints, Floats]:
    """(n,) number of each message's contact points, (n, 3) m their force-weighted mean."""
    messages = len(contacts.log_time)
    message = contacts.state_message[contacts.point_state]
    weight = _point_weights(contacts)
    total = sum_by_group(weight, message, messages)
    # Sensors of other physics engines may report no force at all: then every point counts alike.
    unweighted = total == 0.0
    if unweighted[message].any():
        weight = np.where(unweighted[message], 1.0, weight)
        total = sum_by_group(weight, message, messages)
    with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
        weighted = sum_by_group(contacts.point * weight[:, None], message, messages)
        return np.bincount(message, minlength=messages), weighted / total[:, None]


def _point_weights(contacts: Contacts) -> Floats:
    """(p,) N: the force at each point, or an equal part of its state's where lengths differ."""
    if np.array_equal(contacts.point_state, contacts.wrench_state):
        return norms(contacts.wrench_force)
    states = len(contacts.state_message)
    points_of = np.bincount(contacts.point_state, minlength=states)
    wrenches_of = np.bincount(contacts.wrench_state, minlength=states)
    paired = points_of == wrenches_of

    weight = np.empty(len(contacts.point_state))
    point_paired = paired[contacts.point_state]
    points = np.flatnonzero(point_paired)
    wrenches = np.flatnonzero(paired[contacts.wrench_state])
    if not np.array_equal(contacts.point_state[points], contacts.wrench_state[wrenches]):
        points = points[np.argsort(contacts.point_state[points], kind="stable")]
        wrenches = wrenches[np.argsort(contacts.wrench_state[wrenches], kind="stable")]
    weight[points] = norms(contacts.wrench_force[wrenches])
    if not point_paired.all():
        lone = contacts.point_state[~point_paired]
        weight[~point_paired] = norms(contacts.total_force[lone]) / points_of[lone]
    return weight


def _mean_normal(contacts: Contacts, turned: Flags) -> Floats:
    """(n, 3): unit mean of each message's normals, turned to point into the foot."""
    state = contacts.normal_state
    total = sum_by_group(
        _where_turned(turned[state], contacts.normal),
        contacts.state_message[state],
        len(contacts.log_time),
    )
    length = norms(total)
    # Of numbers whose squares overflow, no direction is known.
    length[~np.isfinite(length)] = np.nan
    with np.errstate(invalid="ignore", divide="ignore"):
        return total / length[:, None]
