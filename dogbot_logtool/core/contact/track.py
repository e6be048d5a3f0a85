"""The samples of a foot that are measured, and the impulses that they add up to.

Impulses are running totals over every sample, so that they can be asked for between any two times.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Float32s, Floats, Ints, all_finite, flagged_runs, norms
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.corrections.clock import TimeSource, advancing, first_at_each_tick
from dogbot_logtool.core.integral import Integral, trapezoids
from dogbot_logtool.core.quality import steady_gap_ns

POINT_RATE_HZ: Final = 100.0
"""Contact points and vertical forces are compared with the base at this rate at most."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class FootTrack:
    """The n samples of one foot that are used, and their running totals."""

    time: Ints
    """(n,) ns, strictly increasing."""
    row: NDArray[np.int32]
    """(n,) the sample of the recording that each is."""
    log_time: Ints
    """(n,) ns, when it was recorded."""
    force: Floats
    """(n,) N, |F|."""
    vertical_force: Floats | Float32s
    """(n,) N; 0 without contact, NaN where its direction is not known."""
    horizontal_force: Floats | Float32s
    """(n, 2) N, along the world's x and y where the direction is known."""
    contact_points: tuple[Ints, Floats]
    """(p,) ns and (p, 3) m: when and where in the world the foot touches, the first of each run of
    samples that have a point, and up to `POINT_RATE_HZ` a second of the others."""
    gaps: Ints
    """(g, 2) ns, intervals that are too long: last sample before, first one after."""
    force_impulse: Integral
    """N s, of |F|, gaps left out; one column."""
    impulse: Integral
    """N s, of the force along the world's three axes, where that is known."""
    vertical_unknown: Ints
    """(u, 2) ns, time with a load whose direction is not known."""

    @property
    def vertical_impulse(self) -> Integral:
        """N s, of the vertical force, where that is known; one column."""
        return Integral(self.time, self.impulse.total[:, 2:])

    def mean_force(self, begin: Ints, end: Ints) -> Floats:
        """(m, 3) N, along the world's axes, between some times; NaN where not known."""
        added = self.impulse.added(begin, end)
        added[timespans.touches(self.vertical_unknown, begin, end)] = np.nan
        return np.asarray(added / ((end - begin) / 1e9)[:, None])


def foot_track(
    samples: Samples, clock: TimeSource, *, force_in_world: bool
) -> tuple[FootTrack, Samples, int]:
    """Integrate the samples of a foot with a finite force and a time later than all before.

    Args:
        samples: of the foot, in the order of the log.
        clock: on which is measured.
        force_in_world: whether the wrenches are in the world frame.

    Returns:
        the track, its samples, and how many of those given have no such force.
    """
    time, force = clock.of(samples), norms(samples.force)
    usable = np.isfinite(force)
    not_finite = len(usable) - int(usable.sum())
    if clock is TimeSource.HEADER:
        usable &= time != 0
    usable[usable] = advancing(time[usable])
    row = np.flatnonzero(usable).astype(np.int32)
    if len(row) < len(usable):
        samples, time, force = samples.pick(usable), time[usable], force[usable]
    known = samples.in_world | force_in_world | (force == 0.0)
    vertical = np.where(known, samples.force[:, 2], np.nan)
    steps = np.diff(time)
    gap = steps > steady_gap_ns(steps)
    rows = np.flatnonzero(all_finite(samples.position))
    placed = first_at_each_tick(time[rows], POINT_RATE_HZ)
    placed |= np.diff(rows, prepend=-2) > 1
    rows = rows[placed]
    # From the last known vertical force, or the start, to the next known one.
    first, behind = flagged_runs(~known).T
    first, behind = np.maximum(first - 1, 0), np.minimum(behind, len(time) - 1)
    seconds = np.where(gap, 0, steps) / 1e9
    known_s = seconds * (known[1:] & known[:-1])
    track = FootTrack(
        time=time,
        row=row,
        log_time=samples.log_time,
        force=force,
        vertical_force=vertical,
        horizontal_force=samples.force[:, :2],
        contact_points=(time[rows], samples.position.take(rows, axis=0).astype(np.float64)),
        gaps=np.stack([time[:-1][gap], time[1:][gap]], axis=1),
        force_impulse=Integral(time, trapezoids(seconds, force[:, None])),
        impulse=Integral(time, trapezoids(known_s, samples.force)),
        vertical_unknown=np.stack([time[first], time[behind]], axis=1),
    )
    return track, samples, not_finite
