"""The base's accelerometer against the feet's forces and the base's poses.

Over whole strides the accelerometer of a robot that climbs at constant speed reads g, whatever the
robot weighs; the feet's vertical forces over its mass are the same; and both are g and what the
poses say of its acceleration. So of the three the one that is odd can be told.

All are compared as means over one stride about each of 25 instants a second.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Floats, Ints
from dogbot_logtool.core.base.poses import BaseHistory
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.imu.forces import ForceComparison, Sensed, Turn, compare_forces, find_turn
from dogbot_logtool.core.imu.mounting import Mounting, Reading, find_mounting
from dogbot_logtool.core.imu.running import Running, running_accelerations
from dogbot_logtool.core.load.impulses import CELL_RATE_HZ
from dogbot_logtool.core.rotations import conjugate, from_roll_pitch_yaw, rotate
from dogbot_logtool.core.vectors import VectorHistory
from dogbot_logtool.dataclass import dataclass

_TICK_NS: Final = round(1e9 / CELL_RATE_HZ)
STANDING_WINDOW_S: Final = 0.5
"""s, what means are over in a log without strides."""
_LEAST_S: Final = 2.0
"""s that accelerometer and poses must be known for."""
_SPEED_NS: Final = 50_000_000
"""ns before and after: the base's speed is its way over this time."""
_COMPARABLE: Final = frozenset({Reading.SOUND, Reading.IN_G, Reading.WITHOUT_GRAVITY})
"""Readings that tell of accelerations, once they are levelled and in m/s^2."""


@dataclass(frozen=True, slots=True)
class ImuComparison:
    """Comparison of the acceleration by accelerometer, forces and poses."""

    sensed: VectorHistory
    mounting_recorded: bool
    known_s: float
    """s in which accelerometer and poses are known."""
    imu_mps2: float
    """Mean specific force along what is up for the sensor, as recorded."""
    mounting: Mounting
    turn: Turn | None
    """Turn of the horizontal accelerations against those of poses."""
    forces: ForceComparison | None
    """None: no mass, or vertical forces are not known."""

    @property
    def is_zero(self) -> bool:
        """Whether it tells nothing: some units have no accelerometer."""
        return self.mounting.reading is Reading.NOTHING


def compare_imu(
    sensed: VectorHistory,
    base: BaseHistory,
    jumps: Ints,
    feet: Sequence[FootHistory],
    *,
    mass_kg: float | None,
    mounting: Sequence[float] | None,
    period_s: float | None,
    fallen: Ints,
    strides: Ints,
) -> ImuComparison | None:
    """Compare accelerometer, forces and poses.

    Args:
        sensed: what the accelerometer reads, in its frame.
        base: poses without jumps.
        jumps: (j, 2) ns, spans that nothing is measured across.
        feet: histories of all feet.
        mass_kg: None: not known.
        mounting: x, y, z, w: the sensor's frame in the base's; None: it is the base's.
        period_s: s, the usual stride; None: there are none.
        fallen: (f, 2) ns, time in which the robot lies.
        strides: (s, 2) ns, whole strides: only in them it is sure that the feet carry the robot.

    Returns:
        None where accelerometer and poses have too little time in common.
    """
    running = running_accelerations(sensed, base, mounting)
    if running is None:
        return None
    half = round((period_s or STANDING_WINDOW_S) * 5e8)
    reach = half + _SPEED_NS
    usable = timespans.subtract(running.known, timespans.merge(np.concatenate([jumps, fallen])))
    time = timespans.ticks(usable, _TICK_NS)
    time = time[timespans.hold_window(usable, time, reach, reach)]
    if len(time) < _LEAST_S * CELL_RATE_HZ:
        return None
    means = running.mean(time, half)
    poses = _acceleration(base, time, half)
    turned = from_roll_pitch_yaw(base.angles_at(time))
    expected = means[:, 6:] + rotate(conjugate(turned), poses)
    seat = find_mounting(means[:, 3:6], expected)
    level = _levelled(sensed, base, mounting, seat)
    forces = None
    if level is not None and mass_kg is not None:
        lacks_gravity = seat.reading is Reading.WITHOUT_GRAVITY
        sensing = Sensed(level, time, half, poses, lacks_gravity)
        forces = compare_forces(feet, mass_kg, sensing, strides)
    return ImuComparison(
        sensed=sensed,
        mounting_recorded=mounting is not None,
        known_s=len(time) / CELL_RATE_HZ,
        imu_mps2=seat.mean_mps2,
        mounting=seat,
        turn=find_turn(level.mean(time, half)[:, :2], poses[:, :2]) if level else None,
        forces=forces,
    )


def _levelled(
    sensed: VectorHistory, base: BaseHistory, mounting: Sequence[float] | None, seat: Mounting
) -> Running | None:
    """Return what is sensed once more, levelled and in m/s^2; None where nothing is told."""
    if seat.reading not in _COMPARABLE:
        return None
    vector = sensed.vector if mounting is None else rotate(np.array([mounting]), sensed.vector)
    return running_accelerations(replace(sensed, vector=seat.corrected(vector)), base, None)


def _acceleration(base: BaseHistory, time: Ints, half_ns: int) -> Floats:
    """(n, 3) m/s^2, the base's mean acceleration in the world over a window about each time."""
    speeds = [
        (base.position_at(at + _SPEED_NS) - base.position_at(at - _SPEED_NS)) / (2e-9 * _SPEED_NS)
        for at in (time + half_ns, time - half_ns)
    ]
    mean: Floats = np.nan_to_num((speeds[0] - speeds[1]) / (2e-9 * half_ns))
    return mean
