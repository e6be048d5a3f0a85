"""Does the robot stand safely on the feet that are down? Support polygon and static margin."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.aggregates import Aggregate, aggregate
from dogbot_logtool.core.arrays import Flags, Floats, Ints
from dogbot_logtool.core.base_motion import FORWARD_ANGLES, along_heading
from dogbot_logtool.core.base_record import BaseRecord
from dogbot_logtool.core.foot_record import FootRecord

NEAR_NS: Final = 60_000_000
"""ns: a foot's row further from an instant than this does not tell where it is then."""
FEWEST_FEET: Final = 3
"""Feet that span a polygon."""
_CHUNK_NUMBERS: Final = 500_000
"""Pairs of feet, times instants, that are looked at in one go."""


@dataclass(frozen=True, slots=True)
class Stability:
    """Figures at 25 Hz over the time known to all feet and the base."""

    static_margin_m: Aggregate | None
    """m, signed distance of the base's ground projection to the support polygon's edge, positive
    inside (McGhee and Frank 1968)."""
    undefined_fraction: float | None
    """Share of instants with fewer than three feet down: no polygon."""
    unstable_fraction: float | None
    """Share of the instants with a polygon whose margin is negative."""
    pressure_forward_m: Aggregate | None
    """m, centre of pressure ahead of the base."""
    pressure_left_m: Aggregate | None
    """m, centre of pressure to the left of the base."""


def stability(
    feet: Sequence[FootRecord], base: BaseRecord, forward_axis: str, *, vertical_known: bool
) -> Stability | None:
    """Measure static stability; None where feet and base have no time in common.

    Args:
        feet: records of all feet.
        base: poses.
        forward_axis: the body's axis that points forward.
        vertical_known: whether vertical forces are known; else there is no centre of pressure.
    """
    instants = _common_instants(feet, base)
    chunk = max(_CHUNK_NUMBERS // max(len(feet), 1) ** 2, 1)
    parts = [
        _at(instants[start : start + chunk], feet, base, forward_axis)
        for start in range(0, len(instants), chunk)
    ]
    if not parts:
        return None
    margin, polygon, ahead, left = (np.concatenate(column) for column in zip(*parts, strict=True))
    margins = aggregate(margin)
    unstable = float((margin[polygon] < 0.0).mean()) if margins else None
    return Stability(
        static_margin_m=margins,
        undefined_fraction=float(1.0 - polygon.mean()),
        unstable_fraction=unstable,
        pressure_forward_m=aggregate(ahead) if vertical_known else None,
        pressure_left_m=aggregate(left) if vertical_known else None,
    )


def _common_instants(feet: Sequence[FootRecord], base: BaseRecord) -> Ints:
    """(n,) ns: rows of the first foot's track at which all feet and the base are known."""
    if not feet or len(base.time) == 0:
        return np.empty(0, np.int64)
    time = feet[0].track.time
    known = timespans.intersect([base.known, *(foot.known for foot in feet)])
    return time[timespans.covers(known, time)]


def _at(
    instants: Ints, feet: Sequence[FootRecord], base: BaseRecord, forward_axis: str
) -> tuple[Floats, Flags, Floats, Floats]:
    """(n,) margin, whether there is a polygon, centre of pressure ahead and to the left."""
    body = base.position_at(instants)[:, :2]
    heading = base.angles_at(instants)[:, 2] + FORWARD_ANGLES[forward_axis]
    points, load = feet_down(instants, feet)
    polygon = (np.isfinite(points[:, :, 0]).sum(axis=1) >= FEWEST_FEET) & np.isfinite(body[:, 0])
    margin = margin_in_hull(points, body)
    pressure = centre_of_pressure(points, load)
    ahead, left = along_heading(pressure - body, heading)
    return margin, polygon, ahead, left


def feet_down(instants: Ints, feet: Sequence[FootRecord]) -> tuple[Floats, Floats]:
    """Tell where each foot stands at some instants, and what it carries there.

    Args:
        instants: (n,) ns.
        feet: records of all feet.

    Returns:
        (n, feet, 2) m, contact points seen from above, NaN where a foot is not down; and
        (n, feet) N, vertical force, 0 where a foot is not down or it is not known.
    """
    points = np.full((len(instants), len(feet), 2), np.nan)
    load = np.zeros((len(instants), len(feet)))
    for column, foot in enumerate(feet):
        row, near = _nearest(foot.track.time, instants)
        down = near & timespans.covers(foot.in_contact, instants)
        point = foot.track.point[row, :2]
        usable = down & np.isfinite(point).all(axis=1)
        points[usable, column] = point[usable]
        load[usable, column] = np.maximum(np.nan_to_num(foot.track.vertical_force[row[usable]]), 0)
    return points, load


def _nearest(time: Ints, instants: Ints) -> tuple[Ints, Flags]:
    """(n,) row nearest to each instant, and whether it is near enough."""
    after = np.clip(np.searchsorted(time, instants), 1, max(len(time) - 1, 1))
    after = np.minimum(after, len(time) - 1)
    before = np.maximum(after - 1, 0)
    later = np.abs(time[after] - instants) < np.abs(time[before] - instants)
    row = np.where(later, after, before)
    near: Flags = np.abs(time[row] - instants) <= NEAR_NS
    return row, near


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


@dataclass(frozen=True, slots=True)
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


def margin_in_hull(points: Floats, body: Floats) -> Floats:
    """Return the signed distance of a point to the edge of the convex hull of some others.

    Args:
        points: (n, feet, 2) m; NaN where a foot is not down.
        body: (n, 2) m.

    Returns:
        (n,) m, positive inside, NaN where the points span no area.
    """
    return margin_in(hulls(points), body)


@np.errstate(over="ignore", invalid="ignore", divide="ignore")
def margin_in(hull: Hulls, body: Floats) -> Floats:
    """See `margin_in_hull`."""
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
