"""The scene of `/support`: support polygon, centre of pressure, ground projection, touchdowns.

Where no transforms tell how the legs bend, lines go from the body to the feet that stand.
Definitions are those of `hulls.py`; the state of the feet is that of `feet.py`. What is not known
is left out. While the contact or the contact point of some foot is unknown, there is neither a
polygon nor a centre of pressure.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Float32s, Floats, Ints, all_finite, mean_of_known
from dogbot_logtool.core.base.poses import Odometry
from dogbot_logtool.core.rotations import normalised, rotate
from dogbot_logtool.core.scene.feet import TRAIL, DrawnFoot, colour_parts, foot_colour
from dogbot_logtool.core.stability import Hulls, centre_of_pressure, hulls, margin_in

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


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class SupportScene:
    """The support of the robot at some times."""

    log_time: Ints
    """(n,) ns."""
    stamp: Ints
    """(n,) ns."""
    outline: Floats
    """(n, feet + 1, 3) m, world frame: the support polygon's corners at the heights of their
    contact points, counter-clockwise and closed; two points where two feet, or feet in a row,
    make a line. NaN after the last, and throughout where there is none."""
    colour: Float32s
    """(n, 4) of the outline: red, green, blue, alpha in [0, 1]."""
    pressure: Floats
    """(n, 1, 3) m, centre of pressure; NaN where it is not known."""
    projection: Floats
    """(n, 1, 3) m, the base's ground projection; NaN where the ground's height is not known."""
    touchdowns: Floats
    """(n, feet * TRAIL, 3) m, the latest touchdowns of all feet; NaN after the last one."""
    tints: Floats
    """(n, feet * TRAIL, 3) red, green, blue of the foot of each touchdown."""
    unknown: int
    """Times at which the contact or the contact point of some foot is unknown."""
    unweighed: int
    """Times at which those are known, but not the vertical force on a foot that is down."""


@np.errstate(over="ignore", invalid="ignore")
def support_scene(
    poses: Odometry, feet: Sequence[DrawnFoot], com_offset_m: Sequence[float]
) -> SupportScene:
    """Compute what the robot stands on.

    Args:
        poses: of the base, (n), at the wanted times.
        feet: all feet of the robot.
        com_offset_m: m, the centre of mass from the base's frame, in its axes.
    """
    offset = np.array([com_offset_m], np.float64)
    body = poses.position + rotate(normalised(poses.orientation), offset)
    known, down, point, vertical = (
        np.stack(column, axis=1)
        for column in zip(*(foot.at(poses.log_time) for foot in feet), strict=True)
    )
    has_point = all_finite(point.reshape(-1, 3)).reshape(down.shape)
    all_known = (known & (has_point | ~down)).all(axis=1)
    points = np.where((down & has_point)[:, :, None], point, np.nan)
    in_use = np.where(all_known[:, None, None], points, np.nan)
    hull = hulls(in_use[:, :, :2])
    # A foot that pulls does not move the centre of pressure, as in `stats`.
    load = np.where(down, np.maximum(vertical, 0.0), 0.0)
    weighed = np.isfinite(load).all(axis=1)
    pressure = centre_of_pressure(in_use, np.where((all_known & weighed)[:, None], load, 0.0))
    trails = np.stack([foot.trail_at(poses.log_time) for foot in feet], axis=1)
    # The ground is as high as the feet that stand or, without any, as the newest touchdowns.
    height = mean_of_known(points[:, :, 2])
    height = np.where(np.isnan(height), mean_of_known(trails[:, :, 0, 2]), height)
    touchdowns = trails.reshape(-1, len(feet) * TRAIL, 3)
    order = np.argsort(np.isnan(touchdowns[:, :, 0]), axis=1, kind="stable")
    tints = np.array([colour_parts(foot_colour(foot)) for foot in range(len(feet))])
    return SupportScene(
        log_time=poses.log_time,
        stamp=poses.time,
        outline=outlines(in_use, hull),
        colour=margin_colour(margin_in(hull, body[:, :2])),
        pressure=_known(pressure)[:, None],
        projection=_known(np.column_stack([body[:, :2], height]))[:, None],
        touchdowns=np.take_along_axis(touchdowns, order[:, :, None], axis=1),
        tints=tints[order // TRAIL],
        unknown=int((~all_known).sum()),
        unweighed=int((all_known & ~weighed).sum()),
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
    # The leftmost point is a corner, of several the one with the least y.
    x = np.where(np.isnan(hull.point[0]), np.inf, hull.point[0])
    first = np.where(x == x.min(axis=0), hull.point[1], np.inf).argmin(axis=0)
    row, corner, drawn = np.arange(count), first, (hull.following >= 0).any(axis=0)
    outline = np.full((count, feet + 1, 3), np.nan)
    for index in range(feet + 1):
        outline[drawn, index] = points[row, corner][drawn]
        closed = corner == first
        corner = hull.following[corner, row]
        # Back at the first corner the outline is closed; a line ends at its second point.
        drawn = drawn & ~closed if index > 0 else drawn
        drawn = drawn & (corner != first) if index == 1 else drawn
    return outline


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


def _known(points: Floats) -> Floats:
    """Return points, (n, 3), with NaN for those of which a number is not finite."""
    return np.where(all_finite(points)[:, None], points, np.nan)


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class LegLines:
    """The legs at some times."""

    log_time: Ints
    """(n,) ns."""
    stamp: Ints
    """(n,) ns."""
    ends: Floats
    """(n, feet, 2, 3) m, world frame: hip and contact point; NaN where the foot is not down, or
    where that or its position is not known."""


def leg_lines(poses: Odometry, feet: Sequence[DrawnFoot], hips: Floats) -> LegLines:
    """Return the legs that stand at the times of poses.

    Args:
        poses: usable ones of the base, (n).
        feet: all feet of the robot.
        hips: (feet, 3) m, base frame; NaN where not known.
    """
    ends = np.empty((len(poses.log_time), len(feet), 2, 3))
    turn = normalised(poses.orientation)
    for column, (foot, hip) in enumerate(zip(feet, hips, strict=True)):
        state = foot.at(poses.log_time)
        ends[:, column, 0] = poses.position + rotate(turn, hip[None])
        ends[:, column, 1] = state.point
        ends[~(state.down & state.known), column] = np.nan
    ends[~np.isfinite(ends).all(axis=(2, 3))] = np.nan
    return LegLines(poses.log_time, poses.time, ends)
