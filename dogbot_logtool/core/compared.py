"""Records of what is compared with the base's motion: velocity commands, the accelerometer."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Final, Literal, NamedTuple

import numpy as np

from dogbot_logtool.core.arrays import Floats, Ints
from dogbot_logtool.core.metrics import Commands, Imu, Tracking, Turning
from dogbot_logtool.core.records import Number

if TYPE_CHECKING:
    from dogbot_logtool.core.vectors import VectorHistory

TRACKING_HZ: Final = 50.0
"""Commanded and measured velocity are compared so often."""
AXES: Final = ("forward", "lateral", "yaw")
"""The columns of velocities: m/s forward, m/s to the left, rad/s to the left."""


class CommandTrack(NamedTuple):
    """Commanded and measured velocity over time."""

    history: "VectorHistory"
    axes: str | None
    """``forward``: a command's x is the robot's forward direction; ``body``: x of the base's frame.
    None: cannot be told."""
    window_ns: int
    timeout_ns: int
    commanded_s: float
    """s with a command, of the time that is known of the base; also `no_command_s`, without."""
    no_command_s: float
    time: Ints
    """(n,) ns, times whose window is known of the base and of the command."""
    commanded: Floats
    """(n, 3) as in `AXES`; also `measured`."""
    measured: Floats
    opposed: tuple[str, ...]
    """The axes of which the base does the opposite of the command."""
    drifts: Mapping[str, Floats]
    """(3,) mean velocity while ``straight`` ahead is commanded, and while the robot steps ``in
    place``, where it does so for long enough."""

    @property
    def breaks(self) -> Ints:
        """(b, 2) ns, holes between neighbouring times, over which no line leads."""
        rows = np.flatnonzero(np.diff(self.time) > 1.5e9 / TRACKING_HZ)
        return np.stack([self.time[rows], self.time[rows + 1]], axis=1)

    def errors(self, axis: int) -> tuple[Number, Number, Number, Number]:
        """Return means of command and measurement, mean and rms of measured less commanded."""
        if not len(self.time) or (axis < 2 and self.axes is None):
            return None, None, None, None
        commanded, measured = self.commanded[:, axis], self.measured[:, axis]
        error = measured - commanded
        rms = float(np.sqrt((error * error).mean()))
        return float(commanded.mean()), float(measured.mean()), float(error.mean()), rms

    def metrics(self) -> Commands:
        """Return how the base follows its commands."""
        forward, lateral, yaw = (self.errors(axis) for axis in range(3))
        return Commands(
            topic=self.history.topic,
            commanded_s=self.commanded_s,
            forward=Tracking(*forward),
            lateral=Tracking(*lateral),
            yaw=Turning(*yaw),
        )


Reading = Literal["m/s^2", "g", "without gravity", "nothing", "another scale", "unclear"]
"""The kind of readings of an accelerometer."""


class ForceComparison(NamedTuple):
    """The feet's forces over the mass against the accelerometer, in time known to all of them."""

    ratio: float
    """Vertical force over the mass over what the levelled accelerometer reads; 1 is right."""
    odd_foot: tuple[int, float] | None
    """The one foot whose factor is not that of the others, which are right, and by what its force
    must be multiplied."""


class ImuComparison(NamedTuple):
    """Comparison of the acceleration by accelerometer, forces and poses."""

    metrics: Imu
    reading: Reading
    scale: float
    """Reading over expected value."""
    turned_rad: float | None
    """Turn of the horizontal accelerations against those of poses, to the left; None: none that is
    clear."""
    forces: ForceComparison | None
    """None: no mass, or vertical forces are not known."""
