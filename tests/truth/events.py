"""Events against events."""

import numpy as np

from tests.truth.recording import Floats


def matched(true: Floats, reported: Floats, reach_s: float) -> list[float]:
    """Return how late the nearest reported event is after each true one, where one is in reach."""
    if not len(reported):
        return []
    late = [float(reported[np.abs(reported - each).argmin()] - each) for each in true]
    return [each for each in late if abs(each) <= reach_s]
