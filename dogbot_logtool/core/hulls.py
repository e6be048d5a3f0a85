"""The polygon of feet on the ground, seen from above: margin and centre of pressure."""

from dataclasses import dataclass
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Flags, Floats

NEAR_NS: Final = 60_000_000
"""ns: a foot's row further from an instant than this does not tell where it is then."""


def centre_of_pressure(points: Floats, load: Floats) -> Floats:
    """Return sum(Fz p) / sum(Fz).

    Args:
        points: (n, feet, 2 or 3) m; NaN where a foot is not down.
        load: (n, feet) N, vertical force, 0 where a foot is not down.

    Returns:
        (n, 2 or 3) m; NaN where nothing is loaded.
    """
    total = load.sum(axis=1)
    weighted = (np.nan_to_num(points) * load[:, :, None]).sum(axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        centre: Floats = np.where(total[:, None] > 0.0, weighted / total[:, None], np.nan)
    return centre


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Hulls:
    """Convex hulls of the feet that are down, seen from above."""

    point: Floats
    """(2, feet, n) m; NaN where a foot is not down."""
    along: Floats
    """(2, feet, feet, n) m, from the one foot to the other."""
    edge: Flags
    """(feet, feet, n) whether an edge runs from the one foot to the other, counter-clockwise; both
    ways between two feet, or the ends of a row of feet."""
    area: Flags
    """(n,) whether the feet span an area."""


@np.errstate(over="ignore", invalid="ignore")
def hulls(points: Floats) -> Hulls:
    """Find the convex hull of some points.

    A pair of points is an edge of the hull where all other points lie to the left of the line
    through them: for the few feet that a robot has, trying all pairs is the plainest way.

    Args:
        points: (n, feet, 2) m; NaN where a foot is not down.
    """
    point = np.ascontiguousarray(points.T)
    along = point[:, None] - point[:, :, None]
    edge = (along != 0.0).any(axis=0) & np.isfinite(along[0])
    area = np.zeros(len(points), np.bool_)
    for first, away in enumerate(along.swapaxes(0, 1)):
        sides = _cross(away[:, :, None], away[:, None])
        edge[first] &= (np.isnan(sides) | (sides >= 0.0)).all(axis=1)
        area |= (edge[first] & (sides > 0.0).any(axis=1)).any(axis=0)
    return Hulls(point, along, edge, area)


@np.errstate(over="ignore", invalid="ignore", divide="ignore")
def margin_in(hull: Hulls, body: Floats) -> Floats:
    """Return the signed distance of a point to the edge of the convex hull of some others.

    Args:
        hull: of n times.
        body: (n, 2) m.

    Returns:
        (n,) m, positive inside, NaN where the points span no area.
    """
    along, to = hull.along, (body.T[:, None] - hull.point)[:, :, None]
    inside = (~hull.edge | (_cross(along, to) >= 0.0)).all(axis=(0, 1))
    share = (along * to).sum(axis=0) / (along * along).sum(axis=0)
    away = to - np.clip(share, 0.0, 1.0) * along
    reach = np.hypot(away[0], away[1])
    distance = np.where(hull.edge, reach, np.inf).min(axis=(0, 1), initial=np.inf)
    return np.where(hull.area, np.where(inside, distance, -distance), np.nan)


def _cross(along: Floats, to: Floats) -> Floats:
    """Twice the signed area of the triangle: positive where the one turns left to the other."""
    signed: Floats = along[0] * to[1] - along[1] * to[0]
    return signed
