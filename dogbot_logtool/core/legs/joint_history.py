"""Work and efforts of joints over a log, and their motion at a low rate.

Work and torque are integrated over every message. Positions and the work done in between are kept
at `JOINT_RATE_HZ`: 12 bytes a row and joint, 4 MB an hour.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Flags, Floats, Ints
from dogbot_logtool.core.corrections.clock import (
    TimeSource,
    advancing,
    check_stamps,
    first_at_each_tick,
)
from dogbot_logtool.core.legs.joint_track import (
    JointHistory,
    JointLimits,
    JointSamples,
    JointTrack,
)
from dogbot_logtool.core.legs.silences import LONGEST_STEP_S
from dogbot_logtool.dataclass import dataclass

JOINT_RATE_HZ: Final = 100.0
NEAR_LIMIT: Final = 0.02
"""Share of a joint's range: closer to an end than this is near a limit."""
NEAR_FULL: Final = 0.95
"""Share of the highest effort or speed by the robot description: more is near a limit."""
LEAST_WRAP: Final = 1.5 * np.pi
"""rad between two messages: no joint is so fast, so it wraps, if it is no more than a turn."""
_TURN: Final = 2.0 * np.pi
_IMPLAUSIBLE: Final = 1e9
"""rad, rad/s and N m: no joint reaches it."""


@dataclass(frozen=True, slots=True)
class _Messages:
    """The messages that have states of the same joints, and which of their rows are used."""

    number: int
    """Of all of them, usable or not."""
    not_advancing: int
    rows: Ints
    """(n,) those whose time is later than all before."""
    time: Ints
    """(n,) ns."""
    step_s: Floats
    """(n - 1,) s from each row to the next; NaN for silences."""
    kept: Ints
    """Which of the n to keep: the ends, the first at each tick, and both sides of a silence."""
    kept_time: Ints
    """ns."""


def joint_histories(
    names: Sequence[str],
    topic: str,
    samples: JointSamples,
    clock: TimeSource,
    limits: Mapping[str, JointLimits],
) -> dict[str, JointHistory]:
    """Return the history by name of each joint of a topic of which any state can be used.

    Args:
        names: of k joints, or of more.
        topic: of their states.
        samples: (n, k) states in the order of the log; a message without a position of a joint
            has no state of it.
        clock: which time counts.
        limits: of joints, by name.
    """
    found = {}
    recorded = np.abs(samples.position) <= _IMPLAUSIBLE
    for joints in _of_same_messages(recorded):
        rows = np.flatnonzero(recorded[:, joints[0]])
        times = samples.log_time[rows], samples.stamp[rows]
        messages = _messages(topic, rows, *times, clock)
        if not len(messages.rows):
            continue
        for joint in joints:
            position, velocity, effort = (
                each[messages.rows, joint].astype(np.float64)
                for each in (samples.position, samples.velocity, samples.effort)
            )
            states = _unwrapped(position), _plausible(velocity), _plausible(effort)
            limit = limits.get(names[joint], JointLimits())
            found[names[joint]] = _history(names[joint], messages, *states, limit)
    return found


def _of_same_messages(recorded: Flags) -> Iterator[list[int]]:
    """Yield joints whose states are in the same messages, together; recorded: (n, k)."""
    found: dict[bytes, list[int]] = {}
    for joint, column in enumerate(recorded.T):
        if column.any():
            found.setdefault(column.tobytes(), []).append(joint)
    yield from found.values()


def _messages(topic: str, rows: Ints, log_time: Ints, stamp: Ints, clock: TimeSource) -> _Messages:
    """Choose the messages that are used.

    Args:
        topic: their topic.
        rows: (m,) their rows among all of the topic.
        log_time: (m,) ns.
        stamp: (m,) ns.
        clock: which time counts.
    """
    on_stamps = clock is TimeSource.HEADER
    time = stamp if on_stamps else log_time
    known = check_stamps(topic, stamp, log_time).usable if on_stamps else np.ones_like(time, bool)
    good = known.copy()
    good[good] = advancing(time[good], None)
    time = time[good]
    step_s = np.diff(time) / 1e9
    step_s[step_s > LONGEST_STEP_S] = np.nan
    kept = np.flatnonzero(_chosen(time, np.isnan(step_s)))
    return _Messages(
        number=len(rows),
        not_advancing=int((known & ~good).sum()),
        rows=rows[good],
        time=time,
        step_s=step_s,
        kept=kept,
        kept_time=time[kept],
    )


def _chosen(time: Ints, silent: Flags) -> Flags:
    """(n,) rows to keep.

    Args:
        time: (n,) ns.
        silent: (n - 1,) whether a silence lies between two rows.
    """
    chosen = first_at_each_tick(time, JOINT_RATE_HZ, None)
    chosen[-1:] = True
    chosen[1:] |= silent
    chosen[:-1] |= silent
    return chosen


def _plausible(values: Floats) -> Floats:
    """Return values with NaN for those that no joint reaches."""
    return np.where(np.abs(values) <= _IMPLAUSIBLE, values, np.nan)


def _unwrapped(position: Floats) -> Floats:
    """Return positions, (n,), that go on where a continuous joint's wrap at +-pi."""
    step = np.diff(position, prepend=position[:1])
    wraps = (np.abs(step) > LEAST_WRAP) & (np.abs(step) <= _TURN)
    if not wraps.any():
        return position
    turned: Floats = position + np.cumsum(np.where(wraps, -np.sign(step) * _TURN, 0.0))
    return turned


def _history(
    name: str,
    messages: _Messages,
    position: Floats,
    velocity: Floats,
    effort: Floats,
    limits: JointLimits,
) -> JointHistory:
    """Measure a joint.

    Power is effort times velocity, by the trapezoidal rule. Without velocities, or with none but
    zeros, work is the mean effort times the step between two positions.

    Args:
        name: of the joint.
        messages: with its states, n usable ones.
        position: (n,) rad or m.
        velocity: (n,) rad/s or m/s; NaN: not recorded.
        effort: (n,) N m or N; NaN: not recorded.
        limits: of the joint.
    """
    step_s, way = messages.step_s, np.diff(position)
    velocity_told = bool((np.isfinite(velocity) & (velocity != 0.0)).any())
    if velocity_told:
        power = effort * velocity
        positive = _middles(np.maximum(power, 0.0)) * step_s
        absolute = _middles(np.abs(power)) * step_s
        speed = np.abs(velocity[1:])
    else:
        work = _middles(effort) * way + 0.0 * step_s
        positive, absolute = work.clip(0.0), np.abs(work)
        speed = np.abs(way / step_s)
    middle, squared = _middles(velocity), _middles(effort**2) * step_s
    near = _near_limit(limits, position[1:], effort[1:], speed)
    return JointHistory(
        name=name,
        messages=messages.number,
        not_advancing=messages.not_advancing,
        start=int(messages.time[0]),
        end=int(messages.time[-1]),
        known_s=float(np.nansum(step_s)),
        lowest=float(position.min()),
        highest=float(position.max()),
        velocity_told=velocity_told,
        peak_speed=float(np.fmax.reduce(speed, initial=0.0)),
        lowest_effort=float(np.fmin.reduce(effort)),
        highest_effort=float(np.fmax.reduce(effort)),
        squared_effort=float(np.nansum(squared)),
        effort_s=float(step_s[np.isfinite(squared)].sum()),
        absolute_work_j=float(np.nansum(absolute)),
        near_limit_s=float(np.nansum(step_s[near])),
        has_limits=limits != JointLimits(),
        told_moved=float(np.nansum(middle * way + 0.0 * step_s)),
        told_squared=float(np.nansum(middle**2 * step_s)),
        track=_track(messages, position, (positive, absolute)),
    )


def _near_limit(limits: JointLimits, position: Floats, effort: Floats, speed: Floats) -> Flags:
    """(n,) which rows are near a limit that is known."""
    margin = NEAR_LIMIT * (limits.upper - limits.lower)
    margin = margin if np.isfinite(margin) else 0.0
    near: Flags = (position < limits.lower + margin) | (position > limits.upper - margin)
    near |= np.abs(effort) > NEAR_FULL * limits.effort
    near |= speed > NEAR_FULL * limits.velocity
    return near


def _track(messages: _Messages, position: Floats, works: tuple[Floats, Floats]) -> JointTrack:
    """Return the motion of a joint at a low rate, from its first motion on.

    Args:
        messages: n of them.
        position: (n,)
        works: (n - 1,) J each, positive and absolute work from each row to the next.
    """
    moving = np.flatnonzero(position != position[0])
    if not len(moving):
        empty = np.empty(0, np.float32)
        return JointTrack(messages.time[:0], empty, empty, empty)
    # It begins with the last row that is kept before the first motion.
    first = int(np.searchsorted(messages.kept, moving[0])) - 1
    kept = messages.kept[first:]
    done = (np.append(0.0, np.add.reduceat(work, kept[:-1])) for work in works)
    columns = (each.astype(np.float32) for each in (position[kept], *done))
    return JointTrack(messages.kept_time[first:], *columns)


def _middles(values: Floats) -> Floats:
    middles: Floats = (values[1:] + values[:-1]) / 2.0
    return middles
