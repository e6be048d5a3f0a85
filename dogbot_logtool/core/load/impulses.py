"""Mean forces of feet over any time, from the running totals of their tracks."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Floats, Ints
from dogbot_logtool.core.contact.foot_history import FootHistory

CELL_RATE_HZ: Final = 25.0
"""Forces are compared with other sensors by their means over so many cells a second."""


def mean_impulses(feet: Sequence[FootHistory], impulse: str, time: Ints, half_ns: int) -> Floats:
    """(m, feet) N, means over a window about each time.

    Args:
        feet: histories of all feet.
        impulse: ``vertical_impulse`` or ``force_impulse`` of their tracks.
        time: (m,) ns.
        half_ns: half of the window.
    """
    spans = np.stack([time - half_ns, time + half_ns], axis=1)
    totals = [foot.track.impulse_at(getattr(foot.track, impulse), spans) for foot in feet]
    return np.stack([total[:, 1] - total[:, 0] for total in totals], axis=1) / (2e-9 * half_ns)
