"""Swings of a foot: its way in the world, above the line between its footfalls."""

from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Flags, Floats, Ints, median_of
from dogbot_logtool.core.base.poses import BaseHistory
from dogbot_logtool.core.contact.stances import Cut, Stances
from dogbot_logtool.core.gait.cycle_curves import CYCLE_POINTS, CycleCurve, cycle_curve
from dogbot_logtool.core.gait.strides import Strides
from dogbot_logtool.core.legs.foot_path import FootPath
from dogbot_logtool.core.legs.silences import silent_before, unbroken
from dogbot_logtool.core.rotations import from_roll_pitch_yaw, rotate
from dogbot_logtool.dataclass import dataclass

MIDDLE: Final = (0.2, 0.8)
"""Shares of a stance between which the foot is loaded and should be at rest."""
APPROACH_S: Final = 0.03
"""s before a touchdown that its velocity is taken from."""
FEWEST_ROWS: Final = 4
"""Rows of the path that its velocity is taken from."""
SHORTEST_STEP_M: Final = 0.05
"""m: a shorter swing does not tell the direction of walking."""
RESTING_M: Final = 0.02
"""m that a foot's frame may move in the middle of a stance, or `RESTING_SHARE` of its swing."""
RESTING_SHARE: Final = 0.15
_SEEN: Final = (Cut.WHOLE, Cut.LOG_START, Cut.LOG_END, Cut.STANDING)
"""Stances between whose ends the foot is known to stand."""
SLOWEST_NS: Final = 11_000_000
"""ns: a foot that is told less often has no velocity at touchdown."""


@dataclass(frozen=True, slots=True)
class WorldPath:
    """The point of a foot in the world."""

    time: Ints
    """(n,) ns, strictly increasing."""
    position: Floats
    """(n, 3) m."""
    broken: Flags
    """(n,) whether a silence lies between a row and the one before."""

    def at(self, time: Ints) -> Floats:
        """Interpolate linearly; (m, 3) m, NaN in silences and outside."""
        if len(self.time) == 0:
            return np.full((len(time), 3), np.nan)
        after = np.clip(np.searchsorted(self.time, time), 1, max(len(self.time) - 1, 1))
        after = np.minimum(after, len(self.time) - 1)
        before = np.maximum(after - 1, 0)
        step = np.maximum(self.time[after] - self.time[before], 1)
        share = ((time - self.time[before]) / step)[:, None]
        position = self.position[before] + share * (self.position[after] - self.position[before])
        outside = (time < self.time[0]) | (time > self.time[-1]) | self.broken[after]
        position[outside] = np.nan
        return np.asarray(position)

    @property
    def is_slow(self) -> bool:
        """Whether the path is told too rarely for velocities."""
        return len(self.time) < 2 or float(median_of(np.diff(self.time))) > SLOWEST_NS

    def unbroken(self, start: Ints, end: Ints) -> Flags:
        """(m,) whether the path is known all the way between two times each."""
        if len(self.time) == 0:
            return np.zeros(len(start), np.bool_)
        known: Flags = unbroken(self.time, self.broken, start, end) & (start >= self.time[0])
        return known


def world_path(path: FootPath, base: BaseHistory) -> WorldPath:
    """Place the way of a foot in the world by the base's poses; times without one are left out."""
    origin = base.position_at(path.time)
    turn = from_roll_pitch_yaw(base.angles_at(path.time))
    position = origin + rotate(turn, path.position.astype(np.float64))
    known = np.isfinite(position).all(axis=1)
    time, position = path.time[known], position[known]
    return WorldPath(time, position, silent_before(time))


@dataclass(frozen=True, slots=True)
class Footfalls:
    """Position of a foot in each of its stances."""

    position: Floats
    """(stances, 3) m, in the middle of the stance; NaN where not known."""
    travel_m: Floats
    """(stances,) m, distance between its positions at 20 % and 80 % of the stance."""
    slip_m: Floats
    """(stances,) m, the same on the ground only; also `largest_slip_m`, the furthest that it is
    in between from where it is at 20 %."""
    largest_slip_m: Floats


def footfalls(path: WorldPath, stances: Stances) -> Footfalls:
    """Return where a foot stands, by the point of its frame."""
    duration = stances.liftoff - stances.touchdown
    steps = np.linspace(*MIDDLE, 13)
    time = stances.touchdown[:, None] + np.rint(duration[:, None] * steps).astype(np.int64)
    position = _positions(path, time)
    position[~path.unbroken(time[:, 0], time[:, -1])] = np.nan
    position[~np.isin(stances.cut, _SEEN)] = np.nan
    way = position - position[:, :1]
    flat = np.hypot(way[:, :, 0], way[:, :, 1])
    return Footfalls(
        position=position[:, len(steps) // 2],
        travel_m=np.sqrt((way[:, -1] ** 2).sum(axis=1)),
        slip_m=flat[:, -1],
        largest_slip_m=flat.max(axis=1, initial=0.0),
    )


@dataclass(frozen=True, slots=True)
class Swings:
    """Swings of a foot's whole strides, (strides,) each; NaN where not known."""

    clearance_m: Floats
    """m, highest point above the line between the footfalls before and after."""
    length_m: Floats
    """m, horizontal distance of those."""
    touchdown_down_mps: Floats
    """m/s, downward velocity before the touchdown that ends the swing."""
    touchdown_along_mps: Floats
    """m/s, horizontal speed there."""
    height: CycleCurve | None
    """m above that line, over the stride."""
    is_slow: bool = False
    """Whether the foot is told too rarely for velocities."""


def no_swings(count: int) -> Swings:
    """Return swings of which nothing is known."""
    unknown = np.full(count, np.nan)
    return Swings(unknown, unknown, unknown, unknown, None)


def swings(
    path: WorldPath, stood: Footfalls, strides: Strides, contact_interval_s: float
) -> Swings:
    """Return the figures of a foot's swings.

    Args:
        path: of the foot in the world.
        stood: its footfalls, by stance.
        strides: of the foot, whose stances have one after them.
        contact_interval_s: s between its contact samples: touchdowns may be so much earlier.
    """
    count = len(strides.stance)
    if count == 0 or len(path.time) == 0:
        return no_swings(count)
    before, after = stood.position[strides.stance], stood.position[strides.stance + 1]
    known = path.unbroken(strides.touchdown, strides.end)
    known &= np.isfinite(before).all(axis=1) & np.isfinite(after).all(axis=1)
    phase = np.linspace(0.0, 1.0, CYCLE_POINTS)
    period = (strides.end - strides.touchdown)[:, None]
    time = strides.touchdown[:, None] + np.rint(period * phase).astype(np.int64)
    height = _above_line(_positions(path, time), before[:, None], after[:, None])
    way = after - before
    velocity = _approach(path, strides, contact_interval_s)
    return Swings(
        clearance_m=_clearance(path, strides, before, after, known),
        length_m=np.where(known, np.hypot(way[:, 0], way[:, 1]), np.nan),
        touchdown_down_mps=-velocity[:, 2],
        touchdown_along_mps=np.hypot(velocity[:, 0], velocity[:, 1]),
        height=cycle_curve(100.0 * phase, height[known]),
        is_slow=path.is_slow or contact_interval_s * 1e9 > SLOWEST_NS,
    )


def _clearance(
    path: WorldPath, strides: Strides, before: Floats, after: Floats, known: Flags
) -> Floats:
    """(strides,) m, highest point of each swing that is known above the line of footfalls."""
    clearance = np.full(len(before), np.nan)
    first = np.searchsorted(path.time, strides.liftoff)
    number = np.searchsorted(path.time, strides.end) - first
    swing = np.flatnonzero(known & (number > 0))
    if not len(swing):
        return clearance
    number = number[swing]
    begin = np.cumsum(number) - number
    owner = np.repeat(swing, number)
    rows = np.arange(len(owner)) + np.repeat(first[swing] - begin, number)
    height = _above_line(path.position[rows], before[owner], after[owner])
    clearance[swing] = np.maximum.reduceat(height, begin)
    return clearance


def _above_line(position: Floats, before: Floats, after: Floats) -> Floats:
    """Return how high points lie above the line between two footfalls; shapes broadcast, m."""
    way = after - before
    squared = way[..., 0] ** 2 + way[..., 1] ** 2
    since = position - before
    along = since[..., 0] * way[..., 0] + since[..., 1] * way[..., 1]
    share = np.where(squared > 1e-6, along / np.maximum(squared, 1e-6), 0.5)
    height: Floats = since[..., 2] - np.clip(share, 0.0, 1.0) * way[..., 2]
    return height


def _approach(path: WorldPath, strides: Strides, contact_interval_s: float) -> Floats:
    """(n, 3) m/s, velocity of the foot when it was last known to be in the air.

    It is the slope there of the parabola that fits the path's last rows, `APPROACH_S` of them but
    at least four. NaN where path or contacts are told too rarely, or the swing is shorter.
    """
    count = len(strides.end)
    velocity = np.full((count, 3), np.nan)
    if path.is_slow or contact_interval_s * 1e9 > SLOWEST_NS:
        return velocity
    interval = float(median_of(np.diff(path.time)))
    rows = max(FEWEST_ROWS, round(APPROACH_S * 1e9 / interval))
    aloft = strides.end - round(contact_interval_s * 1e9)
    last = np.searchsorted(path.time, aloft, side="right") - 1
    chosen = last[:, None] + np.arange(1 - rows, 1)
    known = chosen[:, 0] >= 0
    chosen = np.maximum(chosen, 0)
    known &= path.time[chosen[:, 0]] >= strides.liftoff
    known &= ~path.broken[chosen[:, 1:]].any(axis=1) & (aloft - path.time[last] <= 2 * interval)
    since_s = (path.time[chosen[known]] - aloft[known, None]) / 1e9
    slope = np.linalg.pinv(np.stack([since_s**0, since_s, since_s**2], axis=-1))[:, 1]
    velocity[known] = np.einsum("nt,ntc->nc", slope, path.position[chosen[known]])
    return velocity


def _positions(path: WorldPath, time: Ints) -> Floats:
    """(n, t, 3) m, positions of the foot at (n, t) times."""
    return path.at(time.ravel()).reshape(*time.shape, 3)


@dataclass(frozen=True, slots=True)
class Steps:
    """Steps of a foot against the other one of its pair, (strides,) each; NaN where not known."""

    length_m: Floats
    """m along the foot's own swing, from the other foot's footfall."""
    width_m: Floats
    """m across it."""


def steps(strides: Strides, stood: Footfalls, other: Footfalls, other_stances: Stances) -> Steps:
    """Return the steps that a foot's swings end with.

    Args:
        strides: of the foot.
        stood: its footfalls, by stance.
        other: those of the other foot.
        other_stances: of the other foot.
    """
    before, after = stood.position[strides.stance], stood.position[strides.stance + 1]
    row = np.searchsorted(other_stances.touchdown, strides.end) - 1
    there = np.full((len(row), 3), np.nan)
    there[row >= 0] = other.position[row[row >= 0]]
    way, step = (after - before)[:, :2], (after - there)[:, :2]
    length = np.hypot(way[:, 0], way[:, 1])
    length[~(length >= SHORTEST_STEP_M)] = np.nan
    along = (step * way).sum(axis=1) / length
    across = np.abs(step[:, 0] * way[:, 1] - step[:, 1] * way[:, 0]) / length
    return Steps(along, across)
