"""How far a foot slips, told from the way of its contact point."""

from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Floats

LARGEST_FOOT_M: Final = 0.3
"""m: the contact point of no foot that stays in place travels further in a stance."""


def slip_m(contact_way_m: Floats, rolling_m: float | None) -> Floats:
    """Return how far a foot slips in each stance, m.

    A round foot that rolls, or a flat one on which the pressure moves, moves its contact point
    without slipping. Where that way is not known, neither is the slip.

    Args:
        contact_way_m: (n,) m, way of the contact point; NaN where there is none.
        rolling_m: m, way of the contact point of a foot that does not slip; None: not known.
    """
    if rolling_m is None:
        return np.full_like(contact_way_m, np.nan)
    slip: Floats = np.maximum(contact_way_m - rolling_m, 0.0)
    return slip
