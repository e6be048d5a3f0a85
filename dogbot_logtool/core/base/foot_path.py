"""The point of a foot over time, by messages, transforms or joints."""

from typing import Final, NamedTuple

import numpy as np

from dogbot_logtool.core.arrays import (
    Flags,
    Float32s,
    Floats,
    Ints,
    all_finite,
    interpolated,
)
from dogbot_logtool.core.base.poses import BaseHistory
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.contact.stances import Cut, Stances
from dogbot_logtool.core.corrections.clock import advancing, first_at_each_tick
from dogbot_logtool.core.rotations import conjugate, from_roll_pitch_yaw, rotate

RATE_HZ: Final = 200.0
"""At which paths that messages tell are kept."""
LONGEST_STEP_S: Final = 0.1
"""s between two messages; a longer step is a silence, across which nothing is interpolated."""


def silent_before(time: Ints) -> Flags:
    """(n,) whether a silence lies between a row and the one before; time: (n,) ns."""
    silent: Flags = np.diff(time, prepend=time[:1]) > LONGEST_STEP_S * 1e9
    return silent


def unbroken(time: Ints, breaks: Flags, start: Ints, end: Ints) -> Flags:
    """Tell which spans rows cover to their ends, without a break between two of the rows.

    Args:
        time: (n,) ns, of the rows, increasing.
        breaks: (n,) whether one lies between a row and the one before.
        start: (m,) ns.
        end: (m,) ns.
    """
    if not len(time):
        return np.zeros(len(start), np.bool_)
    so_far = np.cumsum(breaks)
    first = np.searchsorted(time, start, side="right") - 1
    last = np.searchsorted(time, end, side="left")
    inside = (first >= 0) & (last < len(time))
    whole: Flags = inside & (so_far[np.minimum(last, len(time) - 1)] == so_far[first])
    return whole


class FootPath(NamedTuple):
    """The point of a foot over time, in the base's frame or in the world."""

    time: Ints
    """(n,) ns, strictly increasing."""
    position: Floats | Float32s
    """(n, 3) m."""
    broken: Flags
    """(n,) whether a silence lies between a row and the one before."""

    def at(self, time: Ints) -> Floats:
        """Interpolate linearly; time's shape and 3, m; NaN in silences and outside."""
        if len(self.time) == 0:
            return np.full((*time.shape, 3), np.nan)
        position = interpolated(time, self.time, self.position)
        after = np.minimum(np.searchsorted(self.time, time), len(self.time) - 1)
        outside = (time < self.time[0]) | (time > self.time[-1]) | self.broken[after]
        position[outside] = np.nan
        return position

    def unbroken(self, start: Ints, end: Ints) -> Flags:
        """(m,) whether the path is known all the way between two times each."""
        return unbroken(self.time, self.broken, start, end)

    def in_world(self, base: BaseHistory) -> "FootPath":
        """Place the path in the world by the base's poses; times without one are left out."""
        turn = from_roll_pitch_yaw(base.angles_at(self.time))
        position = base.position_at(self.time) + rotate(turn, self.position.astype(np.float64))
        return known_path(self.time, position)


def path_of(time: Ints, position: Floats | Float32s) -> FootPath:
    """Return the path of a foot by positions that messages tell, (n, 3) m; NaN: not known."""
    advances = advancing(time)
    rows = np.flatnonzero(advances)
    rows = rows[first_at_each_tick(time[rows], RATE_HZ)]
    return known_path(time[rows], position[rows])


def path_in_base(time: Ints, position: Floats | Float32s, base: BaseHistory) -> FootPath:
    """Return the path of a foot in the base's axes by its positions in the world, (n, 3) m."""
    turn = conjugate(from_roll_pitch_yaw(base.angles_at(time)))
    return path_of(time, rotate(turn, position.astype(np.float64) - base.position_at(time)))


def contact_path(foot: FootHistory) -> FootPath:
    """Return the path of a foot in the world by its contact points."""
    return known_path(*foot.track.contact_points)


def known_path(time: Ints, position: Floats | Float32s) -> FootPath:
    """Return the path of the times whose positions are known."""
    known = all_finite(position)
    return FootPath(time[known], position[known], silent_before(time[known]))


MIDDLE: Final = (0.2, 0.8)
"""Shares of a stance between which the foot is loaded and should be at rest."""


_SEEN: Final = (Cut.WHOLE, Cut.LOG_START, Cut.LOG_END, Cut.STANDING)
"""Stances between whose ends the foot is known to stand."""


class Footfalls(NamedTuple):
    """Position of a foot in each of its stances."""

    time: Ints
    """(stances,) ns, the middle of the stance."""
    position: Floats
    """(stances, 3) m, at that time; NaN where not known. Also `first` and `last`, at 20 % and 80 %
    of the stance."""
    first: Floats
    last: Floats
    travel_m: Floats
    """(stances,) m, distance between these two."""
    velocity: Floats
    """(stances, 2) m/s, horizontally, from the one to the other."""
    slip_m: Floats
    """(stances,) m, the same on the ground only; also `largest_slip_m`, the furthest that it is
    in between from where it is at 20 %."""
    largest_slip_m: Floats


def footfalls(path: FootPath, stances: Stances) -> Footfalls:
    """Return where a foot stands, by its path in the world."""
    duration = stances.liftoff - stances.touchdown
    steps = np.linspace(*MIDDLE, 13)
    time = stances.touchdown[:, None] + np.rint(duration[:, None] * steps).astype(np.int64)
    position = path.at(time)
    known = path.unbroken(time[:, 0], time[:, -1]) & np.isin(stances.cut, _SEEN)
    position[~known] = np.nan
    displacement = position - position[:, :1]
    flat = np.hypot(displacement[:, :, 0], displacement[:, :, 1])
    return Footfalls(
        time=stances.middle,
        position=position[:, len(steps) // 2],
        first=position[:, 0],
        last=position[:, -1],
        velocity=displacement[:, -1, :2] / ((time[:, -1] - time[:, 0]) / 1e9)[:, None],
        travel_m=np.sqrt((displacement[:, -1] ** 2).sum(axis=1)),
        slip_m=flat[:, -1],
        largest_slip_m=flat.max(axis=1, initial=0.0),
    )
