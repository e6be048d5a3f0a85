"""Does the robot stand safely on the feet that are down? Support polygon and static margin."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from dogbot_logtool.core.base.base_motion import FORWARD_ANGLES, along_heading
from dogbot_logtool.core.base.base_record import BaseRecord
from dogbot_logtool.core.contact.foot_history import FootRecord
from dogbot_logtool.core.geometry import timespans
from dogbot_logtool.core.geometry.aggregates import Aggregate, aggregate
from dogbot_logtool.core.geometry.arrays import Flags, Floats, Ints
from dogbot_logtool.core.geometry.support_polygon import NEAR_NS, centre_of_pressure, margin_in_hull

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
