"""What the feet's forces say of the acceleration, against what an accelerometer does."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.contact.track import TRACK_RATE_HZ
from dogbot_logtool.core.geometry import timespans
from dogbot_logtool.core.geometry.arrays import Floats, Ints
from dogbot_logtool.core.geometry.delay import Delay, fit_delay
from dogbot_logtool.core.imu.foot_scales import FootScales, foot_scales
from dogbot_logtool.core.imu.running import (
    Running,
    horizontal_impulses,
)
from dogbot_logtool.core.imu.turn import Turn, find_turn
from dogbot_logtool.core.load.impulses import mean_impulses
from dogbot_logtool.core.load.load_figures import vertical_is_known
from dogbot_logtool.core.load.loads import GRAVITY_MPS2
from dogbot_logtool.dataclass import dataclass

LEAST_S: Final = 2.0
"""s that all of them must be known for."""
_CELL_NS: Final = round(1e9 / TRACK_RATE_HZ)
_LATEST_NS: Final = 200_000_000
"""ns, the largest delay of forces and accelerometer that is tried, either way; also no more than an
eighth of a stride, since the sum over four feet repeats itself every quarter."""
_LAGS: Final = 21
SWINGS: Final = 0.02
"""Of g: root mean square from which a curve over a stride can be compared with another."""


@dataclass(frozen=True, slots=True)
class Sensed:
    """What an accelerometer and poses say."""

    running: Running
    """Levelled, in m/s^2; the first three columns are in the world."""
    time: Ints
    """(n,) ns, 25 a second: means over the window about them are known."""
    half_ns: int
    """Half of the window, which is a stride."""
    poses: Floats
    """(n, 3) m/s^2, means of the base's acceleration from poses."""
    lacks_gravity: bool

    def vertical(self, time: Ints, half_ns: int) -> Floats:
        """(m,) m/s^2, means over a window about each time, with gravity."""
        sensed: Floats = self.running.mean(time, half_ns)[:, 2]
        return sensed + GRAVITY_MPS2 if self.lacks_gravity else sensed


@dataclass(frozen=True, slots=True)
class ForceComparison:
    """What the feet's forces say, over the time in which all of them are known."""

    known_s: float
    vertical_mps2: float
    """Mean sum of the feet's vertical forces over the mass."""
    magnitude_mps2: float
    """The same of the feet's |F|."""
    expected_mps2: float
    """What the accelerometer, levelled, says over the same time."""
    turn: Turn | None
    """Of the horizontal forces against what poses say; None: too little acceleration."""
    curve: Delay | None
    """Of vertical forces behind the accelerometer within strides; None: either hardly varies."""
    scales: FootScales | None
    """What each foot's force must be multiplied with; None: nothing to tell it from."""

    @property
    def ratio(self) -> float:
        """Vertical force over mass over what is expected; 1 for a sound recording."""
        return self.vertical_mps2 / self.expected_mps2

    @property
    def magnitude_ratio(self) -> float:
        """The same of |F|."""
        return self.magnitude_mps2 / self.expected_mps2


def compare_forces(
    feet: Sequence[FootHistory], mass_kg: float, sensed: Sensed, strides: Ints
) -> ForceComparison | None:
    """Return what the forces say; None where they are not known for long enough.

    Args:
        feet: histories of all feet.
        mass_kg: of the robot.
        sensed: the accelerometer, and what poses say.
        strides: (s, 2) ns, time in which the feet carry the robot.
    """
    loaded = [foot for foot in feet if len(foot.in_contact)]
    if not loaded or not all(vertical_is_known(foot) for foot in loaded):
        return None
    known = timespans.intersect([strides, *(foot.vertical_known for foot in feet)])
    half = sensed.half_ns
    rows = timespans.hold_window(known, sensed.time, half, half)
    time = sensed.time[rows]
    if len(time) < LEAST_S * TRACK_RATE_HZ:
        return None
    vertical = mean_impulses(feet, "vertical_impulse", time, half).sum(axis=1)
    magnitude = mean_impulses(feet, "force_impulse", time, half).sum(axis=1)
    cells = time + _CELL_NS // 2
    in_cells = mean_impulses(feet, "vertical_impulse", cells, _CELL_NS // 2)
    return ForceComparison(
        known_s=len(time) / TRACK_RATE_HZ,
        vertical_mps2=float(vertical.mean()) / mass_kg,
        magnitude_mps2=float(magnitude.mean()) / mass_kg,
        expected_mps2=float(sensed.vertical(time, half).mean()),
        turn=_turn(feet, mass_kg, time, sensed.poses[rows], half),
        curve=_curve((in_cells.sum(axis=1) - vertical) / mass_kg, cells, sensed),
        scales=foot_scales(in_cells, sensed.vertical(cells, _CELL_NS // 2), mass_kg),
    )


def _turn(
    feet: Sequence[FootHistory], mass_kg: float, time: Ints, poses: Floats, half_ns: int
) -> Turn | None:
    sideways = horizontal_impulses(feet)
    if sideways is None:
        return None
    told = timespans.hold_window(sideways.known, time, half_ns, half_ns)
    return find_turn(sideways.mean(time[told], half_ns) / mass_kg, poses[told, :2])


def _curve(forces: Floats, time: Ints, sensed: Sensed) -> Delay | None:
    """Compare how forces swing about their mean over a stride with the accelerometer.

    Args:
        forces: (n,) m/s^2 at some times.
        time: (n,) ns.
        sensed: the accelerometer.
    """
    half, cell = sensed.half_ns, _CELL_NS // 2
    latest_ns = min(_LATEST_NS, half // 4)
    reach = half + latest_ns
    rows = timespans.hold_window(sensed.running.known, time, reach, reach)
    forces, time = forces[rows], time[rows]

    def swing(lag_s: float) -> Floats:
        at = time - round(lag_s * 1e9)
        return sensed.vertical(at, cell) - sensed.vertical(at, half)

    least = SWINGS * GRAVITY_MPS2
    if not len(time) or min(float(np.std(each)) for each in (forces, swing(0.0))) < least:
        return None
    latest = latest_ns / 1e9
    strides = len(time) * _CELL_NS / (2.0 * half)
    return fit_delay(forces, swing, np.linspace(-latest, latest, _LAGS), strides)
