"""Contact messages as columns, reduced to one sample a message."""

from dataclasses import dataclass, replace
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

FOOT_IS_COLLISION1: Final = 1
FOOT_IS_COLLISION2: Final = 2
NOT_THIS_FOOT: Final = 0
"""Values of `Contacts.foot_side`."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
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


@dataclass(frozen=True, slots=True, eq=False, repr=False)
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
    messages = len(contacts.log_time)
    used = contacts.newest & (contacts.foot_side != NOT_THIS_FOOT)
    turned = contacts.foot_side == FOOT_IS_COLLISION2
    # States that do not count are those of one message more.
    message = np.where(used, contacts.state_message, messages)
    states_of = np.bincount(message, minlength=messages + 1)
    turned_of = np.bincount(message[turned], minlength=messages + 1)
    in_contact = states_of[:messages] > 0
    force = sum_by_group(_where_turned(turned, contacts.total_force), message, messages + 1)
    points, position = _mean_point(contacts, message[contacts.point_state])
    state = contacts.normal_state
    normals = _where_turned(turned[state], contacts.normal)
    normal = sum_by_group(normals, message[state], messages + 1)[:messages]
    length = norms(normal)
    # Of numbers whose squares overflow, no direction is known.
    length[~np.isfinite(length)] = np.nan
    with np.errstate(invalid="ignore", divide="ignore"):
        normal /= length[:, None]
    return Samples(
        foot=contacts.foot,
        log_time=contacts.log_time,
        stamp=contacts.stamp,
        in_contact=in_contact,
        force=force[:messages],
        in_world=in_contact & (turned_of == states_of)[:messages],
        points=points,
        position=position,
        normal=normal,
    )


def _where_turned(turned: Flags, vectors: Floats) -> Floats:
    """(n, 3): turn the chosen vectors round."""
    return np.where(turned[:, None], -vectors, vectors) if turned.any() else vectors


def _mean_point(contacts: Contacts, message: Ints) -> tuple[Ints, Floats]:
    """(n,) number of each message's contact points, (n, 3) m their force-weighted mean.

    Args:
        contacts: of n messages.
        message: (p,) the message that each point counts for; n: none.
    """
    messages = len(contacts.log_time)
    weight = _point_weights(contacts)
    total = sum_by_group(weight, message, messages + 1)
    # Sensors of other physics engines may report no force at all: then every point counts alike.
    unweighted = (total == 0.0)[message]
    if unweighted.any():
        weight = np.where(unweighted, 1.0, weight)
        total = sum_by_group(weight, message, messages + 1)
    with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
        weighted = sum_by_group(contacts.point * weight[:, None], message, messages + 1)
        mean = (weighted / total[:, None])[:messages]
    return np.bincount(message, minlength=messages + 1)[:messages], mean


def _point_weights(contacts: Contacts) -> Floats:
    """(p,) N: the force at each point, or an equal part of its state's where lengths differ."""
    of_point, of_wrench = contacts.point_state, contacts.wrench_state
    if np.array_equal(of_point, of_wrench):
        return norms(contacts.wrench_force)
    states = len(contacts.state_message)
    points_of = np.bincount(of_point, minlength=states)
    paired = points_of == np.bincount(of_wrench, minlength=states)
    weight = norms(contacts.total_force)[of_point] / points_of[of_point]
    points, wrenches = np.flatnonzero(paired[of_point]), np.flatnonzero(paired[of_wrench])
    points = points[np.argsort(of_point[points], kind="stable")]
    wrenches = wrenches[np.argsort(of_wrench[wrenches], kind="stable")]
    weight[points] = norms(contacts.wrench_force[wrenches])
    return weight
