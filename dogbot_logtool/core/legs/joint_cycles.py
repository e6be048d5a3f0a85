"""Joints over the strides of their leg's foot: work, and the usual motion over the gait cycle."""

import numpy as np

from dogbot_logtool.core.arrays import Floats, Ints, percentiles_of
from dogbot_logtool.core.gait.feet import CYCLE_POINTS, QUARTILES
from dogbot_logtool.core.gait.strides import Strides
from dogbot_logtool.core.legs.joint_track import JointHistory, JointTrack
from dogbot_logtool.core.legs.silences import silent_before, unbroken
from dogbot_logtool.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class JointCurve:
    """A joint over the gait cycle, (CYCLE_POINTS,) each."""

    percent: Floats
    """% of the stride."""
    lower: Floats
    """rad or m, lower quartile over strides; also `median` and `upper`."""
    median: Floats
    upper: Floats
    number: int
    """Strides."""
    ranges: Floats
    """(strides,) rad or m, the range of motion in each."""


@dataclass(frozen=True, slots=True)
class Work:
    """Work of joints over strides, (strides,) each; NaN where not known."""

    positive_j: Floats
    absolute_j: Floats

    @property
    def net_j(self) -> Floats:
        """(strides,) positive less negative work."""
        return 2.0 * self.positive_j - self.absolute_j

    def without_signs(self) -> "Work":
        """Return what is known where the signs of efforts are not."""
        return Work(np.full_like(self.positive_j, np.nan), self.absolute_j)


def no_work(count: int) -> Work:
    """Return what stands for work that is not known."""
    return Work(np.full(count, np.nan), np.full(count, np.nan))


def joint_work(joint: JointHistory, begin: Ints, end: Ints) -> Work:
    """Return the work of a joint in some spans, such as strides, (n,) ns each.

    A span with a silence of the joint's states, or with an effort that is not known, has none. A
    joint that never moves does none.
    """
    if not joint.moves:
        within = (begin >= joint.start) & (end <= joint.end)
        still = np.where(within, 0.0, np.nan)
        return Work(still, still)
    track = joint.track
    # Before its first motion, which is where its track begins, a joint is known to be at rest.
    breaks = ~np.isfinite(track.positive_work)
    known = unbroken(track.time, breaks, begin, end) & (begin >= joint.start)
    positive, absolute = _over(track, begin, end)
    return Work(np.where(known, positive, np.nan), np.where(known, absolute, np.nan))


def _over(track: JointTrack, begin: Ints, end: Ints) -> tuple[Floats, Floats]:
    """(n,) J each, positive and absolute work in some spans."""
    since, last, first = (
        (time - track.time[0]).astype(np.float64) for time in (track.time, end, begin)
    )
    done: list[Floats] = []
    for work in (track.positive_work, track.absolute_work):
        total = np.cumsum(np.nan_to_num(work.astype(np.float64)))
        done.append(np.interp(last, since, total) - np.interp(first, since, total))
    return done[0], done[1]


def joint_curve(joint: JointHistory, strides: Strides) -> JointCurve | None:
    """Return the usual motion of a joint over whole strides; None where none is known."""
    track = joint.track
    if len(track.time) < 2 or not len(strides.touchdown):
        return None
    told = unbroken(track.time, silent_before(track.time), strides.touchdown, strides.end)
    rows = np.flatnonzero(told & (strides.touchdown >= track.time[0]))
    if not len(rows):
        return None
    phase = np.linspace(0.0, 1.0, CYCLE_POINTS)
    start, period = strides.touchdown[rows], (strides.end - strides.touchdown)[rows]
    time = (start - track.time[0])[:, None] + period[:, None] * phase
    since = (track.time - track.time[0]).astype(np.float64)
    position = np.interp(time, since, track.position.astype(np.float64))
    lower, median, upper = percentiles_of(position, QUARTILES, axis=0)
    return JointCurve(
        percent=100.0 * phase,
        lower=lower,
        median=median,
        upper=upper,
        number=len(rows),
        ranges=np.ptp(position, axis=1),
    )


def summed(works: list[Work], count: int) -> Work:
    """Add up the work of several joints over the same strides, none of nothing."""
    if not works:
        return no_work(count)
    return Work(
        np.sum([work.positive_j for work in works], axis=0),
        np.sum([work.absolute_j for work in works], axis=0),
    )
