"""Contact messages as columns, reduced to one sample a message.

Some sensors, as those of the new Gazebo, send messages only while something touches. Everything
after this expects samples of swings, too, so a silence becomes samples without contact. Lost
messages are silence too. One is shorter than any swing of the foot; one of all feet at once is a
drop-out, unless it is no longer than the flight of every stride.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import (
    Flags,
    Floats,
    Ints,
    header_time,
    median_of,
    norms,
    picked,
    rows_of_runs,
    sum_by_group,
)
from dogbot_logtool.core.clock import LONGEST_DELAY_S, SILENCE_NS, TimeSource

FOOT_IS_COLLISION1: Final = 1
FOOT_IS_COLLISION2: Final = 2
NOT_THIS_FOOT: Final = 0
"""Values of `Contacts.foot_side`."""


class Contacts(NamedTuple):
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


MISSED_INTERVALS: Final = 2.5
"""A silence of more than so many intervals is a swing."""
LONGEST_SWING_NS: Final = 3_000_000_000
"""Longer silences are left as they are."""
_SPACING_NS: Final = 40_000_000
"""Samples without contact are told this far apart; more than 50 ms would be a gap."""
_LONG_INTERVALS: Final = 6.0
"""Silences longer than so many intervals are swings nearly always, not lost messages."""
_USUAL_INTERVAL_NS: Final = 10_000_000
"""ns, assumed of a sensor that sent hardly any message."""
_FEWEST_SILENCES: Final = 3
_PART_OF_SWING: Final = 0.5
"""A swing is at least this part of the usual swing."""
_PART_OF_STRIDES: Final = 0.5
"""Part of the strides that must have a flight for flight to be usual."""
_LONGER_FLIGHT: Final = 1.5
"""A flight is no longer than the usual one by this factor."""


Usual = tuple[int, Ints]
"""The usual interval between messages of a foot in contact, ns, and its silences that are swings
nearly always, (k,) ns; none, if they are too few to tell anything."""


def with_swings(
    feet: Sequence[Samples],
    silent: Iterable[int],
    clock: TimeSource,
    log_start: int | None,
    log_end: int | None,
) -> tuple[Samples, ...]:
    """Insert samples without contact into the silences of feet that are silent in swing.

    The first sample without contact stands one interval after the last contact, and the last one
    interval before the next, where an always-speaking sensor would have said so. Header stamps and
    log times are interpolated.

    Args:
        feet: samples of each foot, in the order of the log.
        silent: the feet that are silent in swing; the others stay as they are.
        clock: on which silences are seen.
        log_start: ns, log time from which silence counts; None: from the first contact.
        log_end: ns, log time up to which it counts; None: up to the last contact.

    Returns:
        the samples and the inserted ones of each foot, in order.
    """
    times = [clock.of(samples) for samples in feet]
    usual = {foot: _usual(times[foot]) for foot in silent if len(times[foot])}
    if not usual:
        return tuple(feet)
    dropouts = _dropouts(times, usual)
    return tuple(
        _swinging(samples, clock, usual[foot], dropouts, log_start, log_end)
        if foot in usual
        else samples
        for foot, samples in enumerate(feet)
    )


def _usual(time: Ints) -> Usual:
    """Learn how long the intervals and swings of a foot usually are, from its times, (n,) ns."""
    step = np.diff(time)
    known = step[step > 0]
    usual = int(median_of(known)) if len(known) else _USUAL_INTERVAL_NS
    interval = min(usual, LONGEST_SWING_NS)
    long = step[(step > _LONG_INTERVALS * interval) & (step <= LONGEST_SWING_NS)]
    return interval, long if len(long) >= _FEWEST_SILENCES else long[:0]


def _dropouts(times: Sequence[Ints], usual: Mapping[int, Usual]) -> Ints:
    """(d, 2) ns: the last message of any foot before each drop-out of all, and the next.

    A drop-out lasts longer than any flight; none is known where a foot's swings are not.
    """
    intervals, strides = zip(*((each, len(swings)) for each, swings in usual.values()), strict=True)
    if not all(strides):
        return timespans.no_spans()
    together = np.diff(np.sort(np.concatenate([times[foot] for foot in usual])))
    longest = max(_LONG_INTERVALS * max(intervals), float(SILENCE_NS))
    flights = together[(together > longest) & (together <= LONGEST_SWING_NS)]
    if len(flights) >= _PART_OF_STRIDES * median_of(strides):
        longest = max(_LONGER_FLIGHT * float(median_of(flights)), longest)
    every = np.sort(np.concatenate(times))
    return timespans.steps_where(every, np.diff(every) > round(longest))


def _swinging(
    samples: Samples,
    clock: TimeSource,
    usual: Usual,
    dropouts: Ints,
    log_start: int | None,
    log_end: int | None,
) -> Samples:
    """Insert the swings of a foot, of which there are n samples; arguments as in `with_swings`."""
    interval, swings = usual
    times, clock_row = np.stack([samples.log_time, samples.stamp]), int(clock is TimeSource.HEADER)
    # Messages that are logged in bursts are late, but for the last of each.
    first = int(times[clock_row, 0] + (times[0] - times[clock_row]).min())
    # The log's ends may cut a swing: the foot is silent from one interval before the log starts.
    ahead = 0 if log_start is None else first - log_start + interval
    # Beyond the longest swing it is none; and a stamp of 0 or less would say that there are none.
    if not 0 <= ahead <= LONGEST_SWING_NS or times[1, 0] <= ahead:
        ahead = 0
    behind = 0 if log_end is None else log_end + interval - int(times[0, -1])
    times = np.concatenate([times[:, :1] - ahead, times, times[:, -1:] + behind], axis=1)
    time, steps = times[clock_row], np.diff(times)
    step = np.diff(time)
    # A shorter silence is a lost message even there, or the delay of the first one.
    lasts_from = np.full(len(step), round(MISSED_INTERVALS * interval))
    lasts_from[0] = max(lasts_from[0], round(LONGEST_DELAY_S * 1e9))
    if len(swings):
        shortest = round(_PART_OF_SWING * float(median_of(swings)))
        lasts_from[1:-1] = np.maximum(lasts_from[1:-1], shortest)
    swing = (step > lasts_from) & (step <= LONGEST_SWING_NS)
    swing &= (steps[1] >= 0) & (steps[1] <= 2 * LONGEST_SWING_NS)
    swing &= ~timespans.touches(dropouts, time[:-1] + 1, time[1:] - 1)
    spacing = max(interval, _SPACING_NS)
    count = np.where(swing, 1 - (2 * interval - step) // spacing, 0)
    # Each row, but for the log's start, and those that are inserted behind it.
    number, row, _ = (each[1:] for each in rows_of_runs(np.zeros_like(count), count + 1))
    passed = np.minimum(interval + (number - 1) * spacing, step[row] - interval)
    share: Floats = np.where(number > 0, passed / np.maximum(step[row], 1), 0.0)
    log_time, stamp = times[:, row] + np.round(share * steps[:, row]).astype(np.int64)
    whole = replace(samples.pick(np.maximum(row - 1, 0)), log_time=log_time, stamp=stamp)
    return without_contact(whole, number > 0)
