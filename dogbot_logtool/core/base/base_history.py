"""The base's poses that are kept while the odometry streams past."""

from dataclasses import replace
from typing import Final

import numpy as np

from dogbot_logtool.core.base.odometry import Odometry, usable_poses
from dogbot_logtool.core.geometry import timespans
from dogbot_logtool.core.geometry.aggregates import IntervalHistogram
from dogbot_logtool.core.geometry.arrays import Floats, Ints, all_finite
from dogbot_logtool.core.geometry.blocks import BLOCK_ROWS, Blocks, GrowingTable, concatenated
from dogbot_logtool.core.geometry.clock import (
    SILENCE_NS,
    TimeSource,
    absolute_time,
    advancing,
    first_at_each_tick,
)
from dogbot_logtool.core.geometry.rotations import (
    from_roll_pitch_yaw,
    normalised,
    roll_pitch_yaw,
    rotate,
)
from dogbot_logtool.core.quality.quality import steady_rhythm
from dogbot_logtool.dataclass import dataclass

POSE_RATE_HZ: Final = 100.0
"""A day at this rate is half a gigabyte."""
LOOKUP_S: Final = 0.1
"""A pose further from a time than this does not tell where the base was."""


@dataclass(frozen=True, slots=True)
class TwistFit:
    """How well recorded linear velocities fit the poses' derivative, in either frame.

    With w the recorded velocity taken as world frame, b the same taken as body frame and turned
    into the world, and d the displacement rate, the sums are over pairs of neighbouring poses.
    """

    pairs: int = 0
    difference: float = 0.0
    """(m/s)^2, sum of |w - b|^2: how much the frames differ at all."""
    leaning: float = 0.0
    """(m/s)^2, sum of (w - b).(d - (w + b) / 2): positive when d is nearer to w."""


@dataclass(frozen=True, slots=True)
class BaseHistory:
    """Poses of the base at up to 100 Hz."""

    messages: int
    not_usable: int
    """Messages with a number that is not finite or a zero quaternion; left out."""
    not_advancing: int
    """Messages that repeat a time or step back; left out."""
    time: Ints
    """(n,) ns, strictly increasing."""
    position: Floats
    """(n, 3) m, world frame."""
    angles: Floats
    """(n, 3) rad, roll, pitch, yaw; yaw unwrapped."""
    gaps: Ints
    """(g, 2) ns, silences: last pose before, first one after."""
    twist: TwistFit

    @property
    def known(self) -> Ints:
        """(k, 2) ns, the time between first and last pose without the gaps."""
        if len(self.time) == 0:
            return timespans.no_spans()
        return timespans.subtract(self.time[[0, -1]][None, :], self.gaps)

    def without_poses(self) -> "BaseHistory":
        """Return the history of poses of which none can be used."""
        none = np.empty((0, 3))
        return replace(self, time=self.time[:0], position=none, angles=none, gaps=self.gaps[:0])

    def position_at(self, time: Ints) -> Floats:
        """Interpolate the position linearly between poses.

        Args:
            time: (n,) ns.

        Returns:
            (n, 3) m, NaN in gaps, and before and after the poses.
        """
        return self._interpolated(time, self.position)

    def point_at(self, time: Ints, in_body_m: Floats) -> Floats:
        """Return where a point of the body is; (n, 3) m, NaN like `position_at`.

        Args:
            time: (n,) ns.
            in_body_m: (3,) m, from the base's frame, in its axes.
        """
        position = self.position_at(time)
        if not in_body_m.any():
            return position
        turn = from_roll_pitch_yaw(self.angles_at(time))
        return position + rotate(turn, np.broadcast_to(in_body_m, position.shape))

    def angles_at(self, time: Ints) -> Floats:
        """Interpolate roll, pitch and unwrapped yaw; (n, 3) rad, NaN like `position_at`."""
        return self._interpolated(time, self.angles)

    def _interpolated(self, time: Ints, values: Floats) -> Floats:
        if len(self.time) == 0:
            return np.full((len(time), 3), np.nan)
        last = len(self.time) - 1
        after = np.minimum(np.searchsorted(self.time, time), last)
        before = np.where(self.time[after] > time, np.maximum(after - 1, 0), after)
        since, step = time - self.time[before], self.time[after] - self.time[before]
        share = np.clip(since / np.maximum(step, 1), 0.0, 1.0)[:, None]
        # `take` picks rows of vectors four times as fast as an index does.
        first = values.take(before, axis=0)
        at: Floats = first + share * (values.take(after, axis=0) - first)
        # Both poses around a time must be near; beyond the ends there is only one.
        away = np.maximum(np.abs(since), np.abs(self.time[after] - time))
        at[away > LOOKUP_S * 1e9] = np.nan
        return at

    def unplaced(self, spans: Ints) -> int:
        """Return the time in spans, ns, that lies further than 0.1 s from every pose."""
        reach = round(LOOKUP_S * 1e9)
        if len(self.time) == 0:
            return timespans.total(spans)
        edges = np.concatenate([self.time[:1], self.gaps.ravel(), self.time[-1:]]).reshape(-1, 2)
        placed = timespans.merge(edges + np.array([-reach, reach]))
        return timespans.total(timespans.subtract(spans, placed))


class BaseRecorder:
    """Makes a `BaseHistory` of odometry, fed batch by batch; the same however it is split."""

    def __init__(self, clock: TimeSource, *, block_rows: int = BLOCK_ROWS) -> None:
        self._clock = clock
        self._blocks: Blocks[Odometry] = Blocks(block_rows)
        self._intervals = IntervalHistogram()
        self._poses = GrowingTable(7)
        self._origin: int | None = None
        self._end: int | None = None
        self._messages = self._not_usable = self._not_advancing = 0
        self._last: Odometry | None = None
        self._yaw = np.empty(0)
        self._twist = TwistFit()

    def add(self, odometry: Odometry) -> None:
        """Take in messages, in the order of the log."""
        for block in self._blocks.add(odometry):
            self._add_block(block)

    def finish(self, breaks: Ints | None = None) -> BaseHistory:
        """End the log.

        Args:
            breaks: (b, 2) ns, spans that nothing is measured across, as if they were gaps.
        """
        for block in self._blocks.rest():
            self._add_block(block)
        table = self._poses.stacked()
        time = absolute_time(table[:, 0], self._origin)
        broken = np.diff(time) > steady_rhythm(self._intervals).gap_ns
        if breaks is not None and len(time):
            broken |= timespans.touches(breaks, time[:-1], time[1:])
        rows = np.flatnonzero(broken)
        return BaseHistory(
            messages=self._messages,
            not_usable=self._not_usable,
            not_advancing=self._not_advancing,
            time=time,
            position=table[:, 1:4],
            angles=table[:, 4:],
            gaps=np.stack([time[rows], time[rows + 1]], axis=1),
            twist=self._twist,
        )

    def _add_block(self, odometry: Odometry) -> None:
        time = self._clock.of(odometry)
        usable = usable_poses(odometry)
        self._messages += len(time)
        self._not_usable += int((~usable).sum())
        good = usable & ((time != 0) | (self._clock is TimeSource.LOG))
        good[good] = advancing(time[good], self._end)
        self._not_advancing += int((usable & ~good).sum())
        odometry, time = odometry.pick(good), time[good]
        if len(time) == 0:
            return

        first = time[:1] if self._end is None else np.array([self._end])
        self._intervals.add(np.diff(time, prepend=first))
        chosen = first_at_each_tick(time, POSE_RATE_HZ, self._end)
        self._end = int(time[-1])
        self._keep(odometry.pick(chosen), time[chosen])

    def _keep(self, odometry: Odometry, time: Ints) -> None:
        """Keep poses; compare the twist with their derivative."""
        if len(time) == 0:
            return
        if self._origin is None:
            self._origin = int(time[0])
        since = (time - self._origin).astype(np.float64)
        angles = roll_pitch_yaw(normalised(odometry.orientation))
        angles[:, 2] = np.unwrap(np.concatenate([self._yaw, angles[:, 2]]))[len(self._yaw) :]
        self._yaw = angles[-1:, 2].copy()
        self._poses.append(np.column_stack([since, odometry.position, angles]))
        self._fit_twist(odometry)
        self._last = odometry.pick(np.array([len(time) - 1]))

    def _fit_twist(self, odometry: Odometry) -> None:
        if self._last is not None:
            odometry = concatenated([self._last, odometry])
        fit = twist_fit(odometry, self._clock)
        self._twist = TwistFit(
            self._twist.pairs + fit.pairs,
            self._twist.difference + fit.difference,
            self._twist.leaning + fit.leaning,
        )


def twist_fit(odometry: Odometry, clock: TimeSource) -> TwistFit:
    """Compare recorded velocities with the derivative of the poses, pair by pair.

    Velocities are averaged over the ends of each pair, in either reading, so that they stand for
    its middle, as the displacement rate does. Noise on the poses averages out.

    Args:
        odometry: usable poses at strictly increasing times.
        clock: which time counts.
    """
    time = clock.of(odometry)
    step = np.diff(time) / 1e9
    recorded = odometry.linear_velocity
    world = np.where(np.isfinite(recorded), recorded, np.nan)
    body = rotate(normalised(odometry.orientation), world)
    world, body = (world[1:] + world[:-1]) / 2.0, (body[1:] + body[:-1]) / 2.0
    rate = np.diff(odometry.position, axis=0) / step[:, None]
    usable = (step * 1e9 <= SILENCE_NS) & all_finite(world)
    apart = (world - body)[usable]
    middle = (rate - (world + body) / 2.0)[usable]
    return TwistFit(int(usable.sum()), float((apart * apart).sum()), float((apart * middle).sum()))
