"""Whether base and feet are in one world: two world frames, or a drifting odometry, part them."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Floats, Ints, all_finite, distinct, median_of
from dogbot_logtool.core.base.ground import seen_from_base, trend
from dogbot_logtool.core.base.poses import BaseHistory
from dogbot_logtool.core.contact.foot_history import FootHistory

WINDOW_NS: Final = 2_000_000_000
"""ns: a foot's position is averaged over so long: a stride or more of most gaits."""
_MOST_WINDOWS: Final = 60
FEWEST_TICKS: Final = 25
"""Ticks of 40 ms with contact points of a foot from which its usual position is known."""
_TICK_NS: Final = 40_000_000
FEWEST_FEET: Final = 2
MOST_BEYOND: Final = 0.05
"""Share of the time in which the base may be further from the feet than they are spread."""
PART_OF_FEET: Final = 4.0
"""So many times further the base may be from some feet of a robot whose other feet tell no contact
points: from the hind pair, say. Few robots are so many times longer than wide."""
MOST_CHANGE: Final = 0.5
"""Change of the base's position among the feet, against their spread, that no gait explains."""
MOST_DRIFT: Final = 0.05
"""The same of a change that goes on steadily, stance after stance."""
MOST_OF_PATH: Final = 0.02
"""Share of the robot's way by which base and feet may drift apart until that is not known."""

FEWEST_STANCES: Final = 8
"""Stances of all feet from which a trend is told."""
STEADY: Final = 0.8
"""Share of the variance of the feet's positions that a straight trend explains; a robot that leans
otherwise from some moment on makes a step."""


@dataclass(frozen=True, slots=True)
class Worlds:
    """The base among the feet that are down, seen from above and from the base."""

    distance_m: float
    """m, median horizontal distance of the base from the centroid of the feet's usual positions."""
    largest_m: float
    """m, the largest, averaged over two seconds."""
    spread_m: float
    """m, distance of the outermost foot's usual position from that centroid."""
    beyond_fraction: float
    """Share of the time in which the base is further from it than the outermost foot, or
    `PART_OF_FEET` times as far where not all feet tell contact points."""
    change_m: float
    """m, change of the base's position among the feet from the log's first third to its last."""

    drift_m: float = 0.0
    """m, how far that position goes steadily; 0 where it does not, or too few stances tell."""

    @property
    def shift_m(self) -> float:
        """The larger of change and drift, m."""
        return max(self.change_m, self.drift_m)

    @property
    def agree(self) -> bool:
        """Whether base and feet are in one world, throughout."""
        steady = self.change_m <= MOST_CHANGE * self.spread_m
        steady &= self.drift_m <= MOST_DRIFT * self.spread_m
        return steady and self.beyond_fraction <= MOST_BEYOND

    def lose_track(self, path_m: float) -> bool:
        """Tell whether base and feet drift so far apart that a path, m, is doubtful."""
        return not self.agree and self.drift_m > MOST_OF_PATH * path_m


def compare_worlds(feet: Sequence[FootHistory], base: BaseHistory) -> Worlds | None:
    """Compare where the feet touch with where the base is.

    Args:
        feet: histories of all feet, with contact points in the world.
        base: poses.

    Returns:
        None where contact points of two feet around the base are not known for a second each.
    """
    if len(base.time) < 2:
        return None
    seen = [seen_from_base(foot, base) for foot in feet]
    placed = [each for each in seen if len(distinct(each[0] // _TICK_NS)) >= FEWEST_TICKS]
    if len(placed) < FEWEST_FEET:
        return None
    usual = np.stack([median_of(place, axis=0) for _, place in placed])
    centroid = usual.mean(axis=0)
    spread = float(np.hypot(*(usual - centroid).T).max())
    start, last = int(base.time[0]), max(int(time[-1]) for time, _ in placed)
    windows = int(np.clip((last - start) / WINDOW_NS, 1, _MOST_WINDOWS))
    edges = np.linspace(0, last - start, windows + 1)[1:-1]
    shift = np.stack(
        [
            _means(np.searchsorted(edges, time - start, side="right"), place - own, windows)
            for (time, place), own in zip(placed, usual, strict=True)
        ]
    )
    known = np.isfinite(shift[:, :, 0]).any(axis=0)
    away = centroid + np.nanmean(shift[:, known], axis=0)
    distance = np.hypot(away[:, 0], away[:, 1])
    farthest = spread if len(placed) == len(feet) else PART_OF_FEET * spread
    third = max(len(away) // 3, 1)
    change = median_of(away[-third:], axis=0) - median_of(away[:third], axis=0)
    return Worlds(
        distance_m=float(median_of(distance)),
        largest_m=float(distance.max()),
        spread_m=spread,
        beyond_fraction=float((distance > farthest).mean()),
        change_m=float(np.hypot(*change)),
        drift_m=_drift_m(feet, seen, start),
    )


def placed_poses(
    records: Sequence[FootHistory], recorded: BaseHistory, base: BaseHistory
) -> tuple[BaseHistory, Worlds | None]:
    """Return the poses that contact points are compared with, and how they agree.

    Args:
        records: of all feet.
        recorded: poses as recorded, jumps and all.
        base: poses without jumps.
    """
    worlds = compare_worlds(records, recorded)
    if recorded is base or worlds is None:
        return recorded, worlds
    without = compare_worlds(records, base)
    agrees = without is not None and without.agree
    if without is None or not agrees or (worlds.agree and worlds.change_m <= without.change_m):
        return recorded, worlds
    return base, without


def _means(group: Ints, values: Floats, groups: int) -> Floats:
    """(groups, k) means of the rows of each group; NaN of none."""
    sums = [np.bincount(group, column, groups) for column in values.T]
    with np.errstate(invalid="ignore"):
        mean: Floats = np.column_stack(sums) / np.bincount(group, minlength=groups)[:, None]
    return mean


def _drift_m(feet: Sequence[FootHistory], seen: Sequence[tuple[Ints, Floats]], start: int) -> float:
    """Return how far the base goes among its feet, steadily, over all stances, m.

    A foot's position is its mean one over a whole stance, in the body's axes: acceleration, which
    lets a foot land further ahead, hardly moves it. All feet have one trend.

    Args:
        feet: histories of all feet.
        seen: when and where each foot is seen from the base.
        start: ns, the first pose.

    Returns:
        0 without a trend, or with too few stances.
    """
    positions = []
    for foot, (time, place) in zip(feet, seen, strict=True):
        begin, end = foot.stances.touchdown, foot.stances.liftoff
        begin, end = begin[foot.stances.whole], end[foot.stances.whole]
        stance = np.searchsorted(begin, time, side="right") - 1
        inside = (stance >= 0) & (time < np.append(end, 0)[stance])
        rows = np.column_stack([(time - start) / 1e9, place])[inside]
        mean = _means(stance[inside], rows, len(begin))
        positions.append(mean[all_finite(mean)])
    # Each foot has a position of its own, and each its own mean time.
    centred = np.concatenate(
        [np.empty((0, 3)), *(each - each.mean(axis=0) for each in positions if len(each) > 1)]
    )
    if len(centred) < FEWEST_STANCES:
        return 0.0
    slope, steadiness = trend(centred[:, 0], centred[:, 1:])
    seconds = float(np.ptp(np.concatenate(positions)[:, 0]))
    return float(np.hypot(*slope)) * seconds if steadiness >= STEADY else 0.0
