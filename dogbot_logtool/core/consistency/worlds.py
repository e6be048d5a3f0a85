"""Whether base and feet are in one world: two world frames, or a drifting odometry, part them."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Floats, Ints, all_finite, distinct, median_of
from dogbot_logtool.core.base.poses import BaseHistory
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.contact.stances import Stances
from dogbot_logtool.core.contact.track import FootTrack
from dogbot_logtool.core.rotations import along_heading

WINDOW_S: Final = 2.0
"""s: a foot's position is averaged over so long: a stride or more of most gaits."""
_MOST_WINDOWS: Final = 60
FEWEST_TICKS: Final = 25
"""Ticks of 40 ms with contact points of a foot from which its usual position is known."""
_TICK_S: Final = 0.04
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
MOST_OF_WAY: Final = 0.02
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
    def agree(self) -> bool:
        """Whether base and feet are in one world, throughout."""
        steady = self.change_m <= MOST_CHANGE * self.spread_m
        steady &= self.drift_m <= MOST_DRIFT * self.spread_m
        return steady and self.beyond_fraction <= MOST_BEYOND

    def lose_way(self, path_m: float) -> bool:
        """Tell whether base and feet drift so far apart that a path, m, is doubtful."""
        return not self.agree and self.drift_m > MOST_OF_WAY * path_m


def compare_worlds(
    tracks: Sequence[FootTrack], base: BaseHistory, stances: Sequence[Stances] | None = None
) -> Worlds | None:
    """Compare where the feet touch with where the base is.

    Args:
        tracks: of all feet, with contact points in the world.
        base: poses.
        stances: of the same feet, for the drift; None: it is not looked at.

    Returns:
        None where contact points of two feet around the base are not known for a second each.
    """
    if len(base.time) < 2:
        return None
    feet = [_from_base(track, base)[1] for track in tracks]
    feet = [seen for seen in feet if _ticks(seen) >= FEWEST_TICKS]
    if len(feet) < FEWEST_FEET:
        return None
    usual = np.stack([median_of(seen[:, 1:], axis=0) for seen in feet])
    centroid = usual.mean(axis=0)
    spread = float(np.hypot(*(usual - centroid).T).max())
    seconds = max(float(seen[-1, 0]) for seen in feet)
    edges = np.linspace(0.0, seconds, _windows(seconds) + 1)
    shift = np.stack([_shift(*each, edges) for each in zip(feet, usual, strict=True)])
    known = np.isfinite(shift[:, :, 0]).any(axis=0)
    away = centroid + np.nanmean(shift[:, known], axis=0)
    distance = np.hypot(away[:, 0], away[:, 1])
    farthest = spread if len(feet) == len(tracks) else PART_OF_FEET * spread
    third = max(len(away) // 3, 1)
    change = median_of(away[-third:], axis=0) - median_of(away[:third], axis=0)
    return Worlds(
        distance_m=float(median_of(distance)),
        largest_m=float(distance.max()),
        spread_m=spread,
        beyond_fraction=float((distance > farthest).mean()),
        change_m=float(np.hypot(*change)),
        drift_m=0.0 if stances is None else drift_m(tracks, stances, base) or 0.0,
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
    tracks, stances = [each.track for each in records], [each.stances for each in records]
    worlds = compare_worlds(tracks, recorded, stances)
    if recorded is base or worlds is None:
        return recorded, worlds
    without = compare_worlds(tracks, base, stances)
    if (
        without is None
        or not without.agree
        or (worlds.agree and worlds.change_m <= without.change_m)
    ):
        return recorded, worlds
    return base, without


def _windows(seconds: float) -> int:
    return int(np.clip(seconds / WINDOW_S, 1, _MOST_WINDOWS))


def _from_base(track: FootTrack, base: BaseHistory) -> tuple[Ints, Floats]:
    """Return where a foot touches, seen from the base, as far as that is known.

    Returns:
        (n,) ns; and (n, 3) s since the first pose, m ahead and m to the left.
    """
    time, point = track.contact_points
    away = point - base.position_at(time)
    ahead, left = along_heading(away, base.angles_at(time)[:, 2])
    seen = np.column_stack([(time - base.time[0]) / 1e9, ahead, left])
    known = all_finite(seen)
    return time[known], seen[known]


def _ticks(seen: Floats) -> int:
    """Count the ticks in which a foot is seen, (n, 3); see `_from_base`."""
    return len(distinct(seen[:, 0] // _TICK_S))


def _shift(seen: Floats, usual: Floats, edges: Floats) -> Floats:
    """(w, 2) m, a foot's mean position in each window less its usual one; NaN where not seen."""
    window = np.clip(np.searchsorted(edges, seen[:, 0], side="right") - 1, 0, len(edges) - 2)
    count = np.bincount(window, minlength=len(edges) - 1)
    sums = [np.bincount(window, column, len(edges) - 1) for column in (seen[:, 1:] - usual).T]
    with np.errstate(invalid="ignore"):
        shift: Floats = np.column_stack(sums) / count[:, None]
    return shift


def drift_m(
    tracks: Sequence[FootTrack], stances: Sequence[Stances], base: BaseHistory
) -> float | None:
    """Return how far the base goes among its feet, steadily, over all stances.

    A foot's position is its mean one over a whole stance, in the body's axes: acceleration, which
    lets a foot land further ahead, hardly moves it. All feet have one trend.

    Args:
        tracks: of all feet, with contact points in the world.
        stances: of the same feet.
        base: poses.

    Returns:
        m; 0 without a trend, None with too few stances.
    """
    seen = [_positions(*foot, base) for foot in zip(tracks, stances, strict=True)]
    # Each foot has a position of its own, and each its own mean time.
    centred = [foot - foot.mean(axis=0) for foot in seen if len(foot) > 1]
    if sum(map(len, centred)) < FEWEST_STANCES:
        return None
    positions = np.concatenate(centred)
    time, position = positions[:, 0], positions[:, 1:]
    slope = (time @ position) / (time @ time)
    along = position @ (slope / max(float(np.hypot(*slope)), np.finfo(float).tiny))
    explained = float(np.hypot(*slope)) * time
    total = float(along @ along)
    if total == 0.0 or float(((along - explained) ** 2).sum()) > (1.0 - STEADY) * total:
        return 0.0
    return float(np.hypot(*slope)) * float(np.ptp(np.concatenate([foot[:, 0] for foot in seen])))


def _positions(track: FootTrack, stances: Stances, base: BaseHistory) -> Floats:
    """(s, 3) s, and m ahead and to the left of the base: mean positions of whole stances."""
    time, seen = _from_base(track, base)
    begin, end = stances.touchdown[stances.whole], stances.liftoff[stances.whole]
    stance = np.searchsorted(begin, time, side="right") - 1
    inside = (stance >= 0) & (time < end[np.maximum(stance, 0)]) if len(begin) else stance >= 0
    stance, seen = stance[inside], seen[inside]
    count = np.bincount(stance, minlength=len(begin))
    sums = [np.bincount(stance, column, len(begin)) for column in seen.T]
    mean: Floats = np.column_stack(sums)[count > 0] / count[count > 0][:, None]
    return mean
