"""Joints while their states stream past: what motors do, and motion at a low rate.

Work and torque are integrated over every message. Positions, efforts and the work done in between
are kept at `JOINT_RATE_HZ` from a joint's first motion on: 16 bytes a row and joint, 6 MB an hour,
and 8 bytes more for all joints together. This grows with the log, since only its end tells which
strides count.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from copy import copy
from dataclasses import replace
from typing import Any, Final

import numpy as np

from dogbot_logtool.core.geometry.arrays import Flags, Floats, Ints
from dogbot_logtool.core.geometry.blocks import Blocks, concatenated
from dogbot_logtool.core.geometry.clock import TimeSource, advancing, first_at_each_tick
from dogbot_logtool.core.geometry.order_statistics import distinct
from dogbot_logtool.core.legs.joint_track import (
    JointHistory,
    JointLimits,
    JointSamples,
    KeptStates,
)
from dogbot_logtool.core.legs.silences import LONGEST_STEP_S
from dogbot_logtool.core.quality.stamps import StampFilter

JOINT_RATE_HZ: Final = 100.0
NEAR_LIMIT: Final = 0.02
"""Share of a joint's range: closer to an end than this is near a limit."""
NEAR_FULL: Final = 0.95
"""Share of the highest effort or speed by the robot description: more is near a limit."""
LEAST_WRAP: Final = 1.5 * np.pi
"""rad between two messages: no joint is so fast, so it wraps, if it is no more than a turn."""
_TURN: Final = 2.0 * np.pi
_BLOCK_ROWS: Final = 4096
_AT_ONCE: Final = 4
"""Joints that are computed at once: of more, the matrices do not fit in a processor's cache."""


class JointRecorder:
    """Makes a `JointHistory` of each of k joints whose states are told together.

    Arrays among its attributes have the joints along their last axis.
    """

    def __init__(
        self, names: Sequence[str], topic: str, clock: TimeSource, limits: Sequence[JointLimits]
    ) -> None:
        count = len(names)
        self.names, self._topic, self._clock = tuple(names), topic, clock
        self._stamps: StampFilter[JointSamples] = StampFilter(topic, clock)
        self._blocks: Blocks[JointSamples] = Blocks(_BLOCK_ROWS)
        self._last: JointSamples | None = None
        self._last_is_kept = False
        self._start = self._end = 0
        self._messages = self._not_advancing = 0
        self._number = np.arange(count)
        self._limits = _thresholds(limits)
        self._has_limits = np.array([each != JointLimits() for each in limits])
        self._lowest, self._highest = np.full(count, np.inf), np.full(count, -np.inf)
        self._lowest_effort, self._highest_effort = np.full((2, count), np.nan)
        self._told = np.zeros(count, np.bool_)
        self._peak_speed = np.zeros(count)
        self._sums = np.zeros((len(_SUMS), count))
        self._pending = np.zeros((2, count))
        """J, positive and absolute work since the last row that was kept."""
        self._turned = np.zeros(count)
        """rad, whole turns by which positions wrapped so far."""
        self._moved = np.zeros(count, np.bool_)
        self._kept: list[KeptStates] = []

    def apart(self, messages: Mapping[str, bytes]) -> "list[JointRecorder]":
        """Return recorders of the joints that the next messages still tell together.

        Args:
            messages: which of them tell of a joint, by its name.
        """
        parts = list(told_alike(self.names, messages))
        return [self] if len(parts) == 1 else [self._only(np.array(joints)) for joints in parts]

    def add(self, samples: JointSamples) -> None:
        """Take in states, in the order of the log; all have positions."""
        for checked in self._stamps.add(samples):
            for block in self._blocks.add(checked):
                self._add_block(block)

    def finish(self) -> Iterator[JointHistory]:
        """End the log; yield nothing where no state could be used."""
        for checked in self._stamps.finish():
            for block in self._blocks.add(checked):
                self._add_block(block)
        for block in self._blocks.rest():
            self._add_block(block)
        if self._last is None:
            return
        if self._moved.any() and not self._last_is_kept:
            last = self._last.position.T, self._last.effort.T, self._pending[:, :, None]
            kept = np.zeros(1, np.int64), self._clock.of(self._last)
            which = np.flatnonzero(self._moved)
            self._keep(which, kept, _of_joints(last, self._moved, 0))
        all_kept = tuple(self._kept)
        for joint, name in enumerate(self.names):
            sums = dict(zip(_SUMS, self._sums[:, joint].tolist(), strict=True))
            yield JointHistory(
                name=name,
                topic=self._topic,
                messages=self._messages,
                not_advancing=self._not_advancing,
                start=self._start,
                end=self._end,
                lowest=float(self._lowest[joint]),
                highest=float(self._highest[joint]),
                velocity_told=bool(self._told[joint]),
                peak_speed=float(self._peak_speed[joint]),
                lowest_effort=float(self._lowest_effort[joint]),
                highest_effort=float(self._highest_effort[joint]),
                has_limits=bool(self._has_limits[joint]),
                number=int(self._number[joint]),
                kept=all_kept,
                **sums,
            )

    def _only(self, joints: Ints) -> "JointRecorder":
        """Return a recorder of some of the joints, with what is kept of them so far."""
        part = copy(self)
        own: dict[str, Any] = {
            name: value[..., joints]
            for name, value in vars(self).items()
            if isinstance(value, np.ndarray)
        }
        own["names"] = tuple(self.names[joint] for joint in joints)
        own["_stamps"] = self._stamps.changed(lambda samples: samples.only(joints))
        own["_blocks"] = self._blocks.changed(lambda samples: samples.only(joints))
        own["_last"] = self._last and self._last.only(joints)
        own["_kept"] = list(self._kept)
        vars(part).update(own)
        return part

    def _add_block(self, samples: JointSamples) -> None:
        self._messages += len(samples.log_time)
        samples = self._advancing(samples)
        if not len(samples.log_time):
            return
        if self._last is None:
            self._start = int(self._clock.of(samples)[0])
        samples = self._unwrapped(samples)
        if self._last is not None:
            samples = concatenated([self._last, samples])
        time = self._clock.of(samples)
        step_s = np.diff(time) / 1e9
        step_s[step_s > LONGEST_STEP_S] = np.nan
        chosen = self._chosen(time, np.isnan(step_s))
        rows = np.flatnonzero(chosen)
        kept = rows, time[rows]
        for first in range(0, len(self.names), _AT_ONCE):
            joints = slice(first, first + _AT_ONCE)
            position, velocity, effort = (
                np.ascontiguousarray(each[:, joints].T)
                for each in (samples.position, samples.velocity, samples.effort)
            )
            work = self._integrate(joints, step_s, position, velocity, effort)
            self._track(joints, time, kept, (position, effort, work))
        self._end = int(time[-1])
        self._last = samples.pick(np.array([len(time) - 1]))
        self._last_is_kept = bool(chosen[-1])

    def _advancing(self, samples: JointSamples) -> JointSamples:
        """Return the rows with a time later than all before."""
        time = self._clock.of(samples)
        known = (time != 0) | (self._clock is TimeSource.LOG)
        usable = known.copy()
        usable[known] = advancing(time[known], None if self._last is None else self._end)
        self._not_advancing += int((known & ~usable).sum())
        return samples if usable.all() else samples.pick(usable)

    def _unwrapped(self, samples: JointSamples) -> JointSamples:
        """Return states with positions that go on where a continuous joint's wrap at +-pi."""
        position = samples.position + self._turned
        before = position[:1] if self._last is None else self._last.position
        step = np.diff(position, axis=0, prepend=before)
        wraps = (np.abs(step) > LEAST_WRAP) & (np.abs(step) <= _TURN)
        if not wraps.any():
            return replace(samples, position=position) if self._turned.any() else samples
        turned = np.cumsum(np.where(wraps, -np.sign(step) * _TURN, 0.0), axis=0)
        self._turned = self._turned + turned[-1]
        return replace(samples, position=position + turned)

    def _chosen(self, time: Ints, silent: Flags) -> Flags:
        """(n,) rows to keep: the first at each tick, and both sides of a silence.

        Args:
            time: (n,) ns; the first row is the last one of the block before.
            silent: (n - 1,) whether a silence lies between two rows.
        """
        chosen = first_at_each_tick(time, JOINT_RATE_HZ, None)
        chosen[1:] |= silent
        chosen[:-1] |= silent
        chosen[0] = bool(silent[:1].any()) and not self._last_is_kept
        return chosen

    def _integrate(
        self, joints: slice, step_s: Floats, position: Floats, velocity: Floats, effort: Floats
    ) -> Floats:
        """Add up what happens between rows.

        Power is effort times velocity, by the trapezoidal rule. Where messages tell no velocities,
        or none but zeros so far, work is the mean effort times the way between two positions.

        Args:
            joints: which k of them.
            step_s: (n - 1,) s, NaN for silences.
            position: (k, n) rad or m.
            velocity: (k, n) rad/s or m/s; NaN: not told.
            effort: (k, n) N m or N; NaN: not told.

        Returns:
            (2, k, n) J, positive and absolute work since the row before; the first row's is what
            is pending.
        """
        way = np.diff(position)
        power = effort * velocity
        positive = _trapezoids(np.maximum(power, 0.0), step_s)
        absolute = _trapezoids(np.abs(power), step_s)
        speed = np.abs(velocity[:, 1:])
        was_told = self._told[joints]
        if not was_told.all():
            told = np.isfinite(velocity) & (velocity != 0.0)
            told = np.logical_or.accumulate(told, axis=1) | was_told[:, None]
            by_way = _middles(effort) * way + 0.0 * step_s
            use = told[:, :-1]
            positive = np.where(use, positive, by_way.clip(0.0))
            absolute = np.where(use, absolute, np.abs(by_way))
            speed = np.where(use, speed, np.abs(way / step_s))
            # Differences that were taken so far are of a joint at rest.
            self._peak_speed[joints][told[:, -1] & ~was_told] = 0.0
            self._told[joints] = told[:, -1]
        self._note_ranges(joints, position, effort, speed)
        middle, squared = _middles(velocity), _trapezoids(effort**2, step_s)
        known = np.isfinite(squared)
        sums = {
            "known_s": step_s,
            "effort_s": step_s if known.all() else np.where(known, step_s, np.nan),
            "squared_effort": squared,
            "positive_work_j": positive,
            "absolute_work_j": absolute,
            "told_moved": middle * way + 0.0 * step_s,
            "told_squared": middle**2 * step_s,
        }
        if self._has_limits[joints].any():
            near = self._near_limit(joints, position, effort, speed)
            sums["near_limit_s"] = np.where(near, step_s, 0.0)
        for name, values in sums.items():
            self._sums[_SUMS.index(name), joints] += _total(values)
        pending = self._pending[:, joints, None]
        return np.concatenate([pending, np.stack([positive, absolute])], axis=2)

    def _note_ranges(self, joints: slice, position: Floats, effort: Floats, speed: Floats) -> None:
        """Note the ends of what k joints reach; (k, n) each."""
        for ends, least, values in (
            (self._lowest, np.fmin, position),
            (self._highest, np.fmax, position),
            (self._lowest_effort, np.fmin, effort),
            (self._highest_effort, np.fmax, effort),
            (self._peak_speed, np.fmax, speed),
        ):
            if values.shape[1]:
                ends[joints] = least(ends[joints], least.reduce(values, axis=1))

    def _near_limit(self, joints: slice, position: Floats, effort: Floats, speed: Floats) -> Flags:
        """(k, n - 1) which rows but the first are near a limit that is known."""
        lower, upper, most_effort, most_speed = self._limits[:, joints, None]
        near: Flags = (position[:, 1:] < lower) | (position[:, 1:] > upper)
        near |= (np.abs(effort[:, 1:]) > most_effort) | (speed > most_speed)
        return near

    def _track(
        self,
        joints: slice,
        time: Ints,
        kept: tuple[Ints, Ints],
        states: tuple[Floats, Floats, Floats],
    ) -> None:
        """Keep rows at a low rate, from the first motion of each joint on.

        Args:
            joints: which k of them.
            time: (n,) ns.
            kept: rows to keep of joints that move, and their times, ns.
            states: positions and efforts, (k, n), and work, (2, k, n).
        """
        moved, number = self._moved[joints].copy(), np.arange(len(self.names))[joints]
        if moved.any():
            which = slice(None) if moved.all() else moved
            self._keep(number[which], kept, _of_joints(states, which, 0))
        if moved.all():
            return
        position = states[0]
        moves = position != position[:, :1]
        begins = ~moved & moves.any(axis=1)
        # The row before the first motion is the first that is kept.
        start = moves.argmax(axis=1) - 1
        rows, times = kept
        for row in distinct(start[begins]).tolist():
            which = begins & (start == row)
            later = rows > row
            own = np.append(0, rows[later] - row), np.append(time[row], times[later])
            began = _of_joints(states, which, row)
            began[2][:, :, 0] = 0.0
            self._keep(number[which], own, began)
        self._moved[joints] |= begins

    def _keep(
        self, joints: Ints, kept: tuple[Ints, Ints], states: tuple[Floats, Floats, Floats]
    ) -> None:
        """Keep rows of j joints that move, with the work since the one before.

        Args:
            joints: which.
            kept: rows, and their times, ns.
            states: positions and efforts, (j, n), and work, (2, j, n).
        """
        (rows, time), (position, effort, work) = kept, states
        starts = np.append(0, rows + 1)
        since = np.add.reduceat(work, starts[starts < work.shape[2]], axis=2)
        rest = since[:, :, len(rows) :]
        self._pending[:, joints] = rest[:, :, 0] if rest.size else 0.0
        if len(rows):
            values = np.empty((4, len(joints), len(rows)), np.float32)
            values[0], values[1] = position[:, rows], effort[:, rows]
            values[2:] = since[:, :, : len(rows)]
            self._kept.append(KeptStates(self._number[joints], time, values))


_SUMS: Final = (
    "known_s",
    "effort_s",
    "squared_effort",
    "positive_work_j",
    "absolute_work_j",
    "near_limit_s",
    "told_moved",
    "told_squared",
)
"""Fields of `JointHistory` that are added up."""


def _thresholds(limits: Sequence[JointLimits]) -> Floats:
    """(4, k) position below and above, effort and speed above which a joint is near a limit."""
    lower, upper, effort, speed = np.array(
        [(each.lower, each.upper, each.effort, each.velocity) for each in limits]
    ).T
    margin = NEAR_LIMIT * (upper - lower)
    margin = np.where(np.isfinite(margin), margin, 0.0)
    return np.stack([lower + margin, upper - margin, NEAR_FULL * effort, NEAR_FULL * speed])


def told_alike(names: Sequence[str], messages: Mapping[str, bytes]) -> Iterable[list[int]]:
    """Return the numbers of joints that the same messages tell of, together."""
    found: dict[bytes, list[int]] = {}
    for number, name in enumerate(names):
        found.setdefault(messages.get(name, b""), []).append(number)
    return found.values()


def _middles(values: Floats) -> Floats:
    middles: Floats = (values[:, 1:] + values[:, :-1]) / 2.0
    return middles


def _trapezoids(values: Floats, step_s: Floats) -> Floats:
    areas: Floats = _middles(values) * step_s
    return areas


def _total(values: Floats) -> Floats:
    """Add up along the last axis what is not NaN."""
    total: Floats = values.sum(axis=-1)
    return np.asarray(np.nansum(values, axis=-1)) if np.isnan(total).any() else total


def _of_joints(
    states: tuple[Floats, Floats, Floats], joints: Flags | slice, start: int
) -> tuple[Floats, Floats, Floats]:
    """Return the states of some joints from a row on."""
    position, effort, work = states
    return position[joints, start:], effort[joints, start:], work[:, joints, start:]
