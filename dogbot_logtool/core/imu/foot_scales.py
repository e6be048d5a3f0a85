"""Which foot's force is wrong: what each must be multiplied with to explain an accelerometer."""

from typing import Final

import numpy as np

from dogbot_logtool.core.geometry.arrays import Floats
from dogbot_logtool.core.load.loads import GRAVITY_MPS2
from dogbot_logtool.dataclass import dataclass

ODD: Final = 0.15
"""A factor that is further from 1, and from the others, is odd."""
_CERTAIN: Final = 0.1
"""Error up to which a factor is told."""
_AS_GOOD: Final = 0.02
"""Of g: by so much may one factor for all feet explain less than one for each."""
_SHIFTS: Final = 0.05
"""Standard deviation of a foot's share from which the load shifts to and from it."""


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
