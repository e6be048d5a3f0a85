"""Records of joints: their states as messages tell them, and what is kept of each over a log."""

from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Flags, Float32s, Floats, Ints, picked
from dogbot_logtool.dataclass import dataclass

MOST_JOINTS: Final = 256
"""Joints of a robot that are followed; no robot with legs has more."""


@dataclass(frozen=True, slots=True)
class JointLimits:
    """Limits of a joint by the robot's description; infinite where there are none."""

    lower: float = -np.inf
    """rad or m; also `upper`."""
    upper: float = np.inf
    effort: float = np.inf
    """N m or N."""
    velocity: float = np.inf
    """rad/s or m/s."""


@dataclass(frozen=True, slots=True)
class JointSamples:
    """States of k joints, one row a message."""

    log_time: Ints
    """(n,) ns."""
    stamp: Ints
    """(n,) ns; the log time of messages without a stamp."""
    position: Floats
    """(n, k) rad or m; also `velocity`, rad/s or m/s, and `effort`, N m or N; NaN: not told."""
    velocity: Floats
    effort: Floats

    def pick(self, rows: Ints | Flags) -> "JointSamples":
        """Return copies of some rows."""
        return picked(self, rows)

    def only(self, joints: Ints) -> "JointSamples":
        """Return the states of some joints, copies unless these are all."""
        if np.array_equal(joints, np.arange(self.position.shape[1])):
            return self
        values = (each[:, joints] for each in (self.position, self.velocity, self.effort))
        return JointSamples(self.log_time, self.stamp, *values)


@dataclass(frozen=True, slots=True)
class JointTable:
    """Joint states of a topic, in the order of the log."""

    topic: str
    names: tuple[str, ...]
    """Names of the joints in `samples`."""
    samples: JointSamples


@dataclass(frozen=True, slots=True)
class JointTrack:
    """A joint's motion at a low rate, (n,) each; no rows of a joint that never moves."""

    time: Ints
    """ns, strictly increasing."""
    position: Float32s
    """rad or m."""
    positive_work: Float32s
    """J since the row before; NaN where a silence or an unknown effort lies between."""
    absolute_work: Float32s


@dataclass(frozen=True, slots=True)
class JointHistory:
    """All that is kept of a joint."""

    name: str
    messages: int
    not_advancing: int
    """Messages that repeat a time or step back; left out."""
    start: int
    """ns, first usable message; also `end`, the last one."""
    end: int
    known_s: float
    """s, without silences."""
    lowest: float
    """rad or m; also `highest`."""
    highest: float
    velocity_told: bool
    """Whether messages tell velocities that are not all zero; else positions are differenced."""
    peak_speed: float
    """rad/s or m/s, by the source that `velocity_told` says."""
    lowest_effort: float
    """N m or N; also `highest_effort`; NaN: no message tells one."""
    highest_effort: float
    squared_effort: float
    """(N m)^2 s, integral of the squared effort over `effort_s`, the time in which it is known."""
    effort_s: float
    absolute_work_j: float
    """J, where effort and motion are known."""
    near_limit_s: float
    """s within `known_s`, of limits that are known."""
    has_limits: bool
    told_moved: float
    """Sum of v dq, with v the velocity that messages tell; also `told_squared`, of v^2 dt."""
    told_squared: float
    track: JointTrack
    """Its motion at a low rate."""

    @property
    def moves(self) -> bool:
        """Whether its position ever changes."""
        return self.highest > self.lowest

    @property
    def has_effort(self) -> bool:
        """Whether its effort is told: not zero, and not constant while it moves."""
        if not np.isfinite(self.lowest_effort):
            return False
        constant = self.lowest_effort == self.highest_effort
        return not constant or (self.lowest_effort != 0.0 and not self.moves)

    @property
    def peak_effort(self) -> float:
        """N m or N, the largest magnitude; NaN: none is told."""
        return max(abs(self.lowest_effort), abs(self.highest_effort))
