"""How far the contact point of a foot goes in a stance, and when."""

from typing import Final

import numpy as np

from dogbot_logtool.core.contact.loaded_way import Ways, loaded_ways, quick_ways
from dogbot_logtool.core.contact.stance_samples import StanceSamples, own_rows
from dogbot_logtool.core.geometry.arrays import Floats, Ints
from dogbot_logtool.core.geometry.runs import first_where

LOADED: Final = 0.5
"""Share of a stance's mean force from which its foot is loaded."""


def contact_ways(samples: StanceSamples) -> tuple[Floats, Floats]:
    """(k,) m, net travel of the contact point from 10 % to 90 % of a stance, and its reach.

    The reach is the largest distance from where the point is at 10 %. Both are horizontal.

    A round foot that rolls moves its contact point without slipping, so this is not slip yet.
    NaN when no samples with a contact point surround both instants.
    """
    rows = np.flatnonzero(np.isfinite(samples.x) & np.isfinite(samples.y))
    begin, end = np.searchsorted(rows, samples.touchdown), np.searchsorted(rows, samples.end)
    duration = samples.time[samples.end]
    tenth, nine_tenths = 0.1 * duration, 0.9 * duration
    known = end - begin >= 2
    known[known] = samples.time[rows[begin[known]]] <= tenth[known]
    known[known] = samples.time[rows[end[known] - 1]] >= nine_tenths[known]

    time, stance = samples.time[rows], samples.stance[rows]
    x, y = samples.x[rows], samples.y[rows]
    ends = []
    for at in (tenth, nine_tenths):
        later = first_where(time > at[stance], begin)[known]
        around = later - 1, np.minimum(later, end[known] - 1)
        ends.append([_interpolated(at[known], time, values, around) for values in (x, y)])
    (x_early, y_early), (x_late, y_late) = ends
    travel, reach = np.full((2, len(begin)), np.nan)
    travel[known] = np.hypot(x_late - x_early, y_late - y_early)
    start = np.full((2, len(begin)), np.nan)
    start[:, known] = x_early, y_early
    way = np.hypot(x - start[0, stance], y - start[1, stance])
    counts = known[stance] & (time >= tenth[stance]) & (time <= nine_tenths[stance])
    reach[known] = travel[known]
    np.maximum.at(reach, stance[counts], way[counts])
    return travel, reach


def _interpolated(at: Floats, time: Floats, values: Floats, around: tuple[Ints, Ints]) -> Floats:
    """(k,) values at times between two rows each, or at the time of the first of them."""
    before, after = around
    since = at - time[before]
    slope = (values[after] - values[before]) / (time[after] - time[before])
    return np.where(since == 0.0, values[before], slope * since + values[before])


def ways_under_load(samples: StanceSamples, mean: Floats) -> tuple[Ways, Ways]:
    """(k,) all and quick ways of samples from 10 % to 90 % of a stance, with a contact point."""
    duration = samples.time[samples.end][samples.stance]
    counts = own_rows(samples) & np.isfinite(samples.x) & np.isfinite(samples.y)
    counts &= (samples.time >= 0.1 * duration) & (samples.time <= 0.9 * duration)
    rows = np.flatnonzero(counts)
    stance = samples.stance[rows]
    loaded = samples.force[rows] >= (LOADED * mean)[stance]
    columns = samples.time[rows], samples.x[rows], samples.y[rows]
    single = loaded & samples.single[rows]
    return (
        loaded_ways(*columns, loaded, stance, len(mean)),
        quick_ways(*columns, single, stance, len(mean)),
    )
