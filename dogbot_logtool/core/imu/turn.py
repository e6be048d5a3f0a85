"""How horizontal accelerations from two sources are turned against each other."""

from typing import Final

import numpy as np

from dogbot_logtool.core.geometry.arrays import Floats
from dogbot_logtool.dataclass import dataclass

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
