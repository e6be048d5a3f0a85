"""Sensors of which one axis is cut off at its limit, in several stances."""

from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Floats, Ints, distinct

SATURATED_SAMPLES: Final = 3
"""Samples in a row at the very same highest force that make a flat top."""
STEEP: Final = 10.0
"""Steps of the sensor's resolution beyond which the rise to its limit is steep. The round top of a
force that is recorded in steps is flat for m samples and at most 8 steps lower m samples before."""
SATURATED_STANCES: Final = 3
"""Stances with the same flat top that make a saturated sensor."""
FAR_FROM_SWING: Final = 0.5
"""Share of the usual load that a limit is from the unloaded level; else it is that of swing."""


def saturated_limit_n(force: Floats, offset_n: Floats, loaded_n: float) -> float | None:
    """Return the value at which an axis of a sensor is cut off, N; None: none is.

    Args:
        force: (n, 3) N, as recorded.
        offset_n: (3,) N, what the sensor reads without load.
        loaded_n: N, the usual load.
    """
    for axis in range(force.shape[1]):
        for sign in (1.0, -1.0):
            values = sign * force[:, axis]
            limit = float(values.max())
            is_far = limit - sign * offset_n[axis] > FAR_FROM_SWING * loaded_n
            if is_far and _flat_tops(values, limit) >= SATURATED_STANCES:
                return sign * limit
    return None


def resolution_n(force: Floats) -> float:
    """Return the step in which a sensor's coarsest axis counts, N, (n, 3) N as recorded."""
    steps = [np.diff(distinct(part)) for part in force.T]
    return max((float(each.min()) for each in steps if len(each)), default=0.0)


def _flat_tops(values: Floats, limit: float) -> int:
    """Return how often values rise steeply to a limit, and stay there."""
    at_limit = np.concatenate([[False], values == limit, [False]])
    edges: Ints = np.flatnonzero(at_limit[1:] != at_limit[:-1])
    start, length = edges[::2], edges[1::2] - edges[::2]
    flat = length >= SATURATED_SAMPLES
    if flat.sum() < SATURATED_STANCES:
        return 0
    steps = np.diff(distinct(values))
    start, length = start[flat], length[flat]
    rise = limit - values[np.maximum(start - length, 0)]
    return int((rise > STEEP * steps.min()).sum())
