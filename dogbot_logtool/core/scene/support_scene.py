"""What `/support` shows: support polygon, centre of pressure, ground projection, footfalls.

Definitions are those of `support_polygon.py`; the state of the feet is that of `footing.py`. What
cannot be known is left out. Where a foot is silent, or stands at a place that is not told, nobody
knows what the robot stands on: then there is neither polygon nor centre of pressure.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from dogbot_logtool.core.base.odometry import Odometry
from dogbot_logtool.core.contact.foot_tracker import TRAIL, Footing
from dogbot_logtool.core.geometry.arrays import Float32s, Floats, Ints, all_finite
from dogbot_logtool.core.geometry.support_polygon import Hulls, centre_of_pressure, hulls, margin_in

SAFE_MARGIN_M: Final = 0.05
"""m, static margin from which the polygon has the colour of safety."""
# Colours that colour-blind readers tell apart (Okabe and Ito), red, green, blue, alpha.
UNSTABLE: Final = (0.835, 0.369, 0.0, 1.0)
"""Vermilion: the base is above the polygon's edge, or outside."""
BARELY_STABLE: Final = (0.941, 0.894, 0.259, 1.0)
"""Yellow: just inside."""
STABLE: Final = (0.0, 0.620, 0.451, 1.0)
"""Bluish green: at least `SAFE_MARGIN_M` inside."""
NO_MARGIN: Final = (0.6, 0.6, 0.6, 1.0)
"""Grey: no polygon, so no margin."""


@dataclass(frozen=True, slots=True)
class SupportScene:
    """What the robot stands on at some times."""

    log_time: Ints
    """(n,) ns."""
    stamp: Ints
    """(n,) ns."""
    outline: Floats
    """(n, feet + 1, 3) m, world frame: the support polygon's corners at the heights of their
    contact points, counter-clockwise and closed; two points where two feet, or feet in a row,
    make a line. NaN after the last, and throughout where there is none."""
    margin: Floats
    """(n,) m, static margin; NaN where there is no polygon."""
    colour: Float32s
    """(n, 4) of the outline: red, green, blue, alpha in [0, 1]."""
    pressure: Floats
    """(n, 3) m, centre of pressure; NaN where it is not known."""
    projection: Floats
    """(n, 3) m, the base's ground projection; NaN where the ground's height is not known."""
    footfalls: Floats
    """(n, feet * TRAIL, 3) m, where feet last touched down; those that there are stand first,
    NaN for the others."""
    unknown: int
    """Times at which it is not known which feet are down, or where."""
    unweighed: int
    """Times at which that is known, but not the vertical force on a foot that is down."""


@np.errstate(over="ignore", invalid="ignore")
def support_scene(poses: Odometry, feet: Sequence[Footing]) -> SupportScene:
    """Work out what the robot stands on.

    Args:
        poses: of the base, (n), at the times that are wanted.
        feet: all feet of the robot.
    """
    states = [foot.at(poses.log_time) for foot in feet]
    down = np.stack([state.down for state in states], axis=1)
    known = np.stack([state.known for state in states], axis=1)
    point = np.stack([state.point for state in states], axis=1)
    vertical = np.stack([state.vertical for state in states], axis=1)
    placed = np.isfinite(point).all(axis=2)
    told = np.asarray((known & (placed | ~down)).all(axis=1))

    points = np.where((down & placed)[:, :, None], point, np.nan)
    in_use = np.where(told[:, None, None], points, np.nan)
    hull = hulls(in_use[:, :, :2])
    margin = margin_in(hull, poses.position[:, :2])
    # A foot that pulls does not move the centre of pressure, as in `stats`.
    load = np.where(down, np.maximum(vertical, 0.0), 0.0)
    weighed = np.isfinite(load).all(axis=1)
    pressure = centre_of_pressure(in_use, np.where(told & weighed, load.T, 0.0).T)
    footfalls = np.stack([foot.trail_at(poses.log_time) for foot in feet], axis=1)
    return SupportScene(
        log_time=poses.log_time,
        stamp=poses.time,
        outline=outlines(in_use, hull),
        margin=margin,
        colour=margin_colour(margin),
        pressure=_known(pressure),
        projection=_projection(poses.position, points, footfalls[:, :, 0]),
        footfalls=_known_first(footfalls.reshape(-1, len(feet) * TRAIL, 3)),
        unknown=int((~told).sum()),
        unweighed=int((told & ~weighed).sum()),
    )


def outlines(points: Floats, hull: Hulls) -> Floats:
    """Return the corners of hulls, counter-clockwise and closed.

    Args:
        points: (n, feet, 3) m; NaN where a foot is not down.
        hull: of these points.

    Returns:
        (n, feet + 1, 3) m; two points where the hull is a line, NaN after the last.
    """
    count, feet = points.shape[:2]
    # In a row of points along an edge, the next corner is the furthest.
    length = np.where(hull.edge, hull.along[0] ** 2 + hull.along[1] ** 2, -1.0)
    following = length.argmax(axis=1)
    first = _leftmost(hull.point)
    row, corner, drawn = np.arange(count), first, hull.edge.any(axis=(0, 1))
    outline = np.full((count, feet + 1, 3), np.nan)
    for place in range(feet + 1):
        outline[drawn, place] = points[row, corner][drawn]
        closed = corner == first
        corner = following[corner, row]
        # Back at the first corner the outline is closed; a line ends at its second point.
        drawn = drawn & ~closed if place > 0 else drawn
        drawn = drawn & (corner != first) if place == 1 else drawn
    return outline


def _leftmost(point: Floats) -> Ints:
    """(n,) index of the point with the least x, and of those the one with the least y."""
    x = np.where(np.isnan(point[0]), np.inf, point[0])
    return np.asarray(np.where(x == x.min(axis=0), point[1], np.inf).argmin(axis=0))


def margin_colour(margin: Floats) -> Float32s:
    """Return colours of static margins.

    Vermilion at 0 and below; above, from yellow to bluish green at `SAFE_MARGIN_M` and beyond; grey
    where there is none.

    Args:
        margin: (n,) m, NaN where there is no polygon.

    Returns:
        (n, 4) red, green, blue, alpha.
    """
    share = np.clip(margin / SAFE_MARGIN_M, 0.0, 1.0)[:, None]
    inside = (1.0 - share) * np.array(BARELY_STABLE) + share * np.array(STABLE)
    colour = np.where((margin > 0.0)[:, None], inside, np.array(UNSTABLE))
    return np.where(np.isnan(margin)[:, None], np.array(NO_MARGIN), colour).astype(np.float32)


def _projection(base: Floats, points: Floats, newest_footfalls: Floats) -> Floats:
    """Put the base on the ground.

    The ground is as high as the mean of the contact points in use, or where none is, of the newest
    footfall of each foot.

    Args:
        base: (n, 3) m.
        points: (n, feet, 3) m; NaN where a foot is not down.
        newest_footfalls: (n, feet, 3) m; NaN where there is none.
    """
    height = _mean_of_known(points[:, :, 2])
    height = np.where(np.isnan(height), _mean_of_known(newest_footfalls[:, :, 2]), height)
    return _known(np.column_stack([base[:, :2], height]))


def _known(points: Floats) -> Floats:
    """Leave out points, (n, 3), of which a number is not known, or too large for a float."""
    return np.where(all_finite(points)[:, None], points, np.nan)


def _mean_of_known(values: Floats) -> Floats:
    """(n,) mean of each row's numbers; NaN where there is none."""
    known = np.isfinite(values)
    with np.errstate(invalid="ignore"):
        mean: Floats = np.where(known, values, 0.0).sum(axis=1) / known.sum(axis=1)
    return mean


def _known_first(points: Floats) -> Floats:
    """Move the points that are known, (n, k, 3), to the front of each row."""
    missing = np.isnan(points[:, :, 0])
    if not missing.any():
        return points
    order = np.argsort(missing, axis=1, kind="stable")
    return np.take_along_axis(points, order[:, :, None], axis=1)
