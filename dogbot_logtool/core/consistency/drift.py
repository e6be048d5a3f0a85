"""How far the base drifts among its feet: odometry that loses its way against contact points."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from dogbot_logtool.core.base.base_history import BaseHistory
from dogbot_logtool.core.contact.stances import Stances
from dogbot_logtool.core.contact.track import FootTrack
from dogbot_logtool.core.geometry.arrays import Floats, all_finite
from dogbot_logtool.core.geometry.rotations import along_heading

FEWEST_STANCES: Final = 8
"""Stances of all feet from which a trend is told."""
STEADY: Final = 0.8
"""Share of the variance of the feet's positions that a straight trend explains; a robot that leans
otherwise from some moment on makes a step."""


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
    known = np.flatnonzero(all_finite(track.point[:, :2]))
    time, point = track.time[known], track.point.take(known, axis=0)[:, :2]
    begin, end = stances.touchdown[stances.whole], stances.liftoff[stances.whole]
    stance = np.searchsorted(begin, time, side="right") - 1
    inside = (stance >= 0) & (time < end[np.maximum(stance, 0)]) if len(begin) else stance >= 0
    time, point, stance = time[inside], point[inside], stance[inside]
    away = np.stack(
        along_heading(point - base.position_at(time)[:, :2], base.angles_at(time)[:, 2]), axis=1
    )
    placed = all_finite(away)
    time, away, stance = time[placed], away[placed], stance[placed]
    count = np.bincount(stance, minlength=len(begin))
    columns = np.column_stack([(time - base.time[0]) / 1e9, away])
    sums = [np.bincount(stance, column, len(begin)) for column in columns.T]
    seen: Floats = np.column_stack(sums)[count > 0] / count[count > 0][:, None]
    return seen
