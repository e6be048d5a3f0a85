"""The command that holds at any time: each until the next, but not beyond a time-out."""

from typing import Final

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Flags, Floats, Ints, added_within
from dogbot_logtool.core.recorded.vectors import VectorHistory
from dogbot_logtool.core.rotations import along_heading
from dogbot_logtool.dataclass import dataclass

TIMEOUT_S: Final = 0.5
"""s; what ros2_controllers' diff_drive_controller waits for a command before it stops."""


@dataclass(frozen=True, slots=True)
class HeldCommand:
    """Commands with the spans for which they hold."""

    start: Ints
    """(n,) ns. Also `end`."""
    end: Ints
    velocity: Floats
    """(n, 3) m/s forward, m/s to the left, rad/s to the left."""
    timeout_ns: int

    @property
    def known(self) -> Ints:
        """(k, 2) ns, the time with a command."""
        return timespans.merge(np.stack([self.start, self.end], axis=1))

    def where(self, holds: Flags) -> Ints:
        """(k, 2) ns, the time in which one of some commands holds."""
        return timespans.merge(np.stack([self.start[holds], self.end[holds]], axis=1))

    def mean(self, time: Ints, window_ns: int, delay_ns: int = 0) -> Floats:
        """(m, 3) m/s and rad/s, exact means over a window about each time less a delay.

        Time without a command counts as zero: ask only where it is known.
        """
        origin = self.start[0]
        knots = np.stack([self.start, self.end], axis=1).ravel() - origin
        held = self.velocity * ((self.end - self.start) / 1e9)[:, None]
        total = np.zeros((len(knots), 3))
        total[1::2] = np.cumsum(held, axis=0)
        total[2::2] = total[1:-1:2]
        since = (time - origin - delay_ns).astype(np.float64)
        return added_within(total, knots, since, window_ns / 2.0) / (window_ns / 1e9)


def held_command(history: VectorHistory, turn_rad: float) -> HeldCommand:
    """Let each command hold until the next.

    Args:
        history: commands, at least one.
        turn_rad: from the command's x axis to the robot's forward direction.
    """
    usual = history.gap_ns if np.isfinite(history.gap_ns) else 0.0
    timeout = round(max(TIMEOUT_S * 1e9, usual))
    end = np.append(history.time[1:], history.time[-1:] + timeout)
    heading = np.full(len(history.time), turn_rad)
    forward, left = along_heading(history.vector, heading)
    return HeldCommand(
        start=history.time,
        end=np.minimum(end, history.time + timeout),
        velocity=np.stack([forward, left, history.vector[:, 2]], axis=1),
        timeout_ns=timeout,
    )
