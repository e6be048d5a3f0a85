"""Which gait? The class that fits the feet's phases and duty factor.

Phases say how the feet are coordinated; the duty factor is a separate finding (a trot whose feet
are down for more than half of the stride is a trot all the same).
"""

from collections.abc import Sequence
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Floats, wrapped
from dogbot_logtool.core.gait.gait_classes import QUADRUPED, TOLERANCE, class_distances
from dogbot_logtool.dataclass import dataclass

CONSISTENT: Final = 0.8
"""R that the phases of every foot must exceed."""
STAND: Final = "stand"
IRREGULAR: Final = "irregular"
FLIGHT: Final = 0.02
"""Fraction of time in flight from which a gait is no amble."""
_SAME: Final = 9
"""Decimals to which two distances must agree to count as equal."""


@dataclass(frozen=True, slots=True)
class GaitClass:
    """The class of a gait, and how well it fits."""

    name: str | None
    """A class of `class_distances`, ``irregular``, ``stand``; None where it cannot be known."""
    sequence: str | None
    """Walk and amble: ``lateral`` or ``diagonal``. Gallop: ``rotary`` or ``transverse``."""
    nearest: str | None
    """The class that fits best, whether it fits or not; None where phases are missing."""
    distance: float | None
    """Cycles, of the nearest class."""


UNKNOWN_GAIT: Final = GaitClass(None, None, None, None)


def classify(
    phases: Sequence[float],
    consistency: Sequence[float],
    duty_factor: float | None = None,
    flight_fraction: float | None = None,
) -> GaitClass:
    """Name the gait of mean phases.

    Args:
        phases: cycles, of all feet in the order of `class_distances`.
        consistency: R of each.
        duty_factor: mean of all feet; None: not known.
        flight_fraction: share of time without a foot on the ground; None: not known.

    Returns:
        The class; `UNKNOWN_GAIT` where a phase is missing or gaits of so many feet have no names.
    """
    table = np.array([phases], np.float64)
    duty = None if duty_factor is None else np.array([duty_factor])
    distances = {
        name: round(float(value[0]), _SAME) for name, value in class_distances(table, duty).items()
    }
    if not distances or not np.isfinite(table).all():
        return UNKNOWN_GAIT
    nearest = min(distances, key=distances.__getitem__)
    distance = distances[nearest]
    fits = distance <= TOLERANCE and all(each > CONSISTENT for each in consistency)
    if nearest == "amble" and flight_fraction is not None and flight_fraction > FLIGHT:
        fits = False
    name = nearest if fits else IRREGULAR
    return GaitClass(name, _sequence(name, table[0]), nearest, distance)


def _sequence(name: str, phases: Floats) -> str | None:
    """Return the order of the feet, where the class leaves it open."""
    if len(phases) != QUADRUPED:
        return None
    front_left, front_right, back_left, back_right = phases
    if name in {"walk", "amble"}:
        left, right = wrapped(np.array([front_left - back_left, front_right - back_right]))
        return "lateral" if wrapped(left + wrapped(right - left) / 2.0) > 0.0 else "diagonal"
    if name == "gallop":
        fore, hind = wrapped(np.array([front_right - front_left, back_right - back_left]))
        return "transverse" if fore * hind > 0.0 else "rotary"
    return None
