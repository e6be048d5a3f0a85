"""The way of the base, above the noise of its poses."""

from math import hypot, prod
from typing import Final

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Flags, Floats, Ints, median_of
from dogbot_logtool.core.base.base_history import BaseHistory
from dogbot_logtool.core.corrections.clock import first_at_each_tick
from dogbot_logtool.dataclass import dataclass

AWAY_M: Final = 0.05
"""m, a base that does not get so far away goes nowhere: it stands, and sways."""
_LOOK_HZ: Final = 5.0
_PACE: Final = 2
"""Times the last way of `AWAY_M` that the rest of it may take."""
_NEGLIGIBLE: Final = 0.01
"""Share by which noise may lengthen the path before it is taken off."""
_NORMAL_MEDIAN: Final = 0.6745
"""Median of |x| of a normal distribution, in standard deviations."""
_LONGEST_BLOCK: Final = 100
"""Poses that are averaged at most: a second of them."""


@dataclass(frozen=True, slots=True)
class Travel:
    """When the base goes somewhere, and how noisy its poses are."""

    spans: Ints
    """(t, 2) ns."""
    noise_m: float
    """m, standard deviation of the noise on one horizontal coordinate."""
    block: int
    """Poses whose mean makes one point of the path."""


def find_travel(base: BaseHistory) -> Travel:
    """Find when the base goes somewhere.

    Args:
        base: poses, without jumps.
    """
    spans = timespans.intersect([_away_spans(base), base.known])
    noise = pose_noise_m(base)
    return Travel(spans, noise, _block(base, spans, noise))


def _away_spans(base: BaseHistory) -> Ints:
    """(t, 2) ns, from each place to the time at which the base is `AWAY_M` away from it."""
    rows = np.flatnonzero(first_at_each_tick(base.time, _LOOK_HZ, None))
    time = base.time[rows].tolist()
    points = base.position[rows, :2].tolist()
    spans = []
    start = 0
    for row, (x, y) in enumerate(points):
        from_x, from_y = points[start]
        if hypot(x - from_x, y - from_y) >= AWAY_M:
            spans.append((time[start], time[row]))
            start = row
    if spans:
        # What is left of the way, as far as the base keeps its pace.
        began, ended = spans[-1]
        spans.append((ended, min(int(base.time[-1]), ended + _PACE * (ended - began))))
    return timespans.merge(np.array(spans, np.int64).reshape(-1, 2))


def pose_noise_m(base: BaseHistory) -> float:
    """Return the standard deviation of white noise on the horizontal position, m.

    From third divided differences, which smooth motion hardly shows in, whatever the intervals.
    The median keeps jumps out.
    """
    if len(base.time) < _LONGEST_BLOCK:
        return 0.0
    seconds = (base.time - base.time[0]) / 1e9
    difference = base.position[:, :2]
    for order in (1, 2, 3):
        apart = seconds[order:] - seconds[:-order]
        difference = np.diff(difference, axis=0) / apart[:, None]
    weights = _difference_weights(seconds)
    return float(median_of(np.abs(difference) / weights[:, None])) / _NORMAL_MEDIAN


def _difference_weights(seconds: Floats) -> Floats:
    """(n - 3,) standard deviation of third divided differences of unit white noise, 1/s^3."""
    count = len(seconds) - 3
    window = [seconds[first : first + count] for first in range(4)]
    apart = [prod(one - other for other in window if other is not one) for one in window]
    return np.sqrt(sum(np.asarray(each) ** -2.0 for each in apart))


def _block(base: BaseHistory, spans: Ints, noise: float) -> int:
    """Return of how many poses the mean is taken, so that noise lengthens the path by 1 %."""
    if noise == 0.0 or len(spans) == 0 or len(base.time) < 2:
        return 1
    step_s = float(median_of(np.diff(base.time))) / 1e9
    begin, end = base.position_at(spans[:, 0]), base.position_at(spans[:, 1])
    way = np.nansum(np.hypot(*(end - begin)[:, :2].T))
    speed = max(float(way) / (timespans.total(spans) / 1e9), AWAY_M / 10.0)
    size = (4.0 * noise**2 / (2.0 * _NEGLIGIBLE * (speed * step_s) ** 2)) ** (1.0 / 3.0)
    return int(min(max(np.ceil(size), 1), _LONGEST_BLOCK))


def path_length_m(base: BaseHistory, travel: Travel, moves: Flags) -> float:
    """Return the length of the base's horizontal path above its noise, m.

    Means of some poses are joined; what noise adds to each squared step on average is taken off.

    Args:
        base: poses, without jumps.
        travel: when the base goes somewhere.
        moves: (n - 1,) which steps between poses count.
    """
    counted = moves & timespans.covers(travel.spans, base.time[:-1])
    edges = np.diff(np.concatenate([[False], counted, [False]]).astype(np.int8))
    starts, ends = np.flatnonzero(edges == 1), np.flatnonzero(edges == -1)
    return sum(
        _way(base.position[start : end + 1, :2], travel)
        for start, end in zip(starts.tolist(), ends.tolist(), strict=True)
    )


def _way(path: Floats, travel: Travel) -> float:
    """Length of an unbroken path, m."""
    size = min(travel.block, max(1, len(path) // 4))
    blocks = len(path) // size
    points = path[: blocks * size].reshape(blocks, size, 2).mean(axis=1)
    step = np.diff(points, axis=0)
    noise = 4.0 * travel.noise_m**2 / size
    length = float(np.sqrt(np.clip((step * step).sum(axis=1) - noise, 0.0, None)).sum())
    # The means lie half a block inside the path's ends.
    return length * (len(path) - 1) / ((blocks - 1) * size) if blocks > 1 else 0.0
