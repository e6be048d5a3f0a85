"""The poses of the base in a log."""

from dataclasses import replace
from typing import Final

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Floats, Ints
from dogbot_logtool.core.base.odometry import Odometry, usable_poses
from dogbot_logtool.core.corrections.clock import (
    TimeSource,
    advancing,
    first_at_each_tick,
)
from dogbot_logtool.core.quality.quality import steady_gap_ns
from dogbot_logtool.core.rotations import (
    from_roll_pitch_yaw,
    normalised,
    roll_pitch_yaw,
    rotate,
)
from dogbot_logtool.dataclass import dataclass

POSE_RATE_HZ: Final = 100.0
"""Interpolation between poses 10 ms apart misses 0.1 mm at 10 m/s^2; an hour of them is 20 MB."""
LOOKUP_S: Final = 0.1
"""A pose further from a time than this does not tell where the base was."""


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


def base_history(odometry: Odometry, clock: TimeSource, breaks: Ints | None = None) -> BaseHistory:
    """Return the poses of a log.

    Args:
        odometry: in the order of the log.
        clock: which time counts; on header stamps zeros are unknown times.
        breaks: (b, 2) ns, spans that nothing is measured across, as if they were gaps.
    """
    time = clock.of(odometry)
    usable = usable_poses(odometry)
    good = usable & ((time != 0) | (clock is TimeSource.LOG))
    good[good] = advancing(time[good], None)
    longest = steady_gap_ns(np.diff(time[good]))
    rows = np.flatnonzero(good)
    kept = odometry.pick(rows[first_at_each_tick(time[rows], POSE_RATE_HZ, None)])
    time = clock.of(kept)
    angles = roll_pitch_yaw(normalised(kept.orientation))
    angles[:, 2] = np.unwrap(angles[:, 2])
    return BaseHistory(
        messages=len(usable),
        not_usable=int((~usable).sum()),
        not_advancing=int((usable & ~good).sum()),
        time=time,
        position=kept.position,
        angles=angles,
        gaps=_gaps(time, longest, timespans.no_spans() if breaks is None else breaks),
    )


def _gaps(time: Ints, longest_ns: float, breaks: Ints) -> Ints:
    """(g, 2) ns, steps that are longer than usual or touch a break."""
    broken = np.diff(time) > longest_ns
    broken |= timespans.touches(breaks, time[:-1], time[1:])
    rows = np.flatnonzero(broken)
    return np.stack([time[rows], time[rows + 1]], axis=1)
