"""How high the body must be lifted to tip over an edge of the support polygon."""

import numpy as np

from dogbot_logtool.core.geometry.arrays import Floats
from dogbot_logtool.core.geometry.support_polygon import hulls


@np.errstate(over="ignore", invalid="ignore")
def energy_margin_m(points: Floats, body: Floats) -> Floats:
    """Return the energy stability margin over the weight.

    The robot tips over an edge of its support polygon when its centre of gravity turns about that
    edge until it is highest; the margin is the rise to there, for the edge where that is least.
    With r the way from the edge to the centre of gravity, at a right angle to the edge, and u the
    part of the vertical at a right angle to it, that is |r| |u| - r.z, on slopes and on uneven
    ground (Messuri and Klein 1985, IEEE J. Robotics and Automation 1:132, as a height).

    Args:
        points: (n, feet, 3) m, where feet stand; NaN where a foot is not down.
        body: (n, 3) m, the centre of gravity, in the same world.

    Returns:
        (n,) m; NaN where the points span no area, or the body's ground projection is outside.
    """
    hull = hulls(points[:, :, :2])
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
