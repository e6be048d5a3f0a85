"""Comparison of the feet's forces with an accelerometer."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Floats, Ints
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.imu.running import (
    Running,
    horizontal_impulses,
)
from dogbot_logtool.core.load.impulses import CELL_RATE_HZ, mean_impulses
from dogbot_logtool.core.load.load_figures import vertical_is_known
from dogbot_logtool.core.load.loads import GRAVITY_MPS2
from dogbot_logtool.dataclass import dataclass

LEAST_S: Final = 2.0
"""s that all of them must be known for."""
_CELL_NS: Final = round(1e9 / CELL_RATE_HZ)

ODD: Final = 0.15
"""A factor that is further from 1, and from the others, is odd."""
_CERTAIN: Final = 0.1
"""Error up to which a factor is told."""
_AS_GOOD: Final = 0.02
"""Share of g by which one factor for all feet may explain less than one for each."""
_SHIFTS: Final = 0.05
"""Standard deviation of a foot's share from which the load shifts to and from it."""

MOVES_MPS2: Final = 0.15
"""m/s^2, root mean square of a horizontal acceleration that tells directions."""
COHERENT: Final = 0.8
"""Coherence from which a turn is told."""
TURNED_RAD: Final = np.deg2rad(20.0)
"""A smaller turn is as good as yaw and means over strides are."""


@dataclass(frozen=True, slots=True)
class Turn:
    """One horizontal acceleration against another one."""

    angle_rad: float
    """About the vertical, to the left."""
    coherence: float
    """|sum a conj(b)| / sqrt(sum |a|^2 sum |b|^2): 1 where one is the other, turned and scaled."""

    @property
    def is_turned(self) -> bool:
        """Whether they are one acceleration in two directions."""
        return self.coherence >= COHERENT and abs(self.angle_rad) > TURNED_RAD


def find_turn(first: Floats, second: Floats) -> Turn | None:
    """Compare horizontal accelerations as complex numbers.

    Args:
        first: (n, 2) m/s^2.
        second: (n, 2) m/s^2, what the first should be.

    Returns:
        None where either hardly accelerates.
    """
    one, other = (each[:, 0] + 1j * each[:, 1] for each in (first, second))
    if not len(one):
        return None
    if min(np.sqrt((np.abs(each) ** 2).mean()) for each in (one, other)) < MOVES_MPS2:
        return None
    product = complex(np.vdot(other, one))
    size = float(np.sqrt((np.abs(one) ** 2).sum() * (np.abs(other) ** 2).sum()))
    return Turn(float(np.angle(product)), abs(product) / size)


@dataclass(frozen=True, slots=True)
class FootScales:
    """Factors by which mass times acceleration exceeds the feet's forces."""

    common: float
    """One for all feet (least squares)."""
    is_common: bool | None
    """Whether one factor explains as much as one for each foot: the mass is wrong, or all sensors
    alike. None: the load does not shift, so that it cannot be told."""
    feet: tuple[float | None, ...]
    """One for each foot; None: not certain to 0.1."""

    @property
    def odd(self) -> int | None:
        """The one foot whose factor is not that of the others, which are right; None: none is."""
        if self.is_common is not False or any(each is None for each in self.feet):
            return None
        off = [row for row, each in enumerate(self.feet) if each and abs(each - 1.0) > ODD]
        return off[0] if len(off) == 1 else None


def foot_scales(vertical: Floats, sensed: Floats, mass_kg: float) -> FootScales | None:
    """Fit mass x vertical specific force = sum of factor x force.

    Args:
        vertical: (n, feet) N.
        sensed: (n,) m/s^2, the vertical specific force at the same times.
        mass_kg: of the robot.

    Returns:
        None without forces.
    """
    total, wanted = vertical.sum(axis=1), mass_kg * sensed
    squares = float(total @ total)
    if squares <= 0.0:
        return None
    common = float(total @ wanted) / squares
    shares = vertical / np.where(total > 0.0, total, np.inf)[:, None]
    shifts = bool((shares.std(axis=0) >= _SHIFTS).all())
    inverse = np.linalg.pinv(vertical.T @ vertical)
    factors = inverse @ (vertical.T @ wanted)
    rests = wanted - common * total, wanted - vertical @ factors
    left = [float(np.sqrt((rest * rest).mean())) / (mass_kg * GRAVITY_MPS2) for rest in rests]
    # What is left may come back in every stride: more of them make a factor no surer.
    spread = left[1] * mass_kg * GRAVITY_MPS2 * np.sqrt(len(total) * np.diag(inverse))
    # Feet that always press together have no factors of their own.
    separate = np.linalg.cond(vertical) < 1e3
    return FootScales(
        common=common,
        is_common=bool(left[0] <= left[1] + _AS_GOOD) if shifts else None,
        feet=tuple(
            float(factor) if shifts and separate and error <= _CERTAIN else None
            for factor, error in zip(factors.tolist(), spread.tolist(), strict=True)
        ),
    )


@dataclass(frozen=True, slots=True)
class Sensed:
    """Acceleration by accelerometer and by poses."""

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
    """Acceleration by the feet's forces, over the time in which all of them are known."""

    vertical_mps2: float
    """Mean sum of the feet's vertical forces over the mass."""
    magnitude_mps2: float
    """The same of the feet's |F|."""
    expected_mps2: float
    """Acceleration by the levelled accelerometer over the same time."""
    turn: Turn | None
    """Turn of the horizontal forces against those of poses; None: too little acceleration."""
    scales: FootScales | None
    """Factor by which each foot's force must be multiplied; None: unknown."""

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
    if len(time) < LEAST_S * CELL_RATE_HZ:
        return None
    vertical = mean_impulses(feet, "vertical_impulse", time, half).sum(axis=1)
    magnitude = mean_impulses(feet, "force_impulse", time, half).sum(axis=1)
    cells = time + _CELL_NS // 2
    in_cells = mean_impulses(feet, "vertical_impulse", cells, _CELL_NS // 2)
    return ForceComparison(
        vertical_mps2=float(vertical.mean()) / mass_kg,
        magnitude_mps2=float(magnitude.mean()) / mass_kg,
        expected_mps2=float(sensed.vertical(time, half).mean()),
        turn=_turn(feet, mass_kg, time, sensed.poses[rows], half),
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
