"""Does the recording end while the robot tips over?"""

from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.core.base.base_history import BaseHistory
from dogbot_logtool.core.base.base_motion import roll_and_pitch
from dogbot_logtool.dataclass import dataclass

LAST_S: Final = 2.0
"""s before the end in which tipping begins; what was before is usual."""
USUAL_S: Final = 2.0
"""s that must come before."""
BEYOND_RAD: Final = 0.1
"""rad beyond the usual range."""
RISING_S: Final = 0.3
"""s before the end in which the angle must grow."""
_RISES_RAD: Final = 0.02


@dataclass(frozen=True, slots=True)
class Tipping:
    """A roll or pitch that leaves its usual range and does not return."""

    since: int
    """ns, when it leaves its usual range."""
    angle: str
    """``roll`` or ``pitch``."""
    last_rad: float
    """rad, at the end of the recording."""


def find_tipping(base: BaseHistory, forward_axis: str) -> Tipping | None:
    """Return how the robot tips at the end of the recording; None: it does not.

    An angle counts that leaves the range of all the time before, and is still growing at the end.
    """
    if len(base.time) < 3 or base.time[-1] - base.time[0] < (LAST_S + USUAL_S) * 1e9:
        return None
    angles = zip(("roll", "pitch"), roll_and_pitch(base.angles, forward_axis), strict=True)
    found = [each for name, values in angles if (each := _tips(base, name, values))]
    return max(found, key=lambda each: abs(each.last_rad), default=None)


def _tips(base: BaseHistory, name: str, angle: Floats) -> Tipping | None:
    before = base.time < base.time[-1] - LAST_S * 1e9
    low, high = float(angle[before].min()), float(angle[before].max())
    beyond = np.maximum(angle - high, low - angle)
    inside = np.flatnonzero(beyond <= 0.0)
    first = int(inside[-1]) + 1 if len(inside) else 0
    if first >= len(angle) or beyond[-1] < BEYOND_RAD:
        return None
    earlier = int(np.searchsorted(base.time, base.time[-1] - RISING_S * 1e9))
    if beyond[-1] - beyond[earlier] < _RISES_RAD:
        return None
    return Tipping(int(base.time[first]), name, float(angle[-1]))
