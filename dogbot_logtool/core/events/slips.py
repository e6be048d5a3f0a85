"""Stances in which a foot slips, by the way of its contact point while it is loaded.

The contact point of a foot that stays where it is may move, too: it rolls, or tips over its edge.
So a slip is a way that is unlike those of the foot's other stances, or much longer than the one
that the robot's file allows. A slip is quick, and rolling is slow: within some hundredths of a
second a slip stands out that is small against the way of a whole stance.
"""

from collections.abc import Iterator
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Flags, Floats, percentiles_of
from dogbot_logtool.core.events.event import Event, EventType
from dogbot_logtool.core.gait.foot_steps import FootSteps
from dogbot_logtool.core.gait.segments import Segment
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
AT_ONCE: Final = 0.7
"""Share of a slip that is in its quick way, if it is over at once."""
QUICK_TIMES: Final = 1.0
"""Times the usual quick way that a quick slip is longer than that."""


def slips(
    foot: int,
    figures: FootSteps,
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
    stances, known = figures.stances, figures.stances.figures
    steps = stances.whole & ~np.isin(stances.touchdown, list(stumbles))
    way, quick = (
        np.where(steps, each, np.nan) for each in (known.loaded_reach_m, known.quick_way_m)
    )
    usual = _usual_m(figures, way, walks, TIMES)
    allowed = np.where(np.isnan(usual) & _is_far(way, rolling_m), rolling_m or 0.0, usual)
    excess = way - allowed
    quick_excess = quick - _usual_m(figures, quick, walks, QUICK_TIMES)
    # Of a slip that is over at once, the quick way tells the time best, noise or not.
    at_once = quick_excess >= np.where(np.isnan(excess), 0.0, AT_ONCE * excess)
    metres = np.where(np.isnan(excess), quick_excess, excess)
    for row in np.flatnonzero(np.isfinite(metres)).tolist():
        times = known.reach_begins_s[row], known.reach_ends_s[row]
        if at_once[row]:
            times = known.quick_begins_s[row], known.quick_ends_s[row]
        begins, ends = _times(figures, row, *times)
        unknown = rolling_m is None and np.isnan(usual[row]) and np.isfinite(excess[row])
        code = "SLIPS" if unknown else ""
        yield Event(begins, ends - begins, EventType.SLIP, foot, float(metres[row]), "m", code)


def _is_far(way: Floats, rolling_m: float | None) -> Flags:
    """(stances,) tell which ways are too long for any foot that does not slip."""
    if rolling_m is None:
        return np.asarray(way > LARGEST_FOOT_M)
    return np.asarray(way - rolling_m > max(SLIP_M, TIMES * rolling_m))


def _usual_m(figures: FootSteps, way: Floats, walks: list[Segment], times: float) -> Floats:
    """(stances,) m, the usual way in the segment of stances that are unlike it; else NaN.

    Args:
        figures: the foot's stances.
        way: (stances,) m; NaN where it does not count.
        walks: segments with strides.
        times: the usual way by which a way that is unlike it is longer.
    """
    touchdown = figures.stances.touchdown
    usual = np.full(len(way), np.nan)
    for segment in walks:
        rows = (touchdown >= segment.start) & (touchdown < segment.end) & np.isfinite(way)
        if rows.sum() < FEWEST:
            continue
        low, median = percentiles_of(way[rows], (25.0, 50.0))
        far = max(FAR_OUT * (median - low), times * median, SLIP_M)
        usual[rows & (way - median > far)] = median
    return usual


def _times(figures: FootSteps, row: int, begins_s: float, ends_s: float) -> tuple[int, int]:
    """Return when a stance's contact point moves, ns; the whole stance where samples are few."""
    touchdown, liftoff = int(figures.stances.touchdown[row]), int(figures.stances.liftoff[row])
    if not np.isfinite(begins_s + ends_s):
        return touchdown, liftoff
    return touchdown + round(float(begins_s) * 1e9), touchdown + round(float(ends_s) * 1e9)
