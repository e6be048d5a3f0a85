"""The samples of stances, as their figures are worked out from them."""

from typing import NamedTuple

import numpy as np

from dogbot_logtool.core.geometry.arrays import Flags, Floats, Ints


class StanceSamples(NamedTuple):
    """The samples of k stances, stance after stance, n in all.

    Each stance has the sample before it, its own, and the one that ends it. Where the log begins
    in the stance, its first sample stands in for the one before.
    """

    first: Ints
    """(k,) the last row before touchdown, or that of touchdown where nothing is known before it."""
    touchdown: Ints
    """(k,) the first row in contact."""
    end: Ints
    """(k,) the first row out of contact."""
    stance: Ints
    """(n,) the stance that each row belongs to."""
    time: Floats
    """(n,) s since the stance's touchdown."""
    force: Floats
    """(n,) N, magnitude; never higher before touchdown than after it."""
    vertical: Floats
    """(n,) N, vertical part; NaN where its direction is not known."""
    force_x: Floats
    """(n,) N, horizontal parts along the world's axes, also `force_y`; NaN like `vertical`."""
    force_y: Floats
    x: Floats
    """(n,) m, contact point in the world; NaN where there is none; also `y`."""
    y: Floats
    single: Flags
    """(n,) whether that is one contact point, not the mean of several."""
    friction: Floats
    """(n,) tangential over normal force; NaN where not known or hardly loaded."""


def own_rows(samples: StanceSamples) -> Flags:
    """(n,) whether a row is in contact: not the one before a stance, nor the one that ends it."""
    rows = np.arange(len(samples.force))
    own: Flags = rows >= samples.touchdown[samples.stance]
    return own & (rows < samples.end[samples.stance])
