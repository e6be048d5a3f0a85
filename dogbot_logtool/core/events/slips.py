"""Stances in which a foot slips, by the way of its contact point while it is loaded.

The contact point of a foot that stays where it is may move, too: it rolls, or tips over its edge.
So a slip is a way that is unlike those of the foot's other stances, or much longer than the one
that the robot's file allows.
"""

from collections.abc import Iterator
from typing import Final

import numpy as np

from dogbot_logtool.core.events.event import Event, EventType
from dogbot_logtool.core.gait.foot_statistics import FootStatistics
from dogbot_logtool.core.gait.segments import Segment
from dogbot_logtool.core.geometry.arrays import Flags, Floats
from dogbot_logtool.core.load.slip import LARGEST_FOOT_M

SLIP_M: Final = 0.005
"""m that a slip is at least longer than the way of a foot that does not slip."""
TIMES: Final = 2.0
"""So many times that way, too."""
FEWEST: Final = 5
"""Stances of a segment that say which way is usual."""
FAR_OUT: Final = 8.0
"""Times the distance from the lower quartile to the median that a slip is above the median: the
lower half of the ways has no slips in it."""


def slips(
    foot: int,
    figures: FootStatistics,
    walks: list[Segment],
    rolling_m: float | None,
    stumbles: frozenset[int],
) -> Iterator[Event]:
    """Yield the stances in which a foot slips.

    Args:
        foot: its index.
        figures: its stances.
        walks: segments with strides.
        rolling_m: m, way of the contact point of a foot that does not slip; None: not known.
        stumbles: ns, touchdowns of contacts that are no steps.
    """
    stances = figures.stances
    way = np.where(stances.whole, stances.figures.loaded_reach_m, np.nan)
    way[np.isin(stances.touchdown, list(stumbles))] = np.nan
    usual = _usual_m(figures, way, walks)
    allowed = np.where(np.isnan(usual) & _is_far(way, rolling_m), rolling_m or 0.0, usual)
    for row in np.flatnonzero(np.isfinite(way - allowed)).tolist():
        begins, ends = _times(figures, row)
        excess = float(way[row] - allowed[row])
        code = "W_SLIPS" if rolling_m is None and np.isnan(usual[row]) else ""
        yield Event(begins, ends - begins, EventType.SLIP, foot, excess, "m", code)


def _is_far(way: Floats, rolling_m: float | None) -> Flags:
    """(stances,) tell which ways are too long for any foot that does not slip."""
    if rolling_m is None:
        return np.asarray(way > LARGEST_FOOT_M)
    return np.asarray(way - rolling_m > max(SLIP_M, TIMES * rolling_m))


def _usual_m(figures: FootStatistics, way: Floats, walks: list[Segment]) -> Floats:
    """(stances,) m, the usual way in the segment of stances that are unlike it; else NaN."""
    touchdown = figures.stances.touchdown
    usual = np.full(len(way), np.nan)
    for segment in walks:
        rows = (touchdown >= segment.start) & (touchdown < segment.end) & np.isfinite(way)
        if rows.sum() < FEWEST:
            continue
        low, median = np.quantile(way[rows], (0.25, 0.5))
        far = max(FAR_OUT * (median - low), TIMES * median, SLIP_M)
        usual[rows & (way - median > far)] = median
    return usual


def _times(figures: FootStatistics, row: int) -> tuple[int, int]:
    """Return when a stance's contact point moves, ns; the whole stance where samples are few."""
    stances = figures.stances
    touchdown, liftoff = int(stances.touchdown[row]), int(stances.liftoff[row])
    begins, ends = stances.figures.reach_begins_s[row], stances.figures.reach_ends_s[row]
    if not np.isfinite(begins + ends):
        return touchdown, liftoff
    return touchdown + round(float(begins) * 1e9), touchdown + round(float(ends) * 1e9)
