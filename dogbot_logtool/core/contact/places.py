"""Where a foot stands in each of its stances."""

import numpy as np

from dogbot_logtool.core.arrays import Floats, Ints, median_of
from dogbot_logtool.core.contact.foot_history import FootHistory


def stance_places(foot: FootHistory) -> tuple[Ints, Floats]:
    """Return when and where a foot stands in each of its stances.

    Of a stance that is longer than usual, as one that a stand or a silence follows, the beginning
    counts.

    Returns:
        (k,) ns, the mean time of its contact points, or the middle of a stance without any; and
        (k, 3) m, their mean; NaN without any.
    """
    begin, end = foot.stances.touchdown, foot.stances.liftoff
    if len(begin):
        end = np.minimum(end, begin + int(median_of(end - begin)))
    middle = begin + (end - begin) // 2
    time, point = foot.track.contact_points
    place = np.full((len(begin), 3), np.nan)
    if not len(begin) or not len(time):
        return middle, place
    stance = np.searchsorted(begin, time, side="right") - 1
    inside = (stance >= 0) & (time < end[np.maximum(stance, 0)])
    stance, time, point = stance[inside], time[inside], point[inside]
    count = np.bincount(stance, minlength=len(begin))
    known = count > 0
    for axis in range(3):
        sums = np.bincount(stance, point[:, axis], len(begin))
        place[known, axis] = sums[known] / count[known]
    since = np.bincount(stance, (time - begin[0]).astype(np.float64), len(begin))
    middle[known] = begin[0] + (since[known] / count[known]).astype(np.int64)
    return middle, place
