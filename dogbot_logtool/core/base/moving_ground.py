"""A ground that moves, as a treadmill's: standing feet go back alike while the base rests."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Floats, Ints, median_of
from dogbot_logtool.core.base.poses import BaseHistory
from dogbot_logtool.core.contact.foot_history import FootHistory

FEWEST_STANCES: Final = 6
SLOWEST_MPS: Final = 0.05
ALIKE: Final = 0.3
"""Share of the ground's speed by which half of the stances may differ from it."""
RESTS: Final = 0.05
"""Share of the ground's speed that a resting base keeps below, on average."""
_NEIGHBOURS: Final = 5


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class MovingGround:
    """The way of the ground over time."""

    time: Ints
    """(n,) ns."""
    displacement: Floats
    """(n, 2) m, horizontally in the world, since the first time."""
    speed_mps: float

    def displacement_at(self, time: Ints) -> Floats:
        """Return where the ground has moved to, (m, 3) m; before and after, it stands."""
        since = (self.time - self.time[0]).astype(np.float64)
        flat = [np.interp(time - self.time[0], since, axis) for axis in self.displacement.T]
        return np.stack([*flat, np.zeros(len(time))], axis=1)

    def on_ground(self, base: BaseHistory) -> BaseHistory:
        """Return poses against the ground."""
        return replace(base, position=base.position - self.displacement_at(base.time))


def find_moving_ground(
    feet: Sequence[FootHistory], base: BaseHistory, *, placed_by_poses: bool
) -> MovingGround | None:
    """Find how the ground moves; None: it rests, or the base does not.

    Args:
        feet: histories of all feet.
        base: poses without jumps.
        placed_by_poses: whether the feet's places in the world rest on these poses: then poses that
            are frozen would look the same.
    """
    if not feet or len(base.time) < 2:
        return None
    if placed_by_poses and not np.ptp(base.position, axis=0).any():
        return None
    slopes = [_velocities(foot) for foot in feet]
    time = np.concatenate([each for each, _ in slopes])
    velocity = np.concatenate([each for _, each in slopes])
    if len(time) < FEWEST_STANCES:
        return None
    usual = median_of(velocity, axis=0)
    speed = float(np.hypot(*usual))
    apart = float(median_of(np.hypot(*(velocity - usual).T)))
    seconds = float(base.time[-1] - base.time[0]) / 1e9
    travel = base.position[-1, :2] - base.position[0, :2]
    if speed < SLOWEST_MPS or apart > ALIKE * speed or np.hypot(*travel) > RESTS * speed * seconds:
        return None
    order = np.argsort(time, kind="stable")
    time, velocity = time[order], velocity[order]
    around = np.arange(len(time))[:, None] + np.arange(_NEIGHBOURS) - _NEIGHBOURS // 2
    velocity = median_of(velocity[np.clip(around, 0, len(time) - 1)], axis=1)
    time = np.concatenate([base.time[:1], time, base.time[-1:]])
    velocity = np.concatenate([velocity[:1], velocity, velocity[-1:]])
    steps = np.maximum(np.diff(time), 0)[:, None] / 1e9
    displacement = np.cumsum((velocity[1:] + velocity[:-1]) / 2.0 * steps, axis=0)
    return MovingGround(time, np.concatenate([np.zeros((1, 2)), displacement]), speed)


def _velocities(foot: FootHistory) -> tuple[Ints, Floats]:
    """Return the middle of stances, ns, and the velocity of the contact point in, (k, 2) m/s."""
    time, point = foot.track.contact_points
    whole = foot.stances.whole
    begin, end = foot.stances.touchdown[whole], foot.stances.liftoff[whole]
    first, last = np.searchsorted(time, begin), np.searchsorted(time, end) - 1
    spans_samples = last > first + 1
    first, last = first[spans_samples], last[spans_samples]
    seconds = (time[last] - time[first])[:, None] / 1e9
    middle = (begin + (end - begin) // 2)[spans_samples]
    return middle, (point[last, :2] - point[first, :2]).astype(np.float64) / seconds
