"""Many values in one: aggregates of figures, and means on the circle."""

import numpy as np

from dogbot_logtool.core.geometry.arrays import Floats
from dogbot_logtool.core.geometry.order_statistics import median_of
from dogbot_logtool.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class Aggregate:
    """Summary of many values of one figure, in the figure's unit."""

    n: int
    mean: float
    std: float | None
    """Sample standard deviation (divisor n - 1); None for a single value."""
    median: float
    min: float
    max: float


def aggregate(values: Floats) -> Aggregate | None:
    """Aggregate the finite values; None where there are none.

    Args:
        values: (n,), any unit; NaN stands for "not known" and is left out.
    """
    known = values[np.isfinite(values)]
    if len(known) == 0:
        return None
    std = float(np.std(known, ddof=1)) if len(known) > 1 else None
    return Aggregate(
        n=len(known),
        mean=float(np.mean(known)),
        std=std,
        median=float(median_of(known)),
        min=float(np.min(known)),
        max=float(np.max(known)),
    )


@dataclass(frozen=True, slots=True)
class CircularMean:
    """Mean of phases on the circle."""

    mean: float
    """Cycles in [0, 1)."""
    consistency: float
    """R in [0, 1]: 1 when all phases are equal, near 0 when they are spread evenly."""
    n: int


def circular_mean(phases: Floats) -> CircularMean | None:
    """Average phases on the circle: R exp(2 pi i mean) = mean of exp(2 pi i phase).

    Source: Batschelet, Circular Statistics in Biology, 1981. Raw phases are never averaged:
    0.99 and 0.01 lie 0.02 apart, and their mean is 0.

    Args:
        phases: (n,) cycles; NaN is left out.

    Returns:
        The mean, or None without phases.
    """
    known = phases[np.isfinite(phases)]
    if len(known) == 0:
        return None
    angle = 2.0 * np.pi * known
    x, y = float(np.mean(np.cos(angle))), float(np.mean(np.sin(angle)))
    mean = float(np.arctan2(y, x)) / (2.0 * np.pi) % 1.0
    return CircularMean(mean if mean < 1.0 else 0.0, min(1.0, float(np.hypot(x, y))), len(known))


def wrapped(phases: Floats) -> Floats:
    """Return phases or their differences wrapped into [-0.5, 0.5) cycles."""
    wrapped_phases: Floats = (phases + 0.5) % 1.0 - 0.5
    return wrapped_phases
