"""Silences of what tells of a leg: across them nothing is interpolated."""

from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Flags, Ints

LONGEST_STEP_S: Final = 0.1
"""s between two messages; a longer step is a silence."""


def silent_before(time: Ints) -> Flags:
    """(n,) whether a silence lies between a row and the one before; time: (n,) ns."""
    silent = np.zeros(len(time), np.bool_)
    silent[1:] = np.diff(time) > LONGEST_STEP_S * 1e9
    return silent


def unbroken(time: Ints, breaks: Flags, start: Ints, end: Ints) -> Flags:
    """Tell which spans rows cover to their ends, without a break between two of the rows.

    Args:
        time: (n,) ns, of the rows, increasing.
        breaks: (n,) whether one lies between a row and the one before.
        start: (m,) ns; before the first row nothing breaks.
        end: (m,) ns.
    """
    so_far = np.concatenate([[0], np.cumsum(breaks)])
    first = np.searchsorted(time, start, side="right")
    last = np.searchsorted(time, end, side="left") + 1
    inside = last <= len(time)
    last = np.minimum(last, len(time))
    whole: Flags = inside & (so_far[last] == so_far[np.minimum(first, last)])
    return whole
