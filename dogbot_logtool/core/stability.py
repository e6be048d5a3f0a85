"""Does the robot stand safely on the feet that are down? Support polygon, margins, pressure."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Flags, Floats, Ints, aggregate, concatenated, nearest_rows
from dogbot_logtool.core.base.motion import FORWARD_ANGLES
from dogbot_logtool.core.base.poses import BaseHistory
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.contact.track import POINT_RATE_HZ
from dogbot_logtool.core.corrections.clock import first_at_each_tick
from dogbot_logtool.core.hulls import NEAR_NS, Hulls, centre_of_pressure, hulls, margin_in
from dogbot_logtool.core.metrics import Stability
from dogbot_logtool.core.rotations import along_heading

FEWEST_FEET: Final = 3
"""Feet that span a polygon."""
AT_BASE: Final = (0.0, 0.0, 0.0)
"""m, a centre of mass at the base's frame."""
_CHUNK_NUMBERS: Final = 500_000
"""Pairs of feet, times instants, that are looked at in one go."""


@dataclass(frozen=True, slots=True)
class Unstable:
    """Time in which there is a support polygon and the static margin is negative."""

    spans: Ints
    """(b, 2) ns."""
    least_margin_m: Floats
    """(b,) m, the least margin in each of them."""


@dataclass(frozen=True, slots=True)
class _Instants:
    """Base and feet at n instants."""

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
    ahead: Floats
    """(n,) m, centre of pressure ahead of the base; NaN where not known; also `left`."""
    left: Floats


def stability(
    feet: Sequence[FootHistory],
    base: BaseHistory,
    forward_axis: str,
    *,
    vertical_known: bool,
    height_known: bool = True,
    com_offset_m: Sequence[float] = AT_BASE,
    within: Ints | None = None,
) -> tuple[Stability, Unstable] | None:
    """Measure static stability; None where feet and base have no time in common.

    Each of up to 100 instants a second speaks for the same part of the known time.

    Args:
        feet: records of all feet.
        base: poses.
        forward_axis: the body's axis that points forward.
        vertical_known: whether vertical forces are known; else there is no centre of pressure.
        height_known: whether the base's height over the feet is known.
        com_offset_m: m, the centre of mass from the base's frame, in its axes.
        within: (w, 2) ns, a part of the log; None: all of it.
    """
    if within is None:
        times = [each for foot in feet for each in (foot.start, foot.end) if each is not None]
        times += [int(each) for each in base.time[[0, -1]]] if len(base.time) else []
        within = np.array([[min(times), max(times)]] if times else [], np.int64).reshape(-1, 2)
    known = timespans.intersect([base.known, *(foot.known for foot in feet), within])
    found = _instants(feet, base, known, forward_axis, com_offset_m)
    if found is None:
        return None
    known_share = timespans.total(known) / max(timespans.total(within), 1)
    unstable, placed = found.polygon & (found.margin < 0.0), found.placed
    margins = aggregate(found.margin)
    undefined = known_share * float((placed & ~found.polygon).mean())
    measured = Stability(
        static_margin_m=margins,
        energy_margin_m=aggregate(found.energy) if height_known else None,
        unstable_fraction=known_share * float(unstable.mean()) if margins else None,
        undefined_fraction=undefined if placed.any() else None,
        unknown_fraction=1.0 - known_share * float(placed.mean()),
        centre_of_pressure_forward_m=aggregate(found.ahead) if vertical_known else None,
        centre_of_pressure_left_m=aggregate(found.left) if vertical_known else None,
    )
    return measured, _unstable(found.time, np.where(unstable, found.margin, 0.0))


def margins(
    feet: Sequence[FootHistory], base: BaseHistory, com_offset_m: Sequence[float] = AT_BASE
) -> tuple[Ints, Floats]:
    """Return the static margin at up to 100 Hz, over the time in which base and feet are known.

    Args:
        feet: records of all feet.
        base: poses.
        com_offset_m: m, the centre of mass from the base's frame, in its axes.

    Returns:
        (n,) ns and (n,) m, NaN where there is no polygon, or some foot's place is not known.
    """
    known = timespans.intersect([base.known, *(foot.known for foot in feet)])
    found = _instants(feet, base, known, "+x", com_offset_m)
    return (np.empty(0, np.int64), np.empty(0)) if found is None else (found.time, found.margin)


def _unstable(instants: Ints, margin: Floats) -> Unstable:
    """Find the spans with a negative margin.

    An instant speaks for the time until the next one, if that is near.
    """
    near = np.diff(instants) <= 2 * NEAR_NS
    spans = timespans.spans_where(instants, (margin[:-1] < 0.0) & near)
    rows = np.searchsorted(instants, spans)
    least = [margin[first:last].min() for first, last in rows.tolist()]
    return Unstable(spans, np.array(least, np.float64))


def instants_of(foot: FootHistory, known: Ints) -> Ints:
    """(n,) ns: up to `POINT_RATE_HZ` samples a second of a foot, in spans, (k, 2) ns."""
    time = foot.track.time[timespans.covers(known, foot.track.time)]
    return time[first_at_each_tick(time, POINT_RATE_HZ)]


def _instants(
    feet: Sequence[FootHistory],
    base: BaseHistory,
    known: Ints,
    forward_axis: str,
    com_offset_m: Sequence[float],
) -> _Instants | None:
    """Measure at the first foot's samples in the known time; None without any."""
    time = instants_of(feet[0], known) if feet and len(base.time) else np.empty(0, np.int64)
    chunk = max(_CHUNK_NUMBERS // max(len(feet), 1) ** 2, 1)
    parts = [
        _at(time[start : start + chunk], feet, base, FORWARD_ANGLES[forward_axis], com_offset_m)
        for start in range(0, len(time), chunk)
    ]
    return concatenated(parts) if parts else None


def _at(
    time: Ints,
    feet: Sequence[FootHistory],
    base: BaseHistory,
    forward_rad: float,
    com_offset_m: Sequence[float],
) -> _Instants:
    """Measure at some instants, (n,) ns."""
    body = base.point_at(time, np.array(com_offset_m, np.float64))
    points, load = feet_down(time, feet)
    hull, standing = hulls(points[:, :, :2]), np.isfinite(points[:, :, 0])
    down = np.stack([timespans.covers(foot.in_contact, time) for foot in feet], axis=1)
    placed = (standing == down).all(axis=1) & np.isfinite(body[:, 0])
    pressure = centre_of_pressure(points[:, :, :2], load) - base.position_at(time)[:, :2]
    ahead, left = along_heading(pressure, base.angles_at(time)[:, 2] + forward_rad)
    return _Instants(
        time,
        placed,
        np.where(placed, margin_in(hull, body[:, :2]), np.nan),
        np.where(placed, energy_margin_in(hull, points, body), np.nan),
        placed & (standing.sum(axis=1) >= FEWEST_FEET),
        np.where(placed, ahead, np.nan),
        np.where(placed, left, np.nan),
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
def energy_margin_in(hull: Hulls, points: Floats, body: Floats) -> Floats:
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

    Returns:
        (n,) m; NaN where the points span no area, or the body's ground projection is outside.
    """
    lowest = np.full(len(body), np.inf)
    inside = hull.area.copy()
    for first, second in np.argwhere(hull.edge.any(axis=2)).tolist():
        edge = hull.edge[first, second]
        along, away = points[:, second] - points[:, first], body - points[:, first]
        inside &= ~edge | (along[:, 0] * away[:, 1] - along[:, 1] * away[:, 0] >= 0.0)
        length = np.linalg.norm(along, axis=1)
        unit = along / np.where(length > 0.0, length, 1.0)[:, None]
        reach = away - (away * unit).sum(axis=1)[:, None] * unit
        highest = np.linalg.norm(reach, axis=1) * np.hypot(unit[:, 0], unit[:, 1])
        lowest = np.where(edge, np.minimum(lowest, highest - reach[:, 2]), lowest)
    return np.where(inside, lowest, np.nan)


@dataclass(frozen=True, slots=True)
class GroundPoints:
    """Points on the ground over time."""

    time: Ints
    """(n,) ns, strictly increasing."""
    point: Floats
    """(n, 2) m, horizontal, world frame."""


def footprints(foot: FootHistory) -> GroundPoints:
    """Return where a foot stood: its first known contact point of each stance.

    Stances without any are left out. The times are those of touchdown.
    """
    touchdown, liftoff = foot.stances.touchdown, foot.stances.liftoff
    time, point = foot.track.contact_points
    first = np.searchsorted(time, touchdown)
    seen = first < np.searchsorted(time, liftoff)
    return GroundPoints(touchdown[seen], point[first[seen], :2])


def pressure_path(feet: Sequence[FootHistory]) -> GroundPoints:
    """Return the centre of pressure, sum(Fz p) / sum(Fz), at up to 100 Hz.

    Only over the time known to all feet: without one of them it would be that of the others.
    Its points are NaN where no foot is loaded.

    Args:
        feet: records of all feet, whose vertical forces must be known.
    """
    if not feet:
        return GroundPoints(np.empty(0, np.int64), np.empty((0, 2)))
    known = timespans.intersect([foot.vertical_known for foot in feet])
    time = instants_of(feet[0], known)
    points, load = feet_down(time, feet)
    return GroundPoints(time, centre_of_pressure(points[:, :, :2], load))
