"""Does the robot stand safely on the feet that are down? Support polygon, margins, pressure."""

from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Flags, Floats, Ints, aggregate, nearest_rows, norms
from dogbot_logtool.core.base.poses import BaseHistory
from dogbot_logtool.core.clock import first_at_each_tick
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.contact.stances import POINT_RATE_HZ
from dogbot_logtool.core.metrics import Stability
from dogbot_logtool.core.rotations import along_heading

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


class Hulls(NamedTuple):
    """Convex hulls of the feet that are down, seen from above."""

    point: Floats
    """(2, feet, n) m; NaN where a foot is not down."""
    following: Ints
    """(feet, n) the next corner, counter-clockwise, from a foot on the hull's edge; -1: it is not.
    Two feet, or the ends of a row of feet, follow each other."""
    area: Flags
    """(n,) whether the feet span an area."""


@np.errstate(over="ignore", invalid="ignore")
def hulls(points: Floats) -> Hulls:
    """Find the convex hull of some points.

    A pair of points is an edge of the hull where no other point lies to the right of the line
    through them: for the few feet that a robot has, trying all pairs is the plainest way. Of the
    points in a row along an edge, the furthest is the next corner.

    Args:
        points: (n, feet, 2) m; NaN where a foot is not down.
    """
    point = np.ascontiguousarray(points.T)
    longest, area = np.zeros(point.shape[1:]), np.zeros(len(points), np.bool_)
    following = np.full(longest.shape, -1)
    for first, corner in enumerate(point.swapaxes(0, 1)):
        away = point - corner[:, None]
        for second, along in enumerate(away.swapaxes(0, 1)):
            sides = _cross(along[:, None], away)
            edge = ~(sides < 0.0).any(axis=0)
            area |= edge & (sides > 0.0).any(axis=0)
            length = along[0] * along[0] + along[1] * along[1]
            further = edge & (length > longest[first])
            longest[first, further], following[first, further] = length[further], second
    return Hulls(point, following, area)


@np.errstate(over="ignore", invalid="ignore", divide="ignore")
def margin_in(hull: Hulls, body: Floats) -> Floats:
    """Return the signed distance of a point to the edge of the convex hull of some others.

    Args:
        hull: of n times.
        body: (n, 2) m.

    Returns:
        (n,) m, positive inside, NaN where the points span no area.
    """
    along = np.take_along_axis(hull.point, hull.following[None], axis=1) - hull.point
    to, is_edge = body.T[:, None] - hull.point, hull.following >= 0
    inside = (~is_edge | (_cross(along, to) >= 0.0)).all(axis=0)
    share = (along * to).sum(axis=0) / (along * along).sum(axis=0)
    away = to - np.clip(share, 0.0, 1.0) * along
    distance = np.where(is_edge, np.hypot(*away), np.inf).min(axis=0, initial=np.inf)
    return np.where(hull.area, np.where(inside, distance, -distance), np.nan)


def _cross(along: Floats, to: Floats) -> Floats:
    """Twice the signed area of the triangle: positive where the one turns left to the other."""
    signed: Floats = along[0] * to[1] - along[1] * to[0]
    return signed


FEWEST_FEET: Final = 3
"""Feet that span a polygon."""


class Instants(NamedTuple):
    """Base and feet at n instants, up to 100 a second, of the time that is known of all of them."""

    extent: Ints
    """(1, 2) ns, from the first time of base and feet to the last; also `known`, (k, 2) ns."""
    known: Ints
    time: Ints
    """(n,) ns."""
    placed: Flags
    """(n,) whether the base and every foot that is down have a known place."""
    margin: Floats
    """(n,) m, static margin; NaN without a polygon, and where not all is placed."""
    energy: Floats
    """(n,) m, energy margin, likewise."""
    polygon: Flags
    """(n,) whether all is placed, and enough feet are down."""
    pressure: Floats
    """(n, 2) m, centre of pressure in the world; NaN where not known."""
    ahead: Floats
    """(n,) m, the same ahead of the base; also `left` of it."""
    left: Floats

    def unstable(self) -> tuple[Ints, Floats]:
        """(b, 2) ns, spans with a negative static margin, and (b,) m, the least in each.

        An instant speaks for the time until the next one, if that is near.
        """
        near = np.diff(self.time) <= 2 * NEAR_NS
        below = np.where(self.polygon & (self.margin < 0.0), self.margin, 0.0)
        spans = timespans.spans_where(self.time, (below[:-1] < 0.0) & near)
        rows = np.searchsorted(self.time, spans).tolist()
        return spans, np.array([below[first:last].min() for first, last in rows], np.float64)


def stability(
    found: Instants, within: Ints, *, vertical_known: bool, height_known: bool
) -> Stability | None:
    """Measure static stability; each instant speaks for the same part of the known time.

    Args:
        found: base and feet.
        within: (w, 2) ns, a part of the log.
        vertical_known: whether vertical forces are known; else there is no centre of pressure.
        height_known: whether the base's height over the feet is known.

    Returns:
        None without any instant.
    """
    spans = timespans.intersect([found.extent, within])
    rows = timespans.covers(spans, found.time)
    if not rows.any():
        return None
    known_ns = timespans.total(timespans.intersect([found.known, spans]))
    known_share = known_ns / max(timespans.total(spans), 1)
    placed, polygon = found.placed[rows], found.polygon[rows]
    margins = aggregate(found.margin[rows])
    unstable = polygon & (found.margin[rows] < 0.0)
    undefined = known_share * float((placed & ~polygon).mean())
    return Stability(
        static_margin_m=margins,
        energy_margin_m=aggregate(found.energy[rows]) if height_known else None,
        unstable_fraction=known_share * float(unstable.mean()) if margins else None,
        undefined_fraction=undefined if placed.any() else None,
        unknown_fraction=1.0 - known_share * float(placed.mean()),
        centre_of_pressure_forward_m=aggregate(found.ahead[rows]) if vertical_known else None,
        centre_of_pressure_left_m=aggregate(found.left[rows]) if vertical_known else None,
    )


def instants(
    feet: Sequence[FootHistory],
    base: BaseHistory,
    forward_rad: float,
    com_offset_m: Sequence[float],
) -> Instants | None:
    """Place base and feet at the first foot's samples; None where they have no time in common.

    Args:
        feet: records of all feet.
        base: poses.
        forward_rad: from the body's x axis to the axis that points forward.
        com_offset_m: m, the centre of mass from the base's frame, in its axes.
    """
    if not feet or not len(base.time):
        return None
    times = [each for foot in feet for each in (foot.start, foot.end) if each is not None]
    times += base.time[[0, -1]].tolist()
    known = timespans.intersect([base.known, *(foot.known for foot in feet)])
    sampled = feet[0].track.time[timespans.covers(known, feet[0].track.time)]
    time = sampled[first_at_each_tick(sampled, POINT_RATE_HZ)]
    if not len(time):
        return None
    body = base.point_at(time, np.array(com_offset_m, np.float64))
    points, load = feet_down(time, feet)
    hull, standing = hulls(points[:, :, :2]), np.isfinite(points[:, :, 0])
    down = np.stack([timespans.covers(foot.in_contact, time) for foot in feet], axis=1)
    placed = (standing == down).all(axis=1) & np.isfinite(body[:, 0])
    margin = np.where(placed, margin_in(hull, body[:, :2]), np.nan)
    pressure = centre_of_pressure(points[:, :, :2], load)
    away = pressure - base.position_at(time)[:, :2]
    ahead, left = along_heading(away, base.yaw_at(time) + forward_rad).T
    return Instants(
        extent=np.array([[min(times), max(times)]], np.int64),
        known=known,
        time=time,
        placed=placed,
        margin=margin,
        energy=energy_margin_in(hull, points, body, margin),
        polygon=placed & (standing.sum(axis=1) >= FEWEST_FEET),
        pressure=pressure,
        ahead=np.where(placed, ahead, np.nan),
        left=np.where(placed, left, np.nan),
    )


def feet_down(instants: Ints, feet: Sequence[FootHistory]) -> tuple[Floats, Floats]:
    """Tell where each foot stands at some instants, and what it carries there.

    Args:
        instants: (n,) ns.
        feet: records of all feet.

    Returns:
        (n, feet, 3) m, contact points, NaN where a foot is not down; and
        (n, feet) N, vertical force, 0 where a foot is not down or it is not known.
        A foot that is down stands at its nearest known contact point.
    """
    points = np.full((len(instants), len(feet), 3), np.nan)
    load = np.zeros((len(instants), len(feet)))
    for column, foot in enumerate(feet):
        track, down = foot.track, timespans.covers(foot.in_contact, instants)
        # A bounce, or the row beside a touchdown, has no point; the stance has.
        time, point = track.contact_points
        if not len(time):
            continue
        row = nearest_rows(time, instants)
        near = down & (np.abs(time[row] - instants) <= NEAR_NS)
        points[near, column] = point[row[near]]
        row = nearest_rows(track.time, instants)
        near &= np.abs(track.time[row] - instants) <= NEAR_NS
        load[near, column] = np.maximum(np.nan_to_num(track.vertical_force[row[near]]), 0.0)
    return points, load


@np.errstate(over="ignore", invalid="ignore")
def energy_margin_in(hull: Hulls, points: Floats, body: Floats, static: Floats) -> Floats:
    """Return the energy stability margin over the weight.

    The robot tips over an edge of its support polygon when its centre of gravity turns about that
    edge until it is highest; the margin is the rise to there, for the edge where that is least.
    With r the way from the edge to the centre of gravity, at a right angle to the edge, and u the
    part of the vertical at a right angle to it, that is |r| |u| - r.z, on slopes and on uneven
    ground (Messuri and Klein 1985, IEEE J. Robotics and Automation 1:132, as a height).

    Args:
        hull: of the feet seen from above.
        points: (n, feet, 3) m, where feet stand; NaN where a foot is not down.
        body: (n, 3) m, the centre of gravity, in the same world.
        static: (n,) m, its static margin.

    Returns:
        (n,) m; NaN where the points span no area, or the body's ground projection is outside.
    """
    first, row = np.nonzero(hull.following >= 0)
    start, end = points[row, first], points[row, hull.following[first, row]]
    along, away = end - start, body[row] - start
    unit = along / norms(along)[:, None]
    reach = away - np.einsum("ij,ij->i", away, unit)[:, None] * unit
    least = np.full(len(body), np.inf)
    np.minimum.at(least, row, norms(reach) * np.hypot(unit[:, 0], unit[:, 1]) - reach[:, 2])
    return np.where(static >= 0.0, least, np.nan)
