"""One joint while its states stream past: what its motor does, and its motion at a low rate.

Work and torque are integrated over every message. Positions, efforts and the work done in between
are kept at `JOINT_RATE_HZ` from the first motion on: 24 bytes a row, 9 MB a joint and hour.
"""

from typing import Final

import numpy as np

from dogbot_logtool.core.geometry.arrays import Flags, Float32s, Floats, Ints
from dogbot_logtool.core.geometry.blocks import Blocks
from dogbot_logtool.core.geometry.clock import TimeSource, advancing, first_at_each_tick
from dogbot_logtool.core.quality.stamps import StampFilter
from dogbot_logtool.dataclass import dataclass

JOINT_RATE_HZ: Final = 100.0
MOST_JOINTS: Final = 256
"""Joints of a robot that are followed; no robot with legs has more."""
LONGEST_STEP_S: Final = 0.1
"""Joint states further apart are not joined: it is not known what the joint did between."""
NEAR_LIMIT: Final = 0.02
"""Of a joint's range: closer to an end than this is near a limit."""
NEAR_FULL: Final = 0.95
"""Of the highest effort or speed that the robot description allows: more is near a limit."""
_BLOCK_ROWS: Final = 4096
_IMPLAUSIBLE: Final = 1e9
"""rad, rad/s and N m: no joint reaches it."""


@dataclass(frozen=True, slots=True)
class JointLimits:
    """What a robot description allows a joint; infinite where it says nothing."""

    lower: float = -np.inf
    """rad or m; also `upper`."""
    upper: float = np.inf
    effort: float = np.inf
    """N m or N."""
    velocity: float = np.inf
    """rad/s or m/s."""


@dataclass(frozen=True, slots=True)
class JointSamples:
    """States of one joint, one row a message."""

    log_time: Ints
    """(n,) ns."""
    stamp: Ints
    """(n,) ns."""
    position: Floats
    """(n,) rad or m; also `velocity`, rad/s or m/s, and `effort`, N m or N; NaN: not told."""
    velocity: Floats
    effort: Floats

    def pick(self, rows: Ints | Flags) -> "JointSamples":
        """Return copies of some rows."""
        return JointSamples(
            self.log_time[rows],
            self.stamp[rows],
            self.position[rows],
            self.velocity[rows],
            self.effort[rows],
        )


@dataclass(frozen=True, slots=True)
class JointTable:
    """What n messages of a topic say of k joints, in the order of the log; NaN: nothing."""

    topic: str
    names: tuple[str, ...]
    log_time: Ints
    """(n,) ns."""
    stamp: Ints
    """(n,) ns; the log time of messages without a stamp."""
    position: Floats
    """(n, k) rad or m; also `velocity`, rad/s or m/s, and `effort`, N m or N."""
    velocity: Floats
    effort: Floats

    def joint(self, column: int) -> JointSamples:
        """Return the states of one joint."""
        told = np.isfinite(self.position[:, column])
        rows: Flags | slice = slice(None) if told.all() else told
        values = (each[rows, column] for each in (self.position, self.velocity, self.effort))
        return JointSamples(self.log_time[rows], self.stamp[rows], *values)


@dataclass(frozen=True, slots=True)
class JointTrack:
    """A joint's motion at a low rate, (n,) each; no rows of a joint that never moves."""

    time: Ints
    """ns, strictly increasing."""
    position: Float32s
    """rad or m."""
    effort: Float32s
    """N m or N; NaN where not told."""
    positive_work: Float32s
    """J since the row before; NaN where a silence or an unknown effort lies between."""
    absolute_work: Float32s

    @property
    def broken(self) -> Flags:
        """(n,) whether a silence lies between a row and the one before."""
        broken = np.zeros(len(self.time), np.bool_)
        broken[1:] = np.diff(self.time) > LONGEST_STEP_S * 1e9
        return broken


@dataclass(frozen=True, slots=True)
class JointHistory:
    """All that is kept of a joint."""

    name: str
    topic: str
    messages: int
    not_advancing: int
    """Messages that repeat a time or step back; left out."""
    start: int
    """ns, first usable message; also `end`, the last one."""
    end: int
    known_s: float
    """s, without silences."""
    lowest: float
    """rad or m; also `highest`."""
    highest: float
    velocity_told: bool
    """Whether messages tell velocities that are not all zero; else positions are differenced."""
    peak_speed: float
    """rad/s or m/s, by the source that `velocity_told` says."""
    lowest_effort: float
    """N m or N; also `highest_effort`; NaN: no message tells one."""
    highest_effort: float
    squared_effort: float
    """(N m)^2 s, integral of the squared effort over `effort_s`, the time in which it is known."""
    effort_s: float
    positive_work_j: float
    """J, where effort and motion are known; also `absolute_work_j`."""
    absolute_work_j: float
    near_limit_s: float
    """s within `known_s`, of limits that are known."""
    has_limits: bool
    told_moved: float
    """Sum of v dq, with v the velocity that messages tell; also `told_squared`, of v^2 dt."""
    told_squared: float
    track: JointTrack

    @property
    def moves(self) -> bool:
        """Whether its position ever changes."""
        return self.highest > self.lowest

    @property
    def has_effort(self) -> bool:
        """Whether its effort is told and not constantly zero."""
        return bool(np.isfinite(self.lowest_effort)) and (
            self.lowest_effort != 0.0 or self.highest_effort != 0.0
        )

    @property
    def peak_effort(self) -> float:
        """N m or N, the largest magnitude; NaN: none is told."""
        return max(abs(self.lowest_effort), abs(self.highest_effort))


class JointRecorder:
    """Makes a `JointHistory` of one joint's states; the same however they are split."""

    def __init__(self, name: str, topic: str, clock: TimeSource, limits: JointLimits) -> None:
        self._name, self._topic, self._clock, self._limits = name, topic, clock, limits
        self._stamps: StampFilter[JointSamples] = StampFilter(topic, clock)
        self._blocks: Blocks[JointSamples] = Blocks(_BLOCK_ROWS)
        self._last: JointSamples | None = None
        self._last_is_kept = False
        self._start = self._end = 0
        self._messages = self._not_advancing = 0
        self._lowest, self._highest = np.inf, -np.inf
        self._lowest_effort, self._highest_effort = np.inf, -np.inf
        self._told = False
        self._peak_speed = 0.0
        self._sums = np.zeros(len(_SUMS))
        self._pending = np.zeros(2)
        """J, positive and absolute work since the last row that was kept."""
        self._moved = False
        self._kept: list[tuple[Ints, Float32s]] = []

    def add(self, samples: JointSamples) -> None:
        """Take in states, in the order of the log; those without a position are left out."""
        for checked in self._stamps.add(samples):
            for block in self._blocks.add(checked):
                self._add_block(block)

    def finish(self) -> JointHistory | None:
        """End the log; None where no state could be used."""
        for checked in self._stamps.finish():
            for block in self._blocks.add(checked):
                self._add_block(block)
        for block in self._blocks.rest():
            self._add_block(block)
        if self._last is None:
            return None
        if self._moved and not self._last_is_kept:
            self._keep(self._last, np.ones(1, np.bool_), self._pending[None, :])
        time = np.concatenate([np.empty(0, np.int64), *(time for time, _ in self._kept)])
        rows = np.concatenate([np.empty((0, 4), np.float32), *(rows for _, rows in self._kept)])
        sums = dict(zip(_SUMS, self._sums.tolist(), strict=True))
        told_effort = self._lowest_effort <= self._highest_effort
        return JointHistory(
            name=self._name,
            topic=self._topic,
            messages=self._messages,
            not_advancing=self._not_advancing,
            start=self._start,
            end=self._end,
            known_s=sums["known"],
            lowest=self._lowest,
            highest=self._highest,
            velocity_told=self._told,
            peak_speed=self._peak_speed,
            lowest_effort=self._lowest_effort if told_effort else np.nan,
            highest_effort=self._highest_effort if told_effort else np.nan,
            squared_effort=sums["squared_effort"],
            effort_s=sums["effort"],
            positive_work_j=sums["positive"],
            absolute_work_j=sums["absolute"],
            near_limit_s=sums["near_limit"],
            has_limits=self._limits != JointLimits(),
            told_moved=sums["told_moved"],
            told_squared=sums["told_squared"],
            track=JointTrack(time, *rows.T),
        )

    def _add_block(self, samples: JointSamples) -> None:
        self._messages += len(samples.log_time)
        samples = self._usable(samples)
        if not len(samples.log_time):
            return
        if self._last is None:
            self._start = int(self._clock.of(samples)[0])
        before, first = self._last, self._last is None
        joined = samples if before is None else _joined(before, samples)
        self._end = int(self._clock.of(samples)[-1])
        self._lowest = min(self._lowest, float(samples.position.min()))
        self._highest = max(self._highest, float(samples.position.max()))
        effort = samples.effort[np.isfinite(samples.effort)]
        self._lowest_effort = min(self._lowest_effort, float(effort.min(initial=np.inf)))
        self._highest_effort = max(self._highest_effort, float(effort.max(initial=-np.inf)))
        work = self._integrate(joined)
        self._track(joined, work, first=first)
        self._last = joined.pick(np.array([len(joined.log_time) - 1]))

    def _usable(self, samples: JointSamples) -> JointSamples:
        """Return the rows with a position and a time later than all before."""
        time = self._clock.of(samples)
        known = (np.abs(samples.position) <= _IMPLAUSIBLE) & (
            (time != 0) | (self._clock is TimeSource.LOG)
        )
        usable = known.copy()
        usable[known] = advancing(time[known], None if self._last is None else self._end)
        self._not_advancing += int((known & ~usable).sum())
        samples = samples if usable.all() else samples.pick(usable)
        velocity, effort = (
            np.where(np.abs(each) <= _IMPLAUSIBLE, each, np.nan)
            for each in (samples.velocity, samples.effort)
        )
        return JointSamples(samples.log_time, samples.stamp, samples.position, velocity, effort)

    def _integrate(self, joined: JointSamples) -> Floats:
        """Add up what happens between rows; (n, 2) J, positive and absolute work since the last.

        Power is effort times velocity, by the trapezoidal rule. Where messages tell no velocities,
        or none but zeros so far, work is the mean effort times the way between two positions.
        """
        step_s = np.diff(self._clock.of(joined)) / 1e9
        step_s = np.where(step_s <= LONGEST_STEP_S, step_s, np.nan)
        way = np.diff(joined.position)
        told = np.isfinite(joined.velocity) & (joined.velocity != 0.0)
        by_velocity = np.logical_or.accumulate(told) | self._told
        power = joined.effort * joined.velocity
        mean_effort = (joined.effort[1:] + joined.effort[:-1]) / 2.0
        by_way = mean_effort * way + 0.0 * step_s
        use = by_velocity[:-1]
        positive = np.where(use, _trapezoids(np.maximum(power, 0.0), step_s), by_way.clip(0.0))
        absolute = np.where(use, _trapezoids(np.abs(power), step_s), np.abs(by_way))
        speed = np.abs(np.where(use, joined.velocity[1:], way / step_s))
        if not self._told and by_velocity[-1]:
            # Differences that were taken so far are of a joint at rest.
            self._peak_speed = 0.0
        self._told |= bool(by_velocity[-1])
        self._peak_speed = max(self._peak_speed, float(np.nanmax(speed, initial=0.0)))
        squared = _trapezoids(joined.effort**2, step_s)
        middle = (joined.velocity[1:] + joined.velocity[:-1]) / 2.0
        sums = {
            "known": step_s,
            "effort": np.where(np.isfinite(squared), step_s, np.nan),
            "squared_effort": squared,
            "positive": positive,
            "absolute": absolute,
            "near_limit": np.where(self._near_limit(joined, speed), step_s, 0.0),
            "told_moved": middle * way + 0.0 * step_s,
            "told_squared": middle**2 * step_s,
        }
        for row, name in enumerate(_SUMS):
            self._sums[row] += float(np.nansum(sums[name]))
        return np.column_stack([positive, absolute])

    def _near_limit(self, joined: JointSamples, speed: Floats) -> Flags:
        """(n - 1,) which rows but the first are near a limit that is known."""
        limits = self._limits
        margin = NEAR_LIMIT * (limits.upper - limits.lower)
        margin = margin if np.isfinite(margin) else 0.0
        position, effort = joined.position[1:], joined.effort[1:]
        near: Flags = (position < limits.lower + margin) | (position > limits.upper - margin)
        near |= np.abs(effort) > NEAR_FULL * limits.effort
        return near | (speed > NEAR_FULL * limits.velocity)

    def _track(self, joined: JointSamples, work: Floats, *, first: bool) -> None:
        """Keep rows at a low rate, from the first motion on."""
        time = self._clock.of(joined)
        begin = 0 if first else 1
        if not self._moved:
            moved = np.flatnonzero(joined.position != joined.position[0])
            if not len(moved):
                return
            # The row before the first motion is the first that is kept.
            self._moved = True
            start = int(moved[0]) - 1
            joined, time, work = _rows_from(joined, start), time[start:], work[start:]
            self._pending, begin = np.zeros(2), 0
        chosen = first_at_each_tick(time, JOINT_RATE_HZ, None)
        chosen[0] = begin == 0
        # Both sides of a silence are kept.
        silent = np.diff(time) > LONGEST_STEP_S * 1e9
        chosen[1:] |= silent
        if begin and silent[:1].any() and not self._last_is_kept:
            self._keep(joined.pick(np.array([0])), np.ones(1, np.bool_), self._pending[None, :])
            self._pending = np.zeros(2)
        chosen[begin:-1] |= silent[begin:]
        total = np.concatenate([self._pending[None, :], work])
        rows = np.flatnonzero(chosen)
        self._last_is_kept = bool(chosen[-1])
        if not len(rows):
            self._pending = total.sum(axis=0)
            return
        # Rows of work up to each kept one; what follows the last is pending.
        ends = np.append(rows + 1, len(total))
        starts = np.concatenate([[0], ends[:-1]])
        parts = np.add.reduceat(
            np.concatenate([total, np.zeros((1, 2))]), np.stack([starts, ends], axis=1).ravel()
        )[::2]
        parts[ends == starts] = 0.0
        self._keep(joined, chosen, parts[:-1])
        self._pending = parts[-1]

    def _keep(self, joined: JointSamples, chosen: Flags, work: Floats) -> None:
        values = np.column_stack([joined.position[chosen], joined.effort[chosen], work])
        self._kept.append((self._clock.of(joined)[chosen], values.astype(np.float32)))


_SUMS: Final = (
    "known",
    "effort",
    "squared_effort",
    "positive",
    "absolute",
    "near_limit",
    "told_moved",
    "told_squared",
)


def _trapezoids(values: Floats, step_s: Floats) -> Floats:
    areas: Floats = (values[1:] + values[:-1]) / 2.0 * step_s
    return areas


def _joined(first: JointSamples, then: JointSamples) -> JointSamples:
    names = JointSamples.__dataclass_fields__
    return JointSamples(*(np.concatenate([getattr(first, n), getattr(then, n)]) for n in names))


def _rows_from(samples: JointSamples, start: int) -> JointSamples:
    return samples.pick(np.arange(start, len(samples.log_time)))
